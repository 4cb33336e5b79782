#include "decomposer/packing/facets.hpp"

#include <algorithm>
#include <cmath>

#include "core/geometry/features.hpp"
#include "core/geometry/half_edges.hpp"
#include "decomposer/packing/start_points.hpp"

namespace scree {

namespace {

bool has_moving_balls(const SceneParts& parts, const Scene& scene) {
  const auto is_ball = [&](std::int32_t shape) { return scene.shapes[static_cast<std::size_t>(shape)].kind == ShapeKind::sphere; };
  for (std::size_t i = 0; i < scene.bodies.size(); ++i)
    if (scene.bodies.fixed[i] == 0 && is_ball(scene.bodies.shape[i])) return true;
  return !parts.inlets.empty() &&
         std::any_of(scene.shapes.begin(), scene.shapes.end(), [](const Shape& s) { return s.kind == ShapeKind::sphere; });
}

/// Bodies are in the hollow of a wall when more than this share of its shallow edges is hollow towards them: all are inside of a tube, half
/// of them, behind what is in between, from beside it.
constexpr double kAround = 0.75;

/// Vertex of a triangle that is not on an edge.
std::int32_t opposite(const Triangle& t, const HalfEdge& h) {
  for (const std::int32_t v : t)
    if (v != h.low && v != h.high) return v;
  return t[0];
}

}  // namespace

double stiffness_of_two_facets(double angle) {
  constexpr double kSharing = 1.0 / 200;  // of the radius: eta
  const double tangent = std::tan(0.5 * angle), y = 2 * tangent * tangent / kSharing;
  const double shared = y < 1 ? (1 - y * y) * (1 - y * y) : 0;
  return std::pow(2 / (1 + shared), 0.25) - 1;
}

std::vector<Facets> facets_of_walls(const SceneParts& parts, const Scene& scene) {
  std::vector<Facets> all;
  if (!has_moving_balls(parts, scene)) return all;
  const std::vector<Vec3> starts = start_points(parts, scene);
  if (starts.empty()) return all;
  for (std::size_t w = 0; w < parts.walls.size(); ++w) {
    if (parts.walls[w].kind != WallKind::mesh) continue;
    const TriangleMesh& mesh = parts.wall_bodies[w].shape->shape.mesh;
    const std::vector<Vec3> world = parts.wall_bodies[w].world_vertices();
    const auto at = [&](std::int32_t v) -> const Vec3& { return world[static_cast<std::size_t>(v)]; };
    Facets found{parts.walls[w].name, 0, 0, 0};
    std::int64_t shallow = 0;
    const std::vector<HalfEdge> half = sorted_half_edges(mesh);
    for_each_edge(half, [&](std::size_t first, std::size_t last) {
      if (last - first != 2) return;
      const HalfEdge &one = half[first], &two = half[first + 1];
      const Triangle &a = mesh.triangles[static_cast<std::size_t>(one.triangle)],
                     &b = mesh.triangles[static_cast<std::size_t>(two.triangle)];
      const Vec3 along = at(one.high) - at(one.low), middle = 0.5 * (at(one.high) + at(one.low));
      const Vec3 to_a = at(opposite(a, one)) - middle, to_b = at(opposite(b, two)) - middle;
      // normals on one side of the wall, whatever the winding
      const Vec3 doubled_a = cross(along, to_a), doubled_b = cross(to_b, along);
      if (!(squared_length(doubled_a) > 0) || !(squared_length(doubled_b) > 0)) return;
      const Vec3 n_a = normalised(doubled_a), n_b = normalised(doubled_b);
      const double angle = std::atan2(length(cross(n_a, n_b)), dot(n_a, n_b));
      if (angle <= kFlatAngle || angle > kFacetAngle) return;
      ++shallow;
      // the side on which the faces lean towards each other
      const Vec3 hollow = (dot(n_a, to_b) > 0 ? 1.0 : -1.0) * (n_a + n_b);
      const auto on_it = std::count_if(starts.begin(), starts.end(), [&](const Vec3& p) { return dot(p - middle, hollow) > 0; });
      if (2 * on_it <= static_cast<std::ptrdiff_t>(starts.size())) return;
      ++found.edges;
      found.angle = std::max(found.angle, angle);
    });
    found.stiffer = stiffness_of_two_facets(found.angle);
    if (found.edges > kAround * static_cast<double>(shallow)) all.push_back(found);
  }
  return all;
}

}  // namespace scree
