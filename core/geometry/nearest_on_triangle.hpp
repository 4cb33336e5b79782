#pragma once

#include "core/geometry/vec3.hpp"

namespace scree {

/// Nearest point of a triangle, and where it lies: -1 inside, 0-2 on edge k -> k+1, 3-5 at vertex k - 3.
struct NearestOnTriangle {
  Vec3 point;
  int place;
};

/// Source: Ericson, Real-Time Collision Detection (2005), section 5.1.5.   Cost: O(1), branches.
inline NearestOnTriangle nearest_on_triangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a, ap = p - a;
  const double d1 = dot(ab, ap), d2 = dot(ac, ap);
  if (d1 <= 0 && d2 <= 0) return {a, 3};
  const Vec3 bp = p - b;
  const double d3 = dot(ab, bp), d4 = dot(ac, bp);
  if (d3 >= 0 && d4 <= d3) return {b, 4};
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return {a + (d1 / (d1 - d3)) * ab, 0};
  const Vec3 cp = p - c;
  const double d5 = dot(ab, cp), d6 = dot(ac, cp);
  if (d6 >= 0 && d5 <= d6) return {c, 5};
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return {a + (d2 / (d2 - d6)) * ac, 2};
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) return {b + ((d4 - d3) / ((d4 - d3) + (d5 - d6))) * (c - b), 1};
  const double scale = 1 / (va + vb + vc);
  return {a + (vb * scale) * ab + (vc * scale) * ac, -1};
}

}  // namespace scree
