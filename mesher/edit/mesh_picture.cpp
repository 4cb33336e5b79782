#include "mesher/edit/mesh_picture.hpp"

#include <fmt/format.h>
#include <vtkActor.h>
#include <vtkCamera.h>
#include <vtkCellArray.h>
#include <vtkNew.h>
#include <vtkPolyDataMapper.h>
#include <vtkProperty.h>
#include <vtkTextActor.h>
#include <vtkTextProperty.h>

#include "core/base/error.hpp"
#include "core/picture/display.hpp"
#include "core/picture/picture.hpp"
#include "mesher/check/half_edges.hpp"

namespace scree {

namespace {

constexpr int kPaneWidth = 640, kPaneHeight = 560;  // [pixels]
constexpr std::int32_t kMostEdgesShown = 20'000;    // above this many triangles edges would blacken the picture

vtkSmartPointer<vtkPolyData> open_edges(const TriangleMesh& mesh) {
  const std::vector<HalfEdge> half = sorted_half_edges(mesh);
  vtkNew<vtkCellArray> lines;
  for_each_edge(half, [&](std::size_t i, std::size_t j) {
    if (j - i == 2) return;
    const vtkIdType ends[2] = {half[i].low, half[i].high};
    lines->InsertNextCell(2, ends);
  });
  auto data = vtk_triangles({mesh.vertices, {}});
  data->SetPolys(nullptr);
  data->SetLines(lines);
  return data;
}

void add(vtkRenderer* renderer, vtkPolyData* data, const Vec3& colour, double line_width, bool with_edges) {
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputData(data);
  mapper->ScalarVisibilityOff();
  vtkNew<vtkActor> actor;
  actor->SetMapper(mapper);
  vtkProperty* property = actor->GetProperty();
  property->SetColor(colour.x, colour.y, colour.z);
  property->SetInterpolationToFlat();
  property->SetAmbient(0.15);
  property->SetDiffuse(0.85);
  property->SetLineWidth(static_cast<float>(line_width));
  if (with_edges) {
    property->EdgeVisibilityOn();
    property->SetEdgeColor(0.25, 0.22, 0.18);
  }
  renderer->AddActor(actor);
}

}  // namespace

std::string picture_obstacle() { return display_obstacle(); }

void draw_meshes(const std::vector<std::pair<std::string, const TriangleMesh*>>& meshes, const std::string& path) {
  if (const std::string reason = picture_obstacle(); !reason.empty()) throw SystemError("cannot draw a picture: {}", reason);
  Box3 room;
  for (const auto& [title, mesh] : meshes) room.add(bounding_box(*mesh));
  const View view{room.centre(), 0.5 * length(room.extent()), normalised(Vec3{0.55, -0.75, 0.45}), {0, 0, 1}};
  std::vector<vtkSmartPointer<vtkRenderer>> panes;
  std::vector<vtkRenderer*> drawn;
  const double share = 1.0 / static_cast<double>(meshes.size());
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    const auto& [title, mesh] = meshes[i];
    const vtkSmartPointer<vtkRenderer> renderer = lit_renderer();
    renderer->SetViewport(share * static_cast<double>(i), 0, share * static_cast<double>(i + 1), 1);
    add(renderer, vtk_triangles(*mesh), {0.84, 0.70, 0.50}, 1, mesh->triangle_count() <= kMostEdgesShown);
    add(renderer, open_edges(*mesh), {0.85, 0.1, 0.1}, 6, false);
    vtkNew<vtkTextActor> text;
    text->SetInput(fmt::format("{}: {} triangles", title, mesh->triangle_count()).c_str());
    text->GetTextProperty()->SetFontSize(36);
    text->GetTextProperty()->SetColor(0.1, 0.1, 0.1);
    text->SetPosition(24, 24);
    renderer->AddActor2D(text);
    set_camera(renderer, view);
    panes.push_back(renderer);
    drawn.push_back(renderer);
  }
  write_picture(drawn, kPaneWidth * static_cast<int>(meshes.size()), kPaneHeight, path);
}

}  // namespace scree
