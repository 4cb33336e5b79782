#include "core/picture/picture.hpp"

#include <dlfcn.h>
#include <vtkCamera.h>
#include <vtkCellArray.h>
#include <vtkFloatArray.h>
#include <vtkImageData.h>
#include <vtkLight.h>
#include <vtkNew.h>
#include <vtkPNGWriter.h>
#include <vtkPoints.h>
#include <vtkRenderWindow.h>
#include <vtkWindowToImageFilter.h>

#include <array>
#include <cstdio>
#include <cstdlib>

#include "core/base/error.hpp"
#include "core/storage/h5.hpp"

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

}  // namespace

std::string why_no_picture(const std::string& tool) {
  const char* display = std::getenv("DISPLAY");
  const std::string cure = "run it as: xvfb-run -a -s \"-screen 0 1280x1024x24 -noreset\" " + tool + " ...";
  if (display == nullptr || *display == '\0') return "no X display (DISPLAY is not set); " + cure;
  if (!display_answers()) return fmt::format("the X display {} does not answer; {}", display, cure);
  return "";
}

vtkSmartPointer<vtkPolyData> vtk_triangles(const TriangleMesh& mesh) {
  vtkNew<vtkPoints> points;
  vtkNew<vtkCellArray> triangles;
  points->SetDataTypeToFloat();
  for (const Vec3& p : mesh.vertices) points->InsertNextPoint(p.x, p.y, p.z);
  for (const Triangle& t : mesh.triangles) {
    const vtkIdType corners[3] = {t[0], t[1], t[2]};
    triangles->InsertNextCell(3, corners);
  }
  auto data = vtkSmartPointer<vtkPolyData>::New();
  data->SetPoints(points);
  data->SetPolys(triangles);
  return data;
}

vtkSmartPointer<vtkRenderer> lit_renderer() {
  auto renderer = vtkSmartPointer<vtkRenderer>::New();
  renderer->SetBackground(1, 1, 1);
  renderer->AutomaticLightCreationOff();
  for (const auto& [x, y, z, power] : {std::array{-0.6, 0.9, 0.8, 0.85}, std::array{0.9, 0.2, 0.6, 0.35}}) {
    vtkNew<vtkLight> light;
    light->SetLightTypeToCameraLight();
    light->SetPosition(x, y, z);
    light->SetFocalPoint(0, 0, 0);
    light->SetIntensity(power);
    renderer->AddLight(light);
  }
  return renderer;
}

void set_camera(vtkRenderer* renderer, const View& view, double zoom) {
  vtkCamera* camera = renderer->GetActiveCamera();
  constexpr double kViewAngle = 30;   // [deg]
  constexpr double kDistance = 3.55;  // in radii: the ball just fits into the view angle at an aspect of 4:3
  const Vec3 eye = view.centre + kDistance / zoom * view.radius * view.from;
  camera->SetFocalPoint(view.centre.x, view.centre.y, view.centre.z);
  camera->SetPosition(eye.x, eye.y, eye.z);
  camera->SetViewUp(view.up.x, view.up.y, view.up.z);
  camera->SetViewAngle(kViewAngle);
  renderer->ResetCameraClippingRange();
}

void write_picture(const std::vector<vtkRenderer*>& renderers, int width, int height, const std::string& path) {
  vtkNew<vtkRenderWindow> window;
  window->SetOffScreenRendering(1);
  window->SetMultiSamples(0);
  window->SetAlphaBitPlanes(1);  // for renderers that peel depths
  // drawn at twice the size and averaged: smooth edges on any driver
  window->SetSize(2 * width, 2 * height);
  for (vtkRenderer* renderer : renderers) window->AddRenderer(renderer);
  window->Render();

  vtkNew<vtkWindowToImageFilter> grab;
  grab->SetInput(window);
  grab->ReadFrontBufferOff();
  grab->Update();
  const vtkSmartPointer<vtkImageData> large = grab->GetOutput();
  vtkNew<vtkImageData> image;
  image->SetDimensions(width, height, 1);
  image->AllocateScalars(VTK_UNSIGNED_CHAR, 3);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
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
