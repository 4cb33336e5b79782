// How far two surfaces are from each other: Hausdorff distances with a bound that holds.
#pragma once

#include <cstdint>

#include "core/geometry/triangle_mesh.hpp"

namespace scree {

/// The largest distance from a point of one surface to the other surface lies between lower and upper.
struct Deviation {
  double lower = 0, upper = 0;  ///< [m]; lower is reached at `place`
  Vec3 place;
};

/// A search ends when upper is within this part of lower, or within kDeviationFloor of the extent.
inline constexpr double kDeviationTolerance = 0.01;
inline constexpr double kDeviationFloor = 1e-6;
/// Most distances that are computed beyond those of the vertices; then the bound is what it is by then: wide where two
/// surfaces nearly coincide and their triangles differ, since each piece across an edge must be cut small.
inline constexpr std::int64_t kDeviationWork = 200'000;

/// Largest distance from any point of `from` to the surface `to`.
///
/// How: exact distances at points; on a triangle they bound the rest, since the distance to one (convex) triangle is
/// largest at a corner and no distance grows faster than the way. Triangles that may hold the maximum are halved, the
/// most promising first, until the bounds meet.
/// Source: M. Tang, M. Lee, Y. Kim, Interactive Hausdorff distance computation, SIGGRAPH 2009, for the branch and bound.
/// in   from, to   finite vertices, at least one triangle each
/// Cost: V point queries and a few thousand more.
Deviation one_sided_deviation(const TriangleMesh& from, const TriangleMesh& to);

/// The symmetric distance: the larger of both directions.
struct HausdorffDistance {
  Deviation forth, back;  ///< a to b, b to a
  double lower() const { return forth.lower > back.lower ? forth.lower : back.lower; }
  double upper() const { return forth.upper > back.upper ? forth.upper : back.upper; }
};
HausdorffDistance hausdorff_distance(const TriangleMesh& a, const TriangleMesh& b);

}  // namespace scree
