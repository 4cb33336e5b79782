#include "post/vtk/picture.hpp"

#include <vtkActor.h>
#include <vtkCellArray.h>
#include <vtkColorTransferFunction.h>
#include <vtkDoubleArray.h>
#include <vtkFeatureEdges.h>
#include <vtkFloatArray.h>
#include <vtkGlyph3DMapper.h>
#include <vtkIntArray.h>
#include <vtkLookupTable.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper.h>
#include <vtkProperty.h>
#include <vtkRenderer.h>
#include <vtkScalarBarActor.h>
#include <vtkTextActor.h>
#include <vtkTextProperty.h>
#include <vtkTubeFilter.h>

#include <algorithm>
#include <cmath>

#include "core/base/error.hpp"
#include "core/picture/display.hpp"
#include "core/picture/picture.hpp"
#include "post/run/contact_network.hpp"
#include "post/run/drawn_meshes.hpp"
#include "post/vtk/vtk_mesh.hpp"

namespace scree {

namespace {

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

void add_legend(vtkRenderer* renderer, vtkScalarsToColors* colours, const char* title) {
  vtkNew<vtkScalarBarActor> bar;
  bar->SetLookupTable(colours);
  bar->SetTitle(title);
  bar->SetNumberOfLabels(5);
  bar->SetLabelFormat("%.3g");
  bar->SetUnconstrainedFontSize(true);
  bar->SetPosition(0.90, 0.06);
  bar->SetWidth(0.06);
  bar->SetHeight(0.36);
  for (vtkTextProperty* text : {bar->GetTitleTextProperty(), bar->GetLabelTextProperty()}) {
    text->SetColor(0.1, 0.1, 0.1);
    text->SetFontSize(28);
    text->ItalicOff();
    text->BoldOff();
    text->ShadowOff();
  }
  bar->SetTextPositionToPrecedeScalarBar();
  bar->SetVerticalTitleSeparation(18);
  renderer->AddActor2D(bar);
}

void add_time(vtkRenderer* renderer, double time, int height) {
  vtkNew<vtkTextActor> text;
  text->SetInput(fmt::format("t = {:.4g} s", time).c_str());
  text->GetTextProperty()->SetColor(0.1, 0.1, 0.1);
  text->GetTextProperty()->SetFontSize(44);
  text->SetPosition(40, 2 * height - 80);
  renderer->AddActor2D(text);
}

void add_bodies(vtkRenderer* renderer, const FrameBodies& bodies, const Scene& scene, const PictureOptions& options) {
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  vtkNew<vtkDoubleArray> orientation, scale, value;
  vtkNew<vtkIntArray> shape;
  orientation->SetName("quat");
  orientation->SetNumberOfComponents(4);
  scale->SetName("scale");
  shape->SetName("shape");
  value->SetName("value");
  const bool by_speed = options.colour == "velocity";
  double fastest = 0;
  std::int32_t most = 0;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const Vec3& x = bodies.position[i];
    const Quat& q = bodies.orientation[i];
    points->InsertNextPoint(x.x, x.y, x.z);
    orientation->InsertNextTuple4(q.w, q.x, q.y, q.z);
    scale->InsertNextValue(bodies.scale[i]);
    shape->InsertNextValue(bodies.shape[i]);
    const std::int32_t kind =
        options.colour == "rank" ? bodies.rank[i] : (options.colour == "material" ? bodies.material[i] : bodies.shape[i]);
    const double speed = length(bodies.velocity[i]);
    value->InsertNextValue(by_speed ? speed : kind);
    fastest = std::max(fastest, speed);
    most = std::max(most, kind);
  }
  vtkNew<vtkPolyData> data;
  data->SetPoints(points);
  for (vtkDataArray* array : std::initializer_list<vtkDataArray*>{orientation, scale, shape, value}) data->GetPointData()->AddArray(array);

  vtkNew<vtkGlyph3DMapper> mapper;
  for (int k = 0; k < static_cast<int>(scene.shapes.size()); ++k) {
    mapper->SetSourceData(k, vtk_mesh(drawn_shape(scene.shapes[static_cast<std::size_t>(k)])));
  }
  if (by_speed && bodies.size() > 0) {
    const auto colours = number_scale(0, fastest);
    mapper->SetLookupTable(colours);
    if (!options.network) add_legend(renderer, colours, "speed [m/s]");
  } else {
    vtkNew<vtkLookupTable> colours;
    colours->SetNumberOfTableValues(most + 1);
    colours->SetTableRange(-0.5, most + 0.5);
    for (std::int32_t k = 0; k <= most; ++k) {
      const Vec3 c = shape_colour(k);
      colours->SetTableValue(k, c.x, c.y, c.z, 1);
    }
    mapper->SetLookupTable(colours);
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
  look->SetAmbient(0.12);
  look->SetDiffuse(0.88);
  look->SetSpecular(0.05);
  if (options.network) {  // ghosts around their forces
    mapper->ScalarVisibilityOff();
    look->SetColor(0.6, 0.62, 0.65);
    look->SetOpacity(0.10);
  }
  renderer->AddActor(actor);
}

/// Tubes from centre to centre, radius and colour by normal force.
void add_network(vtkRenderer* renderer, const Frame& frame, const Scene& scene) {
  const std::vector<NetworkLine> lines = network_of(frame, periodicity_of(scene));
  if (lines.empty()) return;
  double strongest = 0, size = 0;
  for (const NetworkLine& line : lines) strongest = std::max(strongest, std::abs(line.normal_force));
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
      radius->InsertNextValue(size * std::max(kThinnest, kThickest * std::abs(line.normal_force) / strongest));
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
  vtkNew<vtkActor> actor;
  actor->SetMapper(mapper);
  actor->GetProperty()->SetAmbient(0.2);
  renderer->AddActor(actor);
  add_legend(renderer, colours, "normal force [N]");
}

void add_walls(vtkRenderer* renderer, const Frame& frame, const Scene& scene, const Box3& room) {
  std::vector<TriangleMesh> walls;
  for (const Wall& wall : scene.walls) walls.push_back(drawn_wall(wall, scene, room));
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
  vtkNew<vtkActor> lines;
  lines->SetMapper(line_mapper);
  lines->GetProperty()->SetColor(0.35, 0.40, 0.46);
  lines->GetProperty()->SetLineWidth(1.5F);
  lines->GetProperty()->LightingOff();
  renderer->AddActor(lines);
}

}  // namespace

void draw_picture(const Run& run, std::size_t frame_index, const std::string& path, const PictureOptions& options) {
  if (const std::string reason = display_obstacle(); !reason.empty()) throw SystemError("cannot draw a picture: {}", reason);
  const Frame frame = load_frame(run, frame_index);
  const Box3 room = room_of(frame.bodies, run.scene);
  View view = view_of(room, run.scene.settings.gravity);
  if (options.at) view.centre = *options.at;
  if (options.from) view.from = normalised(*options.from);
  if (options.up) view.up = normalised(*options.up);
  if (length(cross(view.from, view.up)) < 1e-3) {  // looking along `up`: any other direction will do
    view.up = std::abs(view.from.y) < 0.9 ? Vec3{0, 1, 0} : Vec3{1, 0, 0};
  }

  const vtkSmartPointer<vtkRenderer> renderer = lit_renderer();
  add_bodies(renderer, frame.bodies, run.scene, options);
  if (options.network) add_network(renderer, frame, run.scene);
  if (options.walls) add_walls(renderer, frame, run.scene, room);
  if (options.time) add_time(renderer, frame.time, options.height);
  if (options.network) {  // ghosts need their true order in overlap
    renderer->SetUseDepthPeeling(1);
    renderer->SetMaximumNumberOfPeels(8);
  }
  set_camera(renderer, view, options.zoom);
  write_picture({renderer}, options.width, options.height, path);
}

}  // namespace scree
