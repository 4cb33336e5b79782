// On which side of a plane a vertex of a cut mesh lies, exactly.
//
// A vertex of a cut mesh is named by what meets in it (three planes, or a triangle and planes), and its sign is that of a polynomial in
// the coordinates of mesh vertices and the coefficients of planes. Both are doubles, so the sign has an answer without rounding. Cells
// that decide on the same vertex therefore never disagree, which is what makes the pieces of a cut fit without gap or overlap.
#pragma once

#include <array>
#include <stdexcept>

#include "core/geometry/vec3.hpp"

namespace scree {

/// Half space: value(x) = normal . x + offset, positive inside. Coefficients are exact: see Generators in voronoi_cells.hpp.
struct CutPlane {
  Vec3 normal;
  double offset = 0;
  CutPlane operator-() const { return {-normal, -offset}; }
};

/// Four planes through one point, a plane through a mesh vertex, and the like: no side can be chosen that all cells agree on. The caller
/// moves the generators by a little and begins again.
struct DegenerateCut : std::runtime_error {
  DegenerateCut() : std::runtime_error("a plane of the cut passes through a vertex") {}
};

/// Signs, -1 or 1, of `plane` at points. Coordinates below 1 in size.
///
/// How: in doubles with a bound of their rounding; where that leaves the sign open, in rational numbers.
/// Source: for filtered exact signs, J. Shewchuk, Adaptive precision floating-point arithmetic and fast robust geometric predicates,
/// Discrete and Computational Geometry 18 (1997) 305.
/// Fails: DegenerateCut where the value is zero.   Cost: under a microsecond; some 50 where the filter leaves it open.
int sign_at(const CutPlane& plane, const Vec3& point);
/// At the point in which the line through a and b meets plane p.
int sign_at_edge(const CutPlane& plane, const Vec3& a, const Vec3& b, const CutPlane& p);
/// At the point in which planes p and q meet that of the triangle.
int sign_at_triangle(const CutPlane& plane, const std::array<Vec3, 3>& triangle, const CutPlane& p, const CutPlane& q);
/// At the point in which three planes meet.
int sign_at_planes(const CutPlane& plane, const CutPlane& p, const CutPlane& q, const CutPlane& r);

/// Sign of (normal of p x normal of q) . normal of r.
int sign_of_turn(const CutPlane& p, const CutPlane& q, const CutPlane& r);
/// Sign of (normal of p x normal of q) . normal of the triangle: 1 where the line of both planes leaves through it.
int sign_of_crossing(const std::array<Vec3, 3>& triangle, const CutPlane& p, const CutPlane& q);
/// Whether the line of p and q, along (normal of p x normal of q), meets the first triangle's plane before the second's.
bool meets_before(const std::array<Vec3, 3>& first, const std::array<Vec3, 3>& second, const CutPlane& p, const CutPlane& q);

/// The same points, correct to the last digits: computed with 113 bits, so that planes at small angles cost no digits of a double.
Vec3 edge_point(const Vec3& a, const Vec3& b, const CutPlane& p);
Vec3 triangle_point(const std::array<Vec3, 3>& triangle, const CutPlane& p, const CutPlane& q);
Vec3 planes_point(const CutPlane& p, const CutPlane& q, const CutPlane& r);

}  // namespace scree
