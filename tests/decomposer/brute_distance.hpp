// The distance between triangle meshes by the textbook and by brute force: nothing of core/distance is used.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/geometry/triangle_mesh.hpp"

namespace scree::test {

struct WorldTriangle {
  Vec3 p[3];
};

inline double segment_distance(const Vec3& p, const Vec3& q, const Vec3& r, const Vec3& s) {
  // alternating projection onto two segments converges to the minimum of a convex function; start at all ends
  const auto project = [](const Vec3& a, const Vec3& b, const Vec3& x) {
    const double t = std::clamp(dot(b - a, x - a) / squared_length(b - a), 0.0, 1.0);
    return a + t * (b - a);
  };
  double best = 1e300;
  for (const Vec3& end : {p, q}) best = std::min(best, length(end - project(r, s, end)));
  for (const Vec3& end : {r, s}) best = std::min(best, length(end - project(p, q, end)));
  // interior of both: the common perpendicular
  const Vec3 u = q - p, v = s - r, w = p - r;
  const double a = dot(u, u), b = dot(u, v), c = dot(v, v), d = dot(u, w), e = dot(v, w), det = a * c - b * b;
  if (det > 1e-14 * a * c) {
    const double x = (b * e - c * d) / det, y = (a * e - b * d) / det;
    if (x > 0 && x < 1 && y > 0 && y < 1) best = std::min(best, length(w + x * u - y * v));
  }
  return best;
}

/// Distance from a point to the inside of a triangle; 1e300 when the foot of the perpendicular lies outside.
inline double face_distance(const Vec3& x, const WorldTriangle& t) {
  const Vec3 n = cross(t.p[1] - t.p[0], t.p[2] - t.p[0]);
  for (int k = 0; k < 3; ++k) {
    if (dot(cross(n, t.p[(k + 1) % 3] - t.p[k]), x - t.p[k]) < 0) return 1e300;
  }
  return std::abs(dot(n, x - t.p[0])) / length(n);
}

inline bool pierces(const Vec3& a, const Vec3& b, const WorldTriangle& t) {
  const Vec3 n = cross(t.p[1] - t.p[0], t.p[2] - t.p[0]);
  const double da = dot(n, a - t.p[0]), db = dot(n, b - t.p[0]);
  if ((da > 0) == (db > 0)) return false;
  const Vec3 x = a + (da / (da - db)) * (b - a);
  for (int k = 0; k < 3; ++k) {
    if (dot(cross(n, t.p[(k + 1) % 3] - t.p[k]), x - t.p[k]) < 0) return false;
  }
  return true;
}

inline double brute_triangle_distance(const WorldTriangle& a, const WorldTriangle& b) {
  double best = 1e300;
  for (int i = 0; i < 3; ++i) {
    if (pierces(a.p[i], a.p[(i + 1) % 3], b) || pierces(b.p[i], b.p[(i + 1) % 3], a)) return 0;
    best = std::min({best, face_distance(a.p[i], b), face_distance(b.p[i], a)});
    for (int j = 0; j < 3; ++j) best = std::min(best, segment_distance(a.p[i], a.p[(i + 1) % 3], b.p[j], b.p[(j + 1) % 3]));
  }
  return best;
}

inline double brute_mesh_distance(const std::vector<WorldTriangle>& a, const std::vector<WorldTriangle>& b) {
  double best = 1e300;
  for (const WorldTriangle& s : a) {
    for (const WorldTriangle& t : b) best = std::min(best, brute_triangle_distance(s, t));
  }
  return best;
}

/// Whether a ray from the point in a skew direction leaves the mesh an odd number of times.
inline bool ray_says_inside(const std::vector<WorldTriangle>& mesh, const Vec3& point) {
  const Vec3 far = point + 1e3 * Vec3{0.5773, 0.2111, 0.7887};
  int crossings = 0;
  for (const WorldTriangle& t : mesh) crossings += pierces(point, far, t) ? 1 : 0;
  return crossings % 2 == 1;
}

/// An L: two boxes in one mesh, concave, 20 triangles, 1 x 1 x 0.3.
inline TriangleMesh l_shape() {
  const double corner[6][2] = {{0, 0}, {1, 0}, {1, 0.4}, {0.4, 0.4}, {0.4, 1}, {0, 1}};
  TriangleMesh mesh;
  for (const double z : {0.0, 0.3}) {
    for (const auto& c : corner) mesh.vertices.push_back({c[0], c[1], z});
  }
  const std::int32_t cap[4][3] = {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 5}};
  for (const auto& t : cap) {
    mesh.triangles.push_back({t[0], t[2], t[1]});
    mesh.triangles.push_back({t[0] + 6, t[1] + 6, t[2] + 6});
  }
  for (std::int32_t k = 0; k < 6; ++k) {
    const std::int32_t n = (k + 1) % 6;
    mesh.triangles.push_back({k, n, n + 6});
    mesh.triangles.push_back({k, n + 6, k + 6});
  }
  return mesh;
}

}  // namespace scree::test
