#include "post/picture.hpp"

#include <dlfcn.h>
#include <vtkActor.h>
#include <vtkCamera.h>
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
#include <vtkWindowToImageFilter.h>

#include <cstdio>
#include <cstdlib>

#include "core/storage/h5.hpp"
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

void add_bodies(vtkRenderer* renderer, const FrameBodies& bodies, const Scene& scene) {
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  vtkNew<vtkDoubleArray> orientation, scale;
  vtkNew<vtkIntArray> shape;
  orientation->SetName("quat");
  orientation->SetNumberOfComponents(4);
  scale->SetName("scale");
  shape->SetName("shape");
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const Vec3& x = bodies.position[i];
    const Quat& q = bodies.orientation[i];
    points->InsertNextPoint(x.x, x.y, x.z);
    orientation->InsertNextTuple4(q.w, q.x, q.y, q.z);
    scale->InsertNextValue(bodies.scale[i]);
    shape->InsertNextValue(bodies.shape[i]);
  }
  vtkNew<vtkPolyData> data;
  data->SetPoints(points);
  data->GetPointData()->AddArray(orientation);
  data->GetPointData()->AddArray(scale);
  data->GetPointData()->AddArray(shape);

  const int count = static_cast<int>(scene.shapes.size());
  vtkNew<vtkLookupTable> colours;
  colours->SetNumberOfTableValues(count);
  colours->SetTableRange(-0.5, count - 0.5);
  vtkNew<vtkGlyph3DMapper> mapper;
  for (int k = 0; k < count; ++k) {
    mapper->SetSourceData(k, vtk_mesh(drawn_shape(scene.shapes[static_cast<std::size_t>(k)])));
    const Vec3 c = shape_colour(k);
    colours->SetTableValue(k, c.x, c.y, c.z, 1);
  }
  mapper->SetInputData(data);
  mapper->SourceIndexingOn();
  mapper->SetSourceIndexArray("shape");
  mapper->SetOrientationArray("quat");
  mapper->SetOrientationModeToQuaternion();
  mapper->SetScaleArray("scale");
  mapper->SetScaleModeToScaleByMagnitude();
  mapper->SetScalarModeToUsePointFieldData();
  mapper->SelectColorArray("shape");
  mapper->SetLookupTable(colours);
  mapper->UseLookupTableScalarRangeOn();
  vtkNew<vtkActor> actor;
  actor->SetMapper(mapper);
  actor->GetProperty()->SetAmbient(0.12);
  actor->GetProperty()->SetDiffuse(0.88);
  actor->GetProperty()->SetSpecular(0.05);
  renderer->AddActor(actor);
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
  const View view = view_of(room, run.scene.settings.gravity);

  vtkNew<vtkRenderer> renderer;
  renderer->SetBackground(1, 1, 1);
  add_bodies(renderer, frame.bodies, run.scene);
  if (options.walls) add_walls(renderer, frame, run.scene, room);

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
  // drawn at twice the size and averaged: smooth edges on any driver
  window->SetSize(2 * options.width, 2 * options.height);
  window->AddRenderer(renderer);
  vtkCamera* camera = renderer->GetActiveCamera();
  constexpr double kViewAngle = 30;      // [deg]
  constexpr double kDistance = 3.55;     // in radii: the ball just fits into the view angle at an aspect of 4:3
  const Vec3 eye = view.centre + kDistance * view.radius * view.from;
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
