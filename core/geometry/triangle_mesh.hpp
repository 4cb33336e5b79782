#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/geometry/vec3.hpp"

namespace scree {

using Triangle = std::array<std::int32_t, 3>;

/// An indexed triangle mesh.
///
/// vertices   V x 3 [m]
/// triangles  T x 3 vertex indices from 0, counter-clockwise seen from outside
struct TriangleMesh {
  std::vector<Vec3> vertices;
  std::vector<Triangle> triangles;

  std::int32_t vertex_count() const { return static_cast<std::int32_t>(vertices.size()); }
  std::int32_t triangle_count() const { return static_cast<std::int32_t>(triangles.size()); }
  const Vec3& corner(std::int32_t triangle, int k) const {
    return vertices[static_cast<std::size_t>(triangles[static_cast<std::size_t>(triangle)][static_cast<std::size_t>(k)])];
  }
};

/// Axis-aligned bounding box; empty (lower > upper) until something is added.
struct Box3 {
  Vec3 lower{1e308, 1e308, 1e308}, upper{-1e308, -1e308, -1e308};
  void add(const Vec3& p) {
    lower = component_min(lower, p);
    upper = component_max(upper, p);
  }
  void add(const Box3& b) {
    lower = component_min(lower, b.lower);
    upper = component_max(upper, b.upper);
  }
  bool is_empty() const { return lower.x > upper.x; }
  Vec3 extent() const { return upper - lower; }
  Vec3 centre() const { return 0.5 * (lower + upper); }
};

/// Bounding box of all vertices, in the mesh's own axes.   Cost: O(V).
Box3 bounding_box(const TriangleMesh& mesh);

/// The longest of the three extents of that box.   Cost: O(V).
double longest_extent(const TriangleMesh& mesh);

/// Radius of the smallest sphere about the origin that holds all vertices [m].   Cost: O(V).
double bounding_radius(const TriangleMesh& mesh);

/// Surface area [m^2].   Cost: O(T).
double surface_area(const TriangleMesh& mesh);

/// Triangulated box with outward normals, centred on the origin: 8 vertices, 12 triangles.
TriangleMesh box_mesh(const Vec3& size);

}  // namespace scree
