#include "core/placing/placed_body.hpp"

#include <algorithm>
#include <cmath>

#include "core/surface/touch_surface.hpp"

namespace scree {

namespace {

MeshView view_of(const PlacedBody& b) { return {&b.shape->shape.mesh, &b.shape->bvh}; }

Vec3 local_point(const PlacedBody& b, const Vec3& world) { return (1.0 / b.scale) * rotate_inverse(b.orientation, world - b.position); }

/// Whether the (whole) body `inner` lies in the solid of `outer`, given that the surfaces do not cross.
bool is_swallowed(const PlacedBody& inner, const PlacedBody& outer) {
  if (outer.shape->shape.kind == ShapeKind::surface) return false;
  // all of inner is in outer's bounding ball, or it is not inside: nearly always settled by the first vertices
  const double radius = outer.radius();
  const Mat3 rotation = matrix_of(inner.orientation);
  Vec3 first;
  for (std::size_t i = 0; i < inner.shape->shape.mesh.vertices.size(); ++i) {
    const Vec3 p = inner.position + inner.scale * (rotation * inner.shape->shape.mesh.vertices[i]);
    if (length(p - outer.position) + inner.rounding() > radius) return false;
    if (i == 0) first = p;
  }
  if (outer.is_sphere()) return true;
  return is_inside(outer.shape->shape.mesh, local_point(outer, first));
}

}  // namespace

PackShape make_pack_shape(Shape shape, const Settings& settings) {
  PackShape result;
  TouchSurface touch = touch_surface(shape, settings);
  result.shape = std::move(shape);
  result.shape.mesh = std::move(touch.mesh);
  result.margin = touch.margin;
  result.bvh = build_bvh(result.shape.mesh);
  result.radius = result.shape.bounding_radius() + result.margin;
  if (result.shape.kind == ShapeKind::sphere) {
    result.inner_radius = result.shape.sphere_radius;
  } else if (result.shape.kind == ShapeKind::solid && is_inside(result.shape.mesh, Vec3{})) {
    Vec3 nearest;
    std::int32_t triangle = -1;
    result.inner_radius = result.margin + point_mesh_distance({&result.shape.mesh, &result.bvh}, Vec3{}, result.radius, nearest, triangle);
  }
  return result;
}

std::vector<Vec3> PlacedBody::world_vertices() const {
  std::vector<Vec3> result;
  world_vertices(result);
  return result;
}

void PlacedBody::world_vertices(std::vector<Vec3>& result) const {
  const Mat3 rotation = matrix_of(orientation);
  result.clear();
  for (const Vec3& p : shape->shape.mesh.vertices) result.push_back(position + scale * (rotation * p));
}

Box3 PlacedBody::world_box() const {
  // Lanes of their own for the extremes, since a compiler may not reorder comparisons of floating-point numbers by itself.
  constexpr std::size_t kLanes = 8;
  double low[3][kLanes], high[3][kLanes];
  for (int k = 0; k < 3; ++k) {
    std::fill_n(low[k], kLanes, 1e308);
    std::fill_n(high[k], kLanes, -1e308);
  }
  const Mat3 rotation = matrix_of(orientation);
  const std::vector<Vec3>& vertices = shape->shape.mesh.vertices;
  for (std::size_t first = 0; first < vertices.size(); first += kLanes) {
    // the last block starts earlier instead of being shorter
    const std::size_t start = vertices.size() < kLanes ? 0 : std::min(first, vertices.size() - kLanes);
    for (std::size_t l = 0; l < std::min(kLanes, vertices.size()); ++l) {
      const Vec3 p = scale * (rotation * vertices[start + l]);
      for (int k = 0; k < 3; ++k) {
        low[k][l] = std::min(low[k][l], p[k]);
        high[k][l] = std::max(high[k][l], p[k]);
      }
    }
  }
  Box3 box;
  for (int k = 0; k < 3; ++k) {
    box.lower[k] = position[k] + *std::min_element(low[k], low[k] + kLanes) - rounding();
    box.upper[k] = position[k] + *std::max_element(high[k], high[k] + kLanes) + rounding();
  }
  return box;
}

double gap_between(const PlacedBody& a, const PlacedBody& b, double upper_bound, MeshDistanceScratch& scratch) {
  double gap = upper_bound;
  if (a.is_sphere() && b.is_sphere()) {
    gap = length(a.position - b.position) - a.rounding() - b.rounding();
  } else if (a.is_sphere() || b.is_sphere()) {
    const PlacedBody &sphere = a.is_sphere() ? a : b, &mesh = a.is_sphere() ? b : a;
    Vec3 nearest;
    std::int32_t triangle = -1;
    const double around = sphere.rounding() + mesh.rounding(), reach = (upper_bound + around) / mesh.scale;
    const double found = point_mesh_distance(view_of(mesh), local_point(mesh, sphere.position), reach, nearest, triangle);
    // nothing within reach: the bound itself, since (bound + radius) - radius may round to less than the bound
    if (triangle >= 0) gap = mesh.scale * found - around;
  } else {
    const Placement placement = relative_placement(a.position, a.orientation, a.scale, b.position, b.orientation, b.scale);
    const double around = a.margin() + b.margin(), reach = (upper_bound + around) / a.scale;
    const double found = mesh_distance(view_of(a), view_of(b), placement, reach, scratch);
    if (!(found > 0)) return kIntersect;
    if (found < reach) gap = a.scale * found - around;
  }
  const double pressed = a.is_sphere() && b.is_sphere() ? std::min(a.rounding(), b.rounding()) : a.rounding() + b.rounding();
  if (gap < 0 && !(gap > -pressed)) return kIntersect;
  if (is_swallowed(a, b) || is_swallowed(b, a)) return kIntersect;
  return std::min(gap, upper_bound);
}

bool wall_allows(const Wall& wall, const PlacedBody* mesh, bool is_solid, const PlacedBody& body, const std::vector<Vec3>& vertices,
                 double gap, MeshDistanceScratch& scratch) {
  // the particles' side of every analytic wall is convex: it holds a body when it holds its vertices
  const double reach = gap + body.rounding();
  const auto all = [&](auto&& distance) {
    return std::all_of(vertices.begin(), vertices.end(), [&](const Vec3& p) { return distance(p) >= reach; });
  };
  switch (wall.kind) {
    case WallKind::plane:
      return all([&](const Vec3& p) { return dot(wall.normal, p - wall.point); });
    case WallKind::box_inside:
      return all([&](const Vec3& p) {
        double least = 1e300;
        for (int k = 0; k < 3; ++k) least = std::min({least, p[k] - wall.lower[k], wall.upper[k] - p[k]});
        return least;
      });
    case WallKind::cylinder_inside: {
      const Vec3 axis = normalised(wall.axis_end - wall.axis_start);
      const double height = length(wall.axis_end - wall.axis_start);
      return all([&](const Vec3& p) {
        const double z = dot(axis, p - wall.axis_start);
        const double r = length(p - wall.axis_start - z * axis);
        return std::min({z, height - z, wall.radius - r});
      });
    }
    case WallKind::sphere_inside:
      return all([&](const Vec3& p) { return wall.radius - length(p - wall.point); });
    case WallKind::mesh: {
      if (gap_between(*mesh, body, gap + (kJustAbove - 1) * std::abs(gap), scratch) < gap) return false;
      return !(is_solid && is_inside(mesh->shape->shape.mesh, local_point(*mesh, vertices.front())));
    }
  }
  return false;
}

void PlacedGrid::insert(std::int32_t index, const Vec3& centre, double radius) {
  const int level = std::ilogb(2 * radius) + 1;  // cell size 2^level > 2 radius
  const double size = std::ldexp(1.0, level);
  cells_[{level, cell(centre.x, size), cell(centre.y, size), cell(centre.z, size)}].push_back({centre, radius, index});
  ++level_count_[level];
}

}  // namespace scree
