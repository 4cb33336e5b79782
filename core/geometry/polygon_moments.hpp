// What a plane figure resists bending and torsion with: area, centroid, principal axes and second moments.
#pragma once

#include <span>
#include <vector>

#include "core/geometry/vec3.hpp"

namespace scree {

/// Two unit vectors across a normal: axis, other and normal are right-handed.
struct PlaneAxes {
  Vec3 origin, u, v;
  PlaneAxes(const Vec3& normal, const Vec3& origin);
};

struct PolygonMoments {
  double area = 0;        ///< [m^2], > 0 when the rim is counter-clockwise seen against the normal
  Vec3 centroid;          ///< [m]
  Vec3 axis;              ///< unit, in the plane: principal axis of the smaller second moment
  double moment_1 = 0;    ///< [m^4] integral of the squared distance from `axis` through the centroid
  double moment_2 = 0;    ///< [m^4] from normal x axis
  double rim_radius = 0;  ///< [m] from the centroid to the farthest point of the rim
};

/// Of a plane polygon with holes, exact.
///
/// in   loops    corners of the rim, then of holes, which run the other way round
/// in   normal   unit
/// Source: C. Steger, On the calculation of moments of polygons, Technical report FGBV-96-05, TU Muenchen, 1996.
PolygonMoments polygon_moments(std::span<const std::vector<Vec3>> loops, const Vec3& normal);

}  // namespace scree
