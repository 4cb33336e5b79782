// The convex hull of points.
#pragma once

#include <vector>

#include "core/geometry/triangle_mesh.hpp"

namespace scree {

/// A point counts as outside of a face when it is further than this part of the extent above it; nearer ones, as in flat
/// faces of many vertices, are left out of the hull.
inline constexpr double kHullTolerance = 1e-10;

/// Closed outward mesh of the hull; empty when the points lie in one plane.
///
/// How: the furthest point outside of a face replaces the faces that see it by a cone over their horizon.
/// Source: C. Barber, D. Dobkin, H. Huhdanpaa, The quickhull algorithm for convex hulls, ACM TOMS 22 (1996) 469.
/// Fails: never.   Cost: O(n log n) for most inputs.
TriangleMesh convex_hull(const std::vector<Vec3>& points);

}  // namespace scree
