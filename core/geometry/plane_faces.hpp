// Polygons with holes in one plane, from their edges, and triangles made of them.
#pragma once

#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "core/geometry/triangle_mesh.hpp"

namespace scree {

/// A polygon with holes.
struct PlaneFace {
  std::vector<std::vector<std::int32_t>> loops;  ///< vertices; the rim, then holes; seen against the normal, the rim is counter-clockwise
  std::vector<Triangle> triangles;               ///< the same area, turned as the rim
};

/// Joins directed edges to loops, gives each hole to the rim around it, and fills every face.
///
/// in   edges    in no order; the figure lies on their left, seen against the normal     in   normal   unit
/// Fails: nothing, where a vertex has several edges that leave it, and where rounding has laid two loops across each other.
/// Limits: a face without holes whose rim crosses itself by rounding is cut as a fan, which covers a convex one.
/// Cost: O(n^2) in the vertices of a face.
std::optional<std::vector<PlaneFace>> plane_faces(const std::vector<std::pair<std::int32_t, std::int32_t>>& edges,
                                                  const std::vector<Vec3>& vertices, const Vec3& normal);

/// Fills a polygon, convex or not; `ring` may run along a cut to a hole and back. Adds its triangles; false where it had to be cut as a
/// fan.
bool fill_ring(const std::vector<std::int32_t>& ring, const std::vector<Vec3>& vertices, std::vector<Triangle>& triangles);

}  // namespace scree
