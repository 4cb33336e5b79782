#include "post/picture.hpp"

#include <dlfcn.h>
#include <vtkActor.h>
#include <vtkCamera.h>
#include <vtkCellArray.h>
#include <vtkColorTransferFunction.h>
#include <vtkDoubleArray.h>
#include <vtkFeatureEdges.h>
#include <vtkFloatArray.h>
#include <vtkGlyph3DMapper.h>
#include <vtkIntArray.h>
#include <vtkLight.h>
#include <vtkLookupTable.h>
#include <vtkNew.h>
#include <vtkPNGWriter.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper.h>
#include <vtkProperty.h>
#include <vtkRenderWindow.h>
#include <vtkRenderer.h>
#include <vtkScalarBarActor.h>
#include <vtkTextActor.h>
#include <vtkTextProperty.h>
#include <vtkTubeFilter.h>
#include <vtkWindowToImageFilter.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>

#include "core/base/error.hpp"
#include "core/storage/h5.hpp"
#include "post/contact_network.hpp"
#include "post/drawn_meshes.hpp"
#include "post/vtk_mesh.hpp"

namespace scree {

namespace {

/// True when the X server that DISPLAY names answers. VTK itself would abort the program.
bool display_answers() {
  void* library = dlopen("libX11.so.6", RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) return false;
  using Open = void* (*)(const char*);
  using Close = int (*)(void*);
  const auto open_display = reinterpret_cast<Open>(dlsym(library, "XOpenDisplay"));
  const auto close_display = reinterpret_cast<Close>(dlsym(library, "XCloseDisplay"));
  if (open_display == nullptr || close_display == nullptr) return false;
  void* display = open_display(nullptr);
  if (display != nullptr) close_display(display);
  return display != nullptr;  // the library stays loaded: X11 does not like to be unloaded
}

/// A scale for numbers: viridis, which rises evenly in brightness, so that it reads in grey and for the colour-blind.
/// Source: N. Smith, S. van der Walt, E. Firing, matplotlib 2.0, CC0.
vtkSmartPointer<vtkColorTransferFunction> number_scale(double low, double high) {
  static constexpr std::array<std::array<double, 3>, 9> kViridis{{{0.267, 0.005, 0.329}, {0.279, 0.175, 0.483}, {0.230, 0.322, 0.546},
                                                                  {0.173, 0.449, 0.558}, {0.128, 0.567, 0.551}, {0.158, 0.684, 0.502},
                                                                  {0.369, 0.789, 0.383}, {0.678, 0.864, 0.190}, {0.993, 0.906, 0.144}}};
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
  double slowest = 1e300, fastest = 0;
  std::int32_t most = 0;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const Vec3& x = bodies.position[i];
    const Quat& q = bodies.orientation[i];
    points->InsertNextPoint(x.x, x.y, x.z);
    orientation->InsertNextTuple4(q.w, q.x, q.y, q.z);
    scale->InsertNextValue(bodies.scale[i]);
    shape->InsertNextValue(bodies.shape[i]);
    const std::int32_t kind = options.colour == "rank" ? bodies.rank[i] : (options.colour == "material" ? bodies.material[i] : bodies.shape[i]);
    const double speed = length(bodies.velocity[i]);
    value->InsertNextValue(by_speed ? speed : kind);
    slowest = std::min(slowest, speed);
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
    const auto colours = number_scale(slowest, fastest);
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
  for (const NetworkLine& line : lines) strongest = std::max(strongest, line.normal_force);
  for (std::size_t i = 0; i < frame.bodies.size(); ++i) {
    size += frame.bodies.scale[i] * scene.shapes[static_cast<std::size_t>(frame.bodies.shape[i])].equivalent_diameter() / static_cast<double>(frame.bodies.size());
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
      radius->InsertNextValue(size * std::max(kThinnest, kThickest * line.normal_force / strongest));
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

std::string why_no_picture() {
  const char* display = std::getenv("DISPLAY");
  const std::string cure = "run it as: xvfb-run -a -s \"-screen 0 1280x1024x24 -noreset\" scree-post ...";
  if (display == nullptr || *display == '\0') return "no X display (DISPLAY is not set); " + cure;
  if (!display_answers()) return fmt::format("the X display {} does not answer; {}", display, cure);
  return "";
}

void draw_picture(const Run& run, std::size_t frame_index, const std::string& path, const PictureOptions& options) {
  if (const std::string reason = why_no_picture(); !reason.empty()) throw SystemError("cannot draw a picture: {}", reason);
  const Frame frame = load_frame(run, frame_index);
  const Box3 room = room_of(frame.bodies, run.scene);
  View view = view_of(room, run.scene.settings.gravity);
  if (options.at) view.centre = *options.at;
  if (options.from) view.from = normalised(*options.from);
  if (options.up) view.up = normalised(*options.up);
  if (length(cross(view.from, view.up)) < 1e-3) {  // looking along `up`: any other direction will do
    view.up = std::abs(view.from.y) < 0.9 ? Vec3{0, 1, 0} : Vec3{1, 0, 0};
  }

  vtkNew<vtkRenderer> renderer;
  renderer->SetBackground(1, 1, 1);
  add_bodies(renderer, frame.bodies, run.scene, options);
  if (options.network) add_network(renderer, frame, run.scene);
  if (options.walls) add_walls(renderer, frame, run.scene, room);
  if (options.time) add_time(renderer, frame.time, options.height);

  // a key light over the left shoulder and a soft one from the other side, so that facets show
  renderer->AutomaticLightCreationOff();
  for (const auto& [x, y, z, power] : {std::array{-0.6, 0.9, 0.8, 0.85}, std::array{0.9, 0.2, 0.6, 0.35}}) {
    vtkNew<vtkLight> light;
    light->SetLightTypeToCameraLight();
    light->SetPosition(x, y, z);
    light->SetFocalPoint(0, 0, 0);
    light->SetIntensity(power);
    renderer->AddLight(light);
  }

  vtkNew<vtkRenderWindow> window;
  window->SetOffScreenRendering(1);
  window->SetMultiSamples(0);
  if (options.network) {  // ghosts need their true order in depth
    window->SetAlphaBitPlanes(1);
    renderer->SetUseDepthPeeling(1);
    renderer->SetMaximumNumberOfPeels(8);
  }
  // drawn at twice the size and averaged: smooth edges on any driver
  window->SetSize(2 * options.width, 2 * options.height);
  window->AddRenderer(renderer);
  vtkCamera* camera = renderer->GetActiveCamera();
  constexpr double kViewAngle = 30;      // [deg]
  constexpr double kDistance = 3.55;     // in radii: the ball just fits into the view angle at an aspect of 4:3
  const Vec3 eye = view.centre + kDistance / options.zoom * view.radius * view.from;
  camera->SetFocalPoint(view.centre.x, view.centre.y, view.centre.z);
  camera->SetPosition(eye.x, eye.y, eye.z);
  camera->SetViewUp(view.up.x, view.up.y, view.up.z);
  camera->SetViewAngle(kViewAngle);
  renderer->ResetCameraClippingRange();
  window->Render();

  vtkNew<vtkWindowToImageFilter> grab;
  grab->SetInput(window);
  grab->ReadFrontBufferOff();
  grab->Update();
  const vtkSmartPointer<vtkImageData> large = grab->GetOutput();
  vtkNew<vtkImageData> image;
  image->SetDimensions(options.width, options.height, 1);
  image->AllocateScalars(VTK_UNSIGNED_CHAR, 3);
  for (int y = 0; y < options.height; ++y) {
    for (int x = 0; x < options.width; ++x) {
      auto* pixel = static_cast<unsigned char*>(image->GetScalarPointer(x, y, 0));
      for (int c = 0; c < 3; ++c) {
        int sum = 2;
        for (const auto& [dx, dy] : {std::array{0, 0}, std::array{1, 0}, std::array{0, 1}, std::array{1, 1}}) {
          sum += static_cast<unsigned char*>(large->GetScalarPointer(2 * x + dx, 2 * y + dy, 0))[c];
        }
        pixel[c] = static_cast<unsigned char>(sum / 4);
      }
    }
  }
  const std::string temporary = h5::temporary_name(path);
  vtkNew<vtkPNGWriter> writer;
  writer->SetFileName(temporary.c_str());
  writer->SetInputData(image);
  writer->Write();
  if (writer->GetErrorCode() != 0) {
    std::remove(temporary.c_str());
    throw SystemError("cannot write {}; is the disk full, or the folder not writable?", path);
  }
  h5::publish_file(temporary, path);
}

}  // namespace scree
