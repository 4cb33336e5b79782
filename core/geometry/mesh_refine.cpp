#include "core/geometry/mesh_refine.hpp"

#include <cmath>
#include <vector>

#include "core/base/error.hpp"
#include "core/geometry/half_edges.hpp"

namespace scree {

namespace {

/// One round: splits the edges for which `wants` is true; returns their number.
template <class Wants>
std::int64_t split_edges(TriangleMesh& mesh, const Wants& wants) {
  const std::vector<HalfEdge> half = sorted_half_edges(mesh);
  std::vector<std::array<std::int32_t, 3>> middle(mesh.triangles.size(), {-1, -1, -1});
  std::int64_t splits = 0;
  for_each_edge(half, [&](std::size_t i, std::size_t j) {
    const Vec3 a = mesh.vertices[static_cast<std::size_t>(half[i].low)], b = mesh.vertices[static_cast<std::size_t>(half[i].high)];
    if (half[i].low == half[i].high || !wants(a, b)) return;
    for (std::size_t h = i; h < j; ++h) {
      middle[static_cast<std::size_t>(half[h].triangle)][static_cast<std::size_t>(half[h].k)] = mesh.vertex_count();
    }
    mesh.vertices.push_back(0.5 * (a + b));
    ++splits;
  });
  if (splits == 0) return 0;
  std::vector<Triangle> result;
  result.reserve(2 * mesh.triangles.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    Triangle v = mesh.triangles[t];
    std::array<std::int32_t, 3> m = middle[t];
    const auto turn = [&] { v = {v[1], v[2], v[0]}, m = {m[1], m[2], m[0]}; };
    const int count = (m[0] >= 0) + (m[1] >= 0) + (m[2] >= 0);
    if (count == 0) {
      result.push_back(v);
    } else if (count == 1) {
      while (m[0] < 0) turn();
      result.insert(result.end(), {Triangle{v[0], m[0], v[2]}, Triangle{m[0], v[1], v[2]}});
    } else if (count == 2) {
      while (m[2] >= 0) turn();
      // the quadrilateral v0 m0 m1 v2 is cut along its shorter diagonal
      const auto p = [&](std::int32_t i) { return mesh.vertices[static_cast<std::size_t>(i)]; };
      result.push_back({m[0], v[1], m[1]});
      if (squared_length(p(m[0]) - p(v[2])) <= squared_length(p(v[0]) - p(m[1]))) {
        result.insert(result.end(), {Triangle{v[0], m[0], v[2]}, Triangle{m[0], m[1], v[2]}});
      } else {
        result.insert(result.end(), {Triangle{v[0], m[0], m[1]}, Triangle{v[0], m[1], v[2]}});
      }
    } else {
      result.insert(result.end(),
                    {Triangle{v[0], m[0], m[2]}, Triangle{v[1], m[1], m[0]}, Triangle{v[2], m[2], m[1]}, Triangle{m[0], m[1], m[2]}});
    }
  }
  mesh.triangles = std::move(result);
  return splits;
}

}  // namespace

std::int64_t refine_mesh(TriangleMesh& mesh, double edge_length, std::int64_t most_triangles) {
  const double longest2 = edge_length * edge_length;
  const auto too_many = [&] {
    return UsageError("refine: edges of at most {:.4g} m need more than {} triangles; give a larger length", edge_length, most_triangles);
  };
  // no triangle of such edges is larger than the equilateral one: known before anything is split
  if (surface_area(mesh) > static_cast<double>(most_triangles) * 0.25 * std::sqrt(3.0) * longest2) throw too_many();
  std::int64_t splits = 0;
  for (;;) {
    const std::int64_t round = split_edges(mesh, [&](const Vec3& a, const Vec3& b) { return squared_length(b - a) > longest2; });
    if (round == 0) return splits;
    splits += round;
    if (static_cast<std::int64_t>(mesh.triangles.size()) > most_triangles) throw too_many();
  }
}

void split_in_four(TriangleMesh& mesh) {
  split_edges(mesh, [](const Vec3&, const Vec3&) { return true; });
}

}  // namespace scree
