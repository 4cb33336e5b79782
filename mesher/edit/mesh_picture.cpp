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

#include <algorithm>
#include <cmath>

#include "core/base/error.hpp"
#include "core/geometry/half_edges.hpp"
#include "core/picture/display.hpp"
#include "core/picture/picture.hpp"

namespace scree {

namespace {

constexpr int kPaneWidth = 640, kPaneHeight = 560;  // [pixels]
constexpr double kApart = 0.6;                      // exploded pieces move out by this part of their distance from the origin
constexpr std::int32_t kMaxEdgesShown = 20'000;     // above this many triangles edges would blacken the picture

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

void add_title(vtkRenderer* renderer, const std::string& words) {
  vtkNew<vtkTextActor> text;
  text->SetInput(words.c_str());
  text->GetTextProperty()->SetFontSize(36);
  text->GetTextProperty()->SetColor(0.1, 0.1, 0.1);
  text->SetPosition(24, 24);
  renderer->AddActor2D(text);
}

/// Colours that differ between neighbours: hues in steps of the golden angle.
Vec3 colour_of(std::size_t i) {
  const double hue = 6 * std::fmod(0.1 + 0.6180339887498949 * static_cast<double>(i), 1.0);
  const auto channel = [&](double shift) { return 0.45 + 0.45 * std::clamp(std::abs(std::fmod(hue + shift, 6.0) - 3) - 1, 0.0, 1.0); };
  return {channel(0), channel(4), channel(2)};
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
    add(renderer, vtk_triangles(*mesh), {0.84, 0.70, 0.50}, 1, mesh->triangle_count() <= kMaxEdgesShown);
    add(renderer, open_edges(*mesh), {0.85, 0.1, 0.1}, 6, false);
    add_title(renderer, fmt::format("{}: {} triangles", title, mesh->triangle_count()));
    set_camera(renderer, view);
    panes.push_back(renderer);
    drawn.push_back(renderer);
  }
  write_picture(drawn, kPaneWidth * static_cast<int>(meshes.size()), kPaneHeight, path);
}

void draw_pieces(const std::string& title, const std::vector<std::pair<TriangleMesh, Vec3>>& pieces, const std::string& path) {
  if (const std::string reason = picture_obstacle(); !reason.empty()) throw SystemError("cannot draw a picture: {}", reason);
  Box3 room;
  for (const auto& [mesh, centre] : pieces) room.add(bounding_box(mesh));
  std::vector<vtkSmartPointer<vtkRenderer>> panes;
  std::vector<vtkRenderer*> drawn;
  for (const double apart : {0.0, kApart}) {
    const vtkSmartPointer<vtkRenderer> renderer = lit_renderer();
    const double left = apart == 0 ? 0 : 0.5;
    renderer->SetViewport(left, 0, left + 0.5, 1);
    for (std::size_t i = 0; i < pieces.size(); ++i) {
      TriangleMesh moved = pieces[i].first;
      for (Vec3& p : moved.vertices) p += apart * pieces[i].second;
      add(renderer, vtk_triangles(moved), colour_of(i), 1, false);
    }
    add_title(renderer, apart == 0 ? title : fmt::format("{} pieces, moved apart", pieces.size()));
    set_camera(renderer, {room.centre(), 0.5 * (1 + 0.8 * kApart) * length(room.extent()), normalised(Vec3{0.55, -0.75, 0.45}), {0, 0, 1}});
    panes.push_back(renderer);
    drawn.push_back(renderer);
  }
  write_picture(drawn, 2 * kPaneWidth, kPaneHeight, path);
}

}  // namespace scree
