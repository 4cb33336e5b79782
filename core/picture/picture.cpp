#include "core/picture/picture.hpp"

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
#include <cstring>

#include "core/base/error.hpp"
#include "core/base/temporary_file.hpp"
#include "core/picture/display.hpp"

namespace scree {

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
  constexpr double kDistance = 3.87;  // in radii, 1 / sin(angle / 2): the whole ball is in view where the picture is not higher than wide
  const Vec3 eye = view.centre + kDistance / zoom * view.radius * view.from;
  camera->SetFocalPoint(view.centre.x, view.centre.y, view.centre.z);
  camera->SetPosition(eye.x, eye.y, eye.z);
  camera->SetViewUp(view.up.x, view.up.y, view.up.z);
  camera->SetViewAngle(kViewAngle);
  renderer->ResetCameraClippingRange();
}

Image draw_image(const std::vector<vtkRenderer*>& renderers, int width, int height) {
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
  Image image{width, height, std::vector<unsigned char>(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 3)};
  for (int y = 0; y < height; ++y) {
    const int from_below = height - 1 - y;
    for (int x = 0; x < width; ++x) {
      unsigned char* pixel = &image.rgb[3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x))];
      for (int c = 0; c < 3; ++c) {
        int sum = 2;
        for (const auto& [dx, dy] : {std::array{0, 0}, std::array{1, 0}, std::array{0, 1}, std::array{1, 1}}) {
          sum += static_cast<unsigned char*>(large->GetScalarPointer(2 * x + dx, 2 * from_below + dy, 0))[c];
        }
        pixel[c] = static_cast<unsigned char>(sum / 4);
      }
    }
  }
  return image;
}

void write_picture(const std::vector<vtkRenderer*>& renderers, int width, int height, const std::string& path) {
  write_png(draw_image(renderers, width, height), path);
}

void write_png(const Image& drawn, const std::string& path) {
  vtkNew<vtkImageData> image;
  image->SetDimensions(drawn.width, drawn.height, 1);
  image->AllocateScalars(VTK_UNSIGNED_CHAR, 3);
  const std::size_t row = 3 * static_cast<std::size_t>(drawn.width);
  for (int y = 0; y < drawn.height; ++y) {
    std::memcpy(image->GetScalarPointer(0, drawn.height - 1 - y, 0), &drawn.rgb[row * static_cast<std::size_t>(y)], row);
  }
  TemporaryFile temporary(path);
  vtkNew<vtkPNGWriter> writer;
  writer->SetFileName(temporary.name().c_str());
  writer->SetInputData(image);
  writer->Write();
  if (writer->GetErrorCode() != 0) throw SystemError("cannot write {}; is the disk full, or the folder not writable?", path);
  temporary.publish();
}

}  // namespace scree
