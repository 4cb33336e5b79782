// The convex hull of points.
#pragma once

#include <vector>

#include "core/geometry/triangle_mesh.hpp"

namespace scree {

/// Closed outward mesh of the hull; empty when the points lie in one plane. Its vertices come in the order of the points. A point that is
/// outside of it by rounding alone, as in flat faces of many vertices, is left out.
///
/// How: qhull's library, faces that rounding makes concave merged, then triangulated (option Qt); see docs/develop/decisions/014.
/// Source: C. Barber, D. Dobkin, H. Huhdanpaa, The quickhull algorithm for convex hulls, ACM TOMS 22 (1996) 469.
/// Fails: throws InputError with qhull's words when rounding is too large for these points.   Cost: O(n log n) for most inputs.
TriangleMesh convex_hull(const std::vector<Vec3>& points);

}  // namespace scree
