// Distances of triangles in plain double precision. The kernels of triangle_distance.hpp are faster; their last digits depend on the
// instruction set, since some fuse products and sums. What enters the state of a run is computed with these.
#pragma once

#include <algorithm>
#include <cmath>

#include "core/geometry/nearest_on_triangle.hpp"
#include "core/geometry/vec3.hpp"

namespace scree {

/// Squared distance of the segments p0 p1 and q0 q1 [m^2]. Segments that are nearly parallel may be given the distance at one of
/// their ends.
/// Source: Ericson, Real-Time Collision Detection (2005), section 5.1.9.   Cost: O(1), branches.
inline double squared_segment_distance(const Vec3& p0, const Vec3& p1, const Vec3& q0, const Vec3& q1) {
  const Vec3 u = p1 - p0, v = q1 - q0, w = p0 - q0;
  const double a = squared_length(u), e = squared_length(v), f = dot(v, w), c = dot(u, w), b = dot(u, v);
  const double denominator = a * e - b * b;
  double s = denominator > 0 ? std::clamp((b * f - c * e) / denominator, 0.0, 1.0) : 0.0;
  double t = e > 0 ? (b * s + f) / e : 0.0;
  if (t < 0 || t > 1) {
    t = std::clamp(t, 0.0, 1.0);
    s = a > 0 ? std::clamp((b * t - c) / a, 0.0, 1.0) : 0.0;
  }
  return squared_length(w + s * u - t * v);
}

/// Distance of two triangles that have no common point [m]: the least of the distances of corners from triangles and of edges from
/// edges.   Cost: 6 of the one, 9 of the other.
inline double plain_triangle_distance(const Vec3 a[3], const Vec3 b[3]) {
  double least = squared_length(a[0] - b[0]);
  for (int i = 0; i < 3; ++i) {
    least = std::min(least, squared_length(a[i] - nearest_on_triangle(a[i], b[0], b[1], b[2]).point));
    least = std::min(least, squared_length(b[i] - nearest_on_triangle(b[i], a[0], a[1], a[2]).point));
    for (int j = 0; j < 3; ++j) least = std::min(least, squared_segment_distance(a[i], a[(i + 1) % 3], b[j], b[(j + 1) % 3]));
  }
  return std::sqrt(least);
}

}  // namespace scree
