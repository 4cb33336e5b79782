#include "post/vtk/picture.hpp"

#include <vtkActor.h>
#include <vtkActor2D.h>
#include <vtkAppendPolyData.h>
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkClipClosedSurface.h>
#include <vtkColorTransferFunction.h>
#include <vtkDoubleArray.h>
#include <vtkFeatureEdges.h>
#include <vtkFloatArray.h>
#include <vtkGlyph3DMapper.h>
#include <vtkIntArray.h>
#include <vtkLookupTable.h>
#include <vtkNew.h>
#include <vtkPlane.h>
#include <vtkPlaneCollection.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper.h>
#include <vtkPolyDataMapper2D.h>
#include <vtkProperty.h>
#include <vtkProperty2D.h>
#include <vtkRenderer.h>
#include <vtkScalarBarActor.h>
#include <vtkShrinkPolyData.h>
#include <vtkTextActor.h>
#include <vtkTextProperty.h>
#include <vtkTubeFilter.h>

#include <algorithm>
#include <cmath>

#include "core/base/error.hpp"
#include "core/picture/display.hpp"
#include "core/picture/picture.hpp"
#include "post/run/body_colours.hpp"
#include "post/run/bonds_in_frame.hpp"
#include "post/run/contact_network.hpp"
#include "post/run/drawn_meshes.hpp"
#include "post/run/wall_loads.hpp"
#include "post/vtk/legend_ticks.hpp"
#include "post/vtk/vtk_mesh.hpp"

namespace scree {

namespace {

/// Leaves away what lies before the cut: a plane of VTK keeps the side that its normal points to.
void cut_away(vtkPolyDataMapper* mapper, const std::optional<Cut>& cut) {
  if (!cut) return;
  vtkNew<vtkPlane> plane;
  plane->SetOrigin(cut->point.x, cut->point.y, cut->point.z);
  plane->SetNormal(-cut->normal.x, -cut->normal.y, -cut->normal.z);
  mapper->AddClippingPlane(plane);
}

/// A scale for numbers: viridis, which rises evenly in brightness, so that it reads in grey and for the colour-blind.
/// Source: N. Smith, S. van der Walt, E. Firing, matplotlib 2.0, CC0.
vtkSmartPointer<vtkColorTransferFunction> number_scale(double low, double high) {
  static constexpr std::array<std::array<double, 3>, 9> kViridis{{{0.267, 0.005, 0.329},
                                                                  {0.279, 0.175, 0.483},
                                                                  {0.230, 0.322, 0.546},
                                                                  {0.173, 0.449, 0.558},
                                                                  {0.128, 0.567, 0.551},
                                                                  {0.158, 0.684, 0.502},
                                                                  {0.369, 0.789, 0.383},
                                                                  {0.678, 0.864, 0.190},
                                                                  {0.993, 0.906, 0.144}}};
  auto scale = vtkSmartPointer<vtkColorTransferFunction>::New();
  const double reach = high > low ? high - low : 1;
  for (std::size_t i = 0; i < kViridis.size(); ++i) {
    const auto& c = kViridis[i];
    scale->AddRGBPoint(low + reach * static_cast<double>(i) / (kViridis.size() - 1), c[0], c[1], c[2]);
  }
  return scale;
}

/// A scale for numbers of two signs: blue below zero, red above, grey between.
/// Source: K. Moreland, Diverging color maps for scientific visualization, ISVC 2009.
vtkSmartPointer<vtkColorTransferFunction> signed_scale(double low, double high) {
  auto scale = vtkSmartPointer<vtkColorTransferFunction>::New();
  scale->SetColorSpaceToDiverging();
  scale->AddRGBPoint(low, 0.230, 0.299, 0.754);
  scale->AddRGBPoint(high > low ? high : low + 1, 0.706, 0.016, 0.150);
  return scale;
}

/// Of letters, in a picture of a height [pixels]: readable in small ones, the same share of large ones.
double text_scale(int height) { return std::max(0.6, height / 960.0); }

void set_text(vtkTextProperty* text, int size, int height) {
  text->SetColor(0.1, 0.1, 0.1);
  text->SetFontSize(static_cast<int>(std::lround(size * text_scale(height))));
  text->ItalicOff();
  text->BoldOff();
  text->ShadowOff();
}

void add_legend(vtkRenderer* renderer, vtkScalarsToColors* colours, const std::string& title, int height) {
  vtkNew<vtkScalarBarActor> bar;
  bar->SetLookupTable(colours);
  bar->SetTitle(title.c_str());
  vtkNew<vtkDoubleArray> ticks;
  for (const double tick : legend_ticks(colours->GetRange()[0], colours->GetRange()[1])) ticks->InsertNextValue(tick);
  bar->SetCustomLabels(ticks);
  bar->UseCustomLabelsOn();
  bar->SetLabelFormat("%.3g");
  bar->SetUnconstrainedFontSize(true);
  bar->SetPosition(0.90, 0.06);
  bar->SetWidth(0.06);
  bar->SetHeight(0.36);
  for (vtkTextProperty* text : {bar->GetTitleTextProperty(), bar->GetLabelTextProperty()}) set_text(text, 28, height);
  bar->SetTextPositionToPrecedeScalarBar();
  bar->SetVerticalTitleSeparation(18);
  renderer->AddActor2D(bar);
}

/// Names of kinds beside squares of their colour, from the upper right corner down.
void add_kinds(vtkRenderer* renderer, const std::map<int, std::string>& kinds, int width, int height) {
  constexpr std::size_t kMax = 12;  // more would cover the picture, and colours repeat after eight
  if (kinds.size() < 2 || kinds.size() > kMax) return;
  const double unit = text_scale(height), side = 30 * unit, step = 44 * unit, right = 2 * width - 40 * unit;
  double top = 2 * height - 44 * unit;
  for (const auto& [kind, name] : kinds) {
    vtkNew<vtkPoints> points;
    for (const auto& [x, y] :
         {std::array{right - side, top - side}, std::array{right, top - side}, std::array{right, top}, std::array{right - side, top}})
      points->InsertNextPoint(x, y, 0);
    vtkNew<vtkCellArray> cells;
    const vtkIdType corners[4] = {0, 1, 2, 3};
    cells->InsertNextCell(4, corners);
    vtkNew<vtkPolyData> square;
    square->SetPoints(points);
    square->SetPolys(cells);
    vtkNew<vtkPolyDataMapper2D> mapper;
    mapper->SetInputData(square);
    vtkNew<vtkActor2D> actor;
    actor->SetMapper(mapper);
    const Vec3 c = shape_colour(kind);
    actor->GetProperty()->SetColor(c.x, c.y, c.z);
    renderer->AddActor2D(actor);
    vtkNew<vtkTextActor> text;
    text->SetInput(name.c_str());
    set_text(text->GetTextProperty(), 30, height);
    text->GetTextProperty()->SetJustificationToRight();
    text->GetTextProperty()->SetVerticalJustificationToCentered();
    text->SetPosition(right - side - 14 * unit, top - 0.5 * side);
    renderer->AddActor2D(text);
    top -= step;
  }
}

void add_time(vtkRenderer* renderer, double time, int height) {
  vtkNew<vtkTextActor> text;
  text->SetInput(fmt::format("t = {:.4g} s", time).c_str());
  set_text(text->GetTextProperty(), 44, height);
  text->SetPosition(40 * text_scale(height), 2 * height - 80 * text_scale(height));
  renderer->AddActor2D(text);
}

/// Colours of bodies: of numbers a scale over `range`.
vtkSmartPointer<vtkScalarsToColors> colour_scale(const BodyColours& colours, const std::pair<double, double>& range) {
  if (!colours.are_kinds) return number_scale(range.first, range.second);
  int most = 0;
  for (const auto& [kind, name] : colours.kinds) most = std::max(most, kind);
  auto table = vtkSmartPointer<vtkLookupTable>::New();
  table->SetNumberOfTableValues(most + 1);
  table->SetTableRange(-0.5, most + 0.5);
  for (int k = 0; k <= most; ++k) {
    const Vec3 c = shape_colour(k);
    table->SetTableValue(k, c.x, c.y, c.z, 1);
  }
  return table;
}

void set_look(vtkProperty* look) {
  look->SetAmbient(0.12);
  look->SetDiffuse(0.88);
  look->SetSpecular(0.05);
}

/// The bodies that a plane goes through, each cut and closed there.
void add_cut_bodies(vtkRenderer* renderer, const FrameBodies& bodies, const Scene& scene, const std::vector<std::size_t>& rows,
                    const std::vector<double>& value, const Cut& cut, vtkScalarsToColors* colours) {
  vtkNew<vtkPlane> plane;  // keeps the side that its normal points to
  plane->SetOrigin(cut.point.x, cut.point.y, cut.point.z);
  plane->SetNormal(-cut.normal.x, -cut.normal.y, -cut.normal.z);
  vtkNew<vtkPlaneCollection> planes;
  planes->AddItem(plane);
  vtkNew<vtkAppendPolyData> all;
  for (const std::size_t i : rows) {
    TriangleMesh mesh = drawn_shape(scene.shapes[static_cast<std::size_t>(bodies.shape[i])]).mesh;
    for (Vec3& p : mesh.vertices) p = bodies.position[i] + rotate(bodies.orientation[i], bodies.scale[i] * p);
    vtkNew<vtkClipClosedSurface> clip;
    clip->SetInputData(vtk_triangles(mesh));
    clip->SetClippingPlanes(planes);
    clip->SetScalarModeToNone();
    clip->Update();
    vtkNew<vtkPolyData> part;
    part->ShallowCopy(clip->GetOutput());
    vtkNew<vtkDoubleArray> colour;
    colour->SetName("value");
    colour->SetNumberOfTuples(part->GetNumberOfCells());
    colour->Fill(value[i]);
    part->GetCellData()->Initialize();
    part->GetCellData()->AddArray(colour);
    all->AddInputData(part);
  }
  if (rows.empty()) return;
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputConnection(all->GetOutputPort());
  mapper->SetScalarModeToUseCellFieldData();
  mapper->SelectColorArray("value");
  mapper->SetLookupTable(colours);
  mapper->UseLookupTableScalarRangeOn();
  vtkNew<vtkActor> actor;
  actor->SetMapper(mapper);
  actor->GetProperty()->SetInterpolationToFlat();
  set_look(actor->GetProperty());
  renderer->AddActor(actor);
}

void add_bodies(vtkRenderer* renderer, const FrameBodies& bodies, const Scene& scene, const BodyColours& colours,
                const std::pair<double, double>& range, const PictureOptions& options, const std::optional<Cut>& cut) {
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  vtkNew<vtkDoubleArray> orientation, scale, value;
  vtkNew<vtkIntArray> shape;
  orientation->SetName("quat");
  orientation->SetNumberOfComponents(4);
  scale->SetName("scale");
  shape->SetName("shape");
  value->SetName("value");
  const std::vector<double> radius = bounding_radii(scene);
  std::vector<std::size_t> crossing;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const Vec3& x = bodies.position[i];
    if (cut) {
      const double before = dot(x - cut->point, cut->normal), reach = bodies.scale[i] * radius[static_cast<std::size_t>(bodies.shape[i])];
      if (before >= reach) continue;
      if (before > -reach) {
        crossing.push_back(i);
        continue;
      }
    }
    const Quat& q = bodies.orientation[i];
    points->InsertNextPoint(x.x, x.y, x.z);
    orientation->InsertNextTuple4(q.w, q.x, q.y, q.z);
    scale->InsertNextValue(bodies.scale[i]);
    shape->InsertNextValue(bodies.shape[i]);
    value->InsertNextValue(colours.value[i]);
  }
  vtkNew<vtkPolyData> data;
  data->SetPoints(points);
  for (vtkDataArray* array : std::initializer_list<vtkDataArray*>{orientation, scale, shape, value}) data->GetPointData()->AddArray(array);

  vtkNew<vtkGlyph3DMapper> mapper;
  for (int k = 0; k < static_cast<int>(scene.shapes.size()); ++k) {
    mapper->SetSourceData(k, vtk_mesh(drawn_shape(scene.shapes[static_cast<std::size_t>(k)])));
  }
  const auto colour = colour_scale(colours, range);
  mapper->SetLookupTable(colour);
  const bool are_ghosts = options.network || !options.bonds.empty();  // around what is drawn inside them
  if (options.legend && !are_ghosts) {
    if (colours.are_kinds)
      add_kinds(renderer, colours.kinds, options.width, options.height);
    else
      add_legend(renderer, colour, colours.title, options.height);
  }
  mapper->SetInputData(data);
  mapper->SourceIndexingOn();
  mapper->SetSourceIndexArray("shape");
  mapper->SetOrientationArray("quat");
  mapper->SetOrientationModeToQuaternion();
  mapper->SetScaleArray("scale");
  mapper->SetScaleModeToScaleByMagnitude();
  mapper->SetScalarModeToUsePointFieldData();
  mapper->SelectColorArray("value");
  mapper->UseLookupTableScalarRangeOn();
  vtkNew<vtkActor> actor;
  actor->SetMapper(mapper);
  vtkProperty* look = actor->GetProperty();
  set_look(look);
  if (are_ghosts) {
    mapper->ScalarVisibilityOff();
    look->SetColor(0.6, 0.62, 0.65);
    look->SetOpacity(0.10);
  }
  renderer->AddActor(actor);
  if (cut && !are_ghosts) add_cut_bodies(renderer, bodies, scene, crossing, colours.value, *cut, colour);
}

/// Tubes from centre to centre, radius and colour by normal force.
void add_network(vtkRenderer* renderer, const Frame& frame, const Scene& scene, const PictureOptions& options,
                 const std::optional<Cut>& cut) {
  const std::vector<NetworkLine> lines = network_of(frame, periodicity_of(scene, frame));
  if (lines.empty()) return;
  double strongest = 0, size = 0;
  for (const NetworkLine& line : lines) strongest = std::max(strongest, std::abs(line.normal_force));
  if (options.range) strongest = options.range->second;
  for (std::size_t i = 0; i < frame.bodies.size(); ++i) {
    size += frame.bodies.scale[i] * scene.shapes[static_cast<std::size_t>(frame.bodies.shape[i])].equivalent_diameter() /
            static_cast<double>(frame.bodies.size());
  }
  constexpr double kThickest = 0.16, kThinnest = 0.008;  // radius over the mean diameter
  vtkNew<vtkPoints> points;
  vtkNew<vtkCellArray> cells;
  vtkNew<vtkDoubleArray> radius, force;
  radius->SetName("radius");
  force->SetName("force");
  for (const NetworkLine& line : lines) {
    const vtkIdType ends[2] = {points->InsertNextPoint(&line.from.x), points->InsertNextPoint(&line.to.x)};
    cells->InsertNextCell(2, ends);
    for (int end = 0; end < 2; ++end) {
      radius->InsertNextValue(size * std::clamp(kThickest * std::abs(line.normal_force) / strongest, kThinnest, kThickest));
      force->InsertNextValue(line.normal_force);
    }
  }
  vtkNew<vtkPolyData> data;
  data->SetPoints(points);
  data->SetLines(cells);
  data->GetPointData()->SetScalars(radius);
  data->GetPointData()->AddArray(force);
  vtkNew<vtkTubeFilter> tubes;
  tubes->SetInputData(data);
  tubes->SetNumberOfSides(10);
  tubes->CappingOn();
  tubes->SetVaryRadiusToVaryRadiusByAbsoluteScalar();
  const auto colours = number_scale(0, strongest);
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputConnection(tubes->GetOutputPort());
  mapper->SetScalarModeToUsePointFieldData();
  mapper->SelectColorArray("force");
  mapper->SetLookupTable(colours);
  mapper->UseLookupTableScalarRangeOn();
  cut_away(mapper, cut);
  vtkNew<vtkActor> actor;
  actor->SetMapper(mapper);
  actor->GetProperty()->SetAmbient(0.2);
  renderer->AddActor(actor);
  if (options.legend) add_legend(renderer, colours, "normal force [N]", options.height);
}

/// Faces by a number of theirs, flat.
vtkSmartPointer<vtkActor> coloured_faces(vtkPolyDataMapper* mapper, const char* number, vtkColorTransferFunction* colours) {
  mapper->SetScalarModeToUseCellFieldData();
  mapper->SelectColorArray(number);
  mapper->SetLookupTable(colours);
  mapper->UseLookupTableScalarRangeOn();
  auto actor = vtkSmartPointer<vtkActor>::New();
  actor->SetMapper(mapper);
  actor->GetProperty()->SetInterpolationToFlat();
  actor->GetProperty()->SetAmbient(0.5);  // the colour is the number: light only shows the shape
  actor->GetProperty()->SetDiffuse(0.5);
  return actor;
}

/// Ends of the scale of a quantity of bonds, which one in a hundred exceeds: about zero where it has two signs, else from zero.
std::pair<double, double> bond_range(const std::vector<BondFace>& faces, const BondQuantity& of) {
  if (faces.empty()) return {0, 0};
  std::vector<double> sizes;
  for (const BondFace& face : faces) sizes.push_back(std::abs(face.*of.value));
  const auto end = sizes.begin() + static_cast<std::ptrdiff_t>(0.99 * static_cast<double>(sizes.size() - 1));
  std::nth_element(sizes.begin(), end, sizes.end());
  return {of.has_signs ? -*end : 0, *end};
}

/// Faces of the bonds that hold, by what they bear.
void add_bond_faces(vtkRenderer* renderer, const Frame& frame, const Scene& scene, const PictureOptions& options,
                    const std::pair<double, double>& range, const std::optional<Cut>& cut) {
  const BondQuantity& of = bond_quantity(options.bonds);
  const auto colours = of.has_signs ? signed_scale(range.first, range.second) : number_scale(range.first, range.second);
  vtkNew<vtkPolyDataMapper> mapper;
  vtkNew<vtkShrinkPolyData> apart;  // else those of many cells are one wall
  apart->SetInputData(vtk_bonds(bond_faces(scene, frame)));
  apart->SetShrinkFactor(0.6);
  mapper->SetInputConnection(apart->GetOutputPort());
  cut_away(mapper, cut);
  renderer->AddActor(coloured_faces(mapper, of.name, colours));
  if (options.legend) add_legend(renderer, colours, of.title, options.height);
}

/// Walls with load maps, opaque, each coloured by a quantity since the start of the run. Of a shell such as a drum the side towards the
/// camera is left out, so that the side that bears is seen.
void add_loads(vtkRenderer* renderer, const Frame& frame, const Scene& scene, const Box3& room, const PictureOptions& options) {
  const std::size_t quantity = load_quantity(options.load);
  const std::vector<WallLoads> loads = wall_loads(scene, Frame{}, frame);
  const auto range = options.range.value_or(std::pair{0.0, end_of_scale(loads, quantity)});
  const auto colours = number_scale(range.first, range.second);
  const std::vector<WallPlace> places = wall_places(frame, scene);
  for (const WallLoads& l : loads) {
    const Wall& wall = scene.walls[l.wall];
    TriangleMesh mesh = drawn_wall(wall, scene, room, &frame);
    double pushed = 0;  // against the normals where bodies lie before the faces
    for (std::int32_t t = 0; t < mesh.triangle_count(); ++t) {
      const auto row = static_cast<std::size_t>(t);
      const Vec3 n = cross(mesh.corner(t, 1) - mesh.corner(t, 0), mesh.corner(t, 2) - mesh.corner(t, 0));
      if (row < l.push.size()) pushed += dot(l.push[row], n) / std::max(length(n), 1e-300);
    }
    for (Vec3& p : mesh.vertices) p = places[l.wall].position + rotate(places[l.wall].orientation, p);
    const auto data = vtk_triangles(mesh);
    vtkNew<vtkDoubleArray> value;
    value->SetName("value");
    for (const double v : l.values[quantity]) value->InsertNextValue(v);
    data->GetCellData()->AddArray(value);
    vtkNew<vtkPolyDataMapper> mapper;
    mapper->SetInputData(data);
    const auto actor = coloured_faces(mapper, "value", colours);
    vtkProperty* look = actor->GetProperty();
    if (pushed != 0) look->SetBackfaceCulling(pushed < 0 ? 1 : 0);
    if (pushed != 0) look->SetFrontfaceCulling(pushed < 0 ? 0 : 1);
    renderer->AddActor(actor);
  }
  if (options.legend) add_legend(renderer, colours, kLoadQuantities[quantity].title, options.height);
}

/// Lines that show where something ends.
vtkSmartPointer<vtkActor> edge_actor(vtkPolyDataMapper* mapper) {
  auto lines = vtkSmartPointer<vtkActor>::New();
  lines->SetMapper(mapper);
  lines->GetProperty()->SetColor(0.35, 0.40, 0.46);
  lines->GetProperty()->SetLineWidth(1.5F);
  lines->GetProperty()->LightingOff();
  return lines;
}

void add_cell(vtkRenderer* renderer, const FrameCell& cell, const Periodicity& period) {
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputData(vtk_cell(cell, period));
  renderer->AddActor(edge_actor(mapper));
}

void add_walls(vtkRenderer* renderer, const Frame& frame, const Scene& scene, const Box3& room) {
  std::vector<TriangleMesh> walls;
  for (const Wall& wall : scene.walls) walls.push_back(drawn_wall(wall, scene, room, &frame));
  if (walls.empty()) return;
  const auto data = vtk_walls(scene, walls, wall_places(frame, scene));
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputData(data);
  mapper->ScalarVisibilityOff();
  vtkNew<vtkActor> actor;
  actor->SetMapper(mapper);
  actor->GetProperty()->SetColor(0.55, 0.62, 0.70);
  actor->GetProperty()->SetOpacity(0.10);
  actor->GetProperty()->LightingOff();
  renderer->AddActor(actor);

  vtkNew<vtkFeatureEdges> edges;
  edges->SetInputData(data);
  edges->SetFeatureAngle(30);
  edges->ManifoldEdgesOff();
  edges->NonManifoldEdgesOff();
  edges->ColoringOff();
  vtkNew<vtkPolyDataMapper> line_mapper;
  line_mapper->SetInputConnection(edges->GetOutputPort());
  renderer->AddActor(edge_actor(line_mapper));
}

}  // namespace

namespace {

/// Bodies of a cell that is sheared lie in the box of its three lengths: those images of them that lie between the edges that are drawn.
void move_into_edges(const Periodicity& period, FrameBodies& bodies) {
  if (!period.is_sheared()) return;
  const Periodicity drawn = period.with_least_shear();
  const bool is_flat = !drawn.is_periodic(2);
  const Vec3 lengths{drawn.period().x, drawn.period().y, is_flat ? 1 : drawn.period().z};
  const UpperMatrix shares = inverse({lengths, drawn.shear()});  // of each edge
  for (Vec3& x : bodies.position) {
    const Vec3 along = shares.times(x - drawn.lower());
    x -= drawn.shift({std::floor(along.x), std::floor(along.y), is_flat ? 0 : std::floor(along.z)});
  }
}

/// What is drawn: all but bodies outside of what the user named. What has left the equipment is drawn where the camera sees it.
Frame as_shown(const Run& run, const Frame& frame, const PictureOptions& options, const Within& within) {
  Frame shown = within.is_equipment() ? frame : within.part_of(run, frame);
  move_into_edges(periodicity_of(run.scene, frame), shown.bodies);
  return options.apart > 0 ? taken_apart(run.scene, shown, options.apart) : shown;
}

}  // namespace

Stage::Stage(const Run& run, const PictureOptions& options)
    : within(Within::named(run, options.within)), bodies(std::make_shared<RunBodies>(run)) {}

void Stage::add(const Run& run, const Frame& given, const PictureOptions& options) {
  const Frame frame = within.part_of(run, as_shown(run, given, options, within));
  const Box3 seen = seen_room(frame, run.scene);
  room.add(seen.lower);
  room.add(seen.upper);
  if (options.network) {
    for (const NetworkLine& line : network_of(frame, periodicity_of(run.scene, frame)))
      range = {0, std::max(range ? range->second : 0, std::abs(line.normal_force))};
    return;
  }
  if (!options.bonds.empty()) {
    const auto of_frame = bond_range(bond_faces(run.scene, frame), bond_quantity(options.bonds));
    range = range ? std::pair{std::min(range->first, of_frame.first), std::max(range->second, of_frame.second)} : of_frame;
    return;
  }
  const BodyColours colours = body_colours(run, *bodies, frame, options.colour);
  if (colours.are_kinds) return;
  for (const double v : colours.value) {
    if (!std::isfinite(v)) continue;
    if (!range) range = {options.colour == "velocity" ? 0 : v, v};  // a speed is compared with rest
    range = {std::min(range->first, v), std::max(range->second, v)};
  }
}

View camera_of(const Stage& stage, const Vec3& gravity, const PictureOptions& options) {
  View view = view_of(stage.room, gravity);
  if (options.at) view.centre = *options.at;
  // the view angle is that of the height: what is narrower than high sees less to its sides
  if (options.width < options.height) view.radius *= static_cast<double>(options.height) / options.width;
  if (options.from) view.from = normalised(*options.from);
  if (options.up) view.up = normalised(*options.up);
  if (length(cross(view.from, view.up)) < 1e-3) {  // looking along `up`: any other direction will do
    view.up = std::abs(view.from.y) < 0.9 ? Vec3{0, 1, 0} : Vec3{1, 0, 0};
  }
  return view;
}

std::optional<Cut> cut_of(const View& view, const PictureOptions& options) {
  if (!options.cut) return std::nullopt;
  const auto [axis, place] = *options.cut;
  Cut cut;
  cut.point[axis] = place;
  constexpr double kAlong = 0.02;  // cosine: within a degree of the plane the cut is not seen
  if (std::abs(view.from[axis]) < kAlong)
    throw UsageError("--cut {}={:g}: the camera looks along this plane; give another direction with --from", "xyz"[axis], place);
  cut.normal[axis] = view.from[axis] > 0 ? 1 : -1;
  return cut;
}

Image draw_frame(const Run& run, const Frame& given, const PictureOptions& options, const Stage& stage, const View& view,
                 const std::optional<Cut>& cut) {
  const Frame frame = as_shown(run, given, options, stage.within);
  PictureOptions look = options;
  if (!look.range) look.range = stage.range;
  const vtkSmartPointer<vtkRenderer> renderer = lit_renderer();
  if (look.load.empty())
    add_bodies(renderer, frame.bodies, run.scene,
               body_colours(run, *stage.bodies, frame, look.network || !look.bonds.empty() ? "shape" : look.colour),
               look.range.value_or(std::pair{0.0, 1.0}), look, cut);
  else
    add_loads(renderer, frame, run.scene, stage.room, options);
  if (look.network) add_network(renderer, frame, run.scene, look, cut);
  if (!look.bonds.empty()) add_bond_faces(renderer, frame, run.scene, look, look.range.value_or(std::pair{0.0, 1.0}), cut);
  if (look.walls) add_walls(renderer, frame, run.scene, stage.room);
  if (look.walls && given.cell.size() > 0) add_cell(renderer, given.cell, periodicity_of(run.scene, given));
  if (look.time) add_time(renderer, frame.time, look.height);
  if (look.network || !look.bonds.empty()) {  // ghosts need their true order in overlap
    renderer->SetUseDepthPeeling(1);
    renderer->SetMaximumNumberOfPeels(8);
  }
  set_camera(renderer, view, look.zoom);
  return draw_image({renderer}, look.width, look.height);
}

std::string words_of_unseen(const Run& run, const std::vector<std::size_t>& frames, const Within& within, const FramePool& pool) {
  const std::string left = words_of_left(extent_of_bodies(run, frames, within, pool), within);
  if (left.empty()) return "";
  return fmt::format("{}: {}; --within all shows all bodies", left,
                     within.is_equipment() ? "the camera does not follow what has left" : "not drawn");
}

std::string draw_picture(const Run& run, std::size_t frame_index, const std::string& path, const PictureOptions& options) {
  if (const std::string reason = display_obstacle(); !reason.empty()) throw SystemError("cannot draw a picture: {}", reason);
  const Frame frame = load_frame(run, frame_index);
  Stage stage(run, options);
  stage.add(run, frame, options);
  if (options.at) {
    Stage whole(run, options);
    for (const std::size_t f : {std::size_t{0}, run.frames.size() - 1})
      whole.add(run, f == frame_index ? frame : load_frame(run, f), options);
    stage.room = whole.room;
  }
  const View view = camera_of(stage, run.scene.settings.gravity, options);
  write_png(draw_frame(run, frame, options, stage, view, cut_of(view, options)), path);
  return words_of_unseen(run, {frame_index}, stage.within, {1, false});
}

}  // namespace scree
