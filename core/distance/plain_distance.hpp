// Distances of triangles in plain double precision. The kernels of triangle_distance.hpp are faster; their last digits depend on the
// instruction set, since some fuse products and sums. What enters the state of a run is computed with these.
#pragma once

#include <algorithm>
#include <cmath>

#include "core/geometry/nearest_on_triangle.hpp"
#include "core/geometry/vec3.hpp"

namespace scree {

/// Nearest points of two bodies' parts and the square of their distance [m^2].
struct PlainNearest {
  Vec3 a, b;
  double squared = 0;
};

/// Nearest points of the segments p0 p1 and q0 q1. Segments that are nearly parallel may be given points at one of their ends.
/// Source: Ericson, Real-Time Collision Detection (2005), section 5.1.9.   Cost: O(1), branches.
inline PlainNearest nearest_of_segments(const Vec3& p0, const Vec3& p1, const Vec3& q0, const Vec3& q1) {
  const Vec3 u = p1 - p0, v = q1 - q0, w = p0 - q0;
  const double a = squared_length(u), e = squared_length(v), f = dot(v, w), c = dot(u, w), b = dot(u, v);
  const double denominator = a * e - b * b;
  double s = denominator > 0 ? std::clamp((b * f - c * e) / denominator, 0.0, 1.0) : 0.0;
  double t = e > 0 ? (b * s + f) / e : 0.0;
  if (t < 0 || t > 1) {
    t = std::clamp(t, 0.0, 1.0);
    s = a > 0 ? std::clamp((b * t - c) / a, 0.0, 1.0) : 0.0;
  }
  return {p0 + s * u, q0 + t * v, squared_length(w + s * u - t * v)};
}

/// Nearest points of two triangles that have no common point: the nearest of corners and triangles and of edges and edges; the first
/// of equal ones.   Cost: 6 of the one, 9 of the other.
inline PlainNearest nearest_of_triangles(const Vec3 a[3], const Vec3 b[3]) {
  PlainNearest least{a[0], b[0], squared_length(a[0] - b[0])};
  const auto take = [&](const PlainNearest& other) {
    if (other.squared < least.squared) least = other;
  };
  for (int i = 0; i < 3; ++i) {
    const Vec3 on_b = nearest_on_triangle(a[i], b[0], b[1], b[2]).point, on_a = nearest_on_triangle(b[i], a[0], a[1], a[2]).point;
    take({a[i], on_b, squared_length(a[i] - on_b)});
    take({on_a, b[i], squared_length(b[i] - on_a)});
    for (int j = 0; j < 3; ++j) take(nearest_of_segments(a[i], a[(i + 1) % 3], b[j], b[(j + 1) % 3]));
  }
  return least;
}

/// Distance of two triangles that have no common point [m].
inline double plain_triangle_distance(const Vec3 a[3], const Vec3 b[3]) { return std::sqrt(nearest_of_triangles(a, b).squared); }

}  // namespace scree
