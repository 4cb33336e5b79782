// The sieve that a shape passes: what connects the openings of a sieve analysis with the diameters of a case.
#pragma once

#include <vector>

#include "core/geometry/vec3.hpp"

namespace scree {

/// Side of the smallest square opening through which a shape passes straight, however it is turned [m].
///
/// It is the least over all pairs of directions u, v at right angles of the larger of the widths of the shape along u and v. A shape that
/// must turn while it passes (a bent one) may pass a smaller one. Closed forms: ball 2 R; ellipsoid a >= b >= c: sqrt(2 (b^2 + c^2)), since
/// the squares of both widths add up to at least 4 (b^2 + c^2); regular tetrahedron of edge 1: 1/sqrt(2) (J. Itoh, Y. Tanoue, T.
/// Zamfirescu, Tetrahedra passing through a circular or square hole, Rend. Circ. Mat. Palermo Suppl. 77 (2006) 349).
///
/// How: 1800 pairs spread over all orientations, then a compass search over rotations from the best of them, down to 1e-10 rad.
/// in   corners   those of the convex hull, at least one
/// out  relative error below 1e-6 in the tests; never below the true value by more than rounding
/// Cost: some 10^4 passes over the corners.
double sieve_opening(const std::vector<Vec3>& corners);

}  // namespace scree
