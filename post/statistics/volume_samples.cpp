#include "post/statistics/volume_samples.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace scree {

namespace {

/// Heights at which the vertical line through (x, y) crosses the surface, ascending.
std::vector<double> crossings(const Shape& shape, double x, double y) {
  std::vector<double> heights;
  if (shape.kind == ShapeKind::sphere) {
    const double square = shape.sphere_radius * shape.sphere_radius - x * x - y * y;
    if (square > 0) heights = {-std::sqrt(square), std::sqrt(square)};
    return heights;
  }
  for (std::int32_t t = 0; t < shape.mesh.triangle_count(); ++t) {
    const Vec3 &a = shape.mesh.corner(t, 0), &b = shape.mesh.corner(t, 1), &c = shape.mesh.corner(t, 2);
    const auto side = [&](const Vec3& p, const Vec3& q) { return (q.x - p.x) * (y - p.y) - (q.y - p.y) * (x - p.x); };
    const double u = side(b, c), v = side(c, a), w = side(a, b);
    if (!((u > 0 && v > 0 && w > 0) || (u < 0 && v < 0 && w < 0))) continue;
    heights.push_back((u * a.z + v * b.z + w * c.z) / (u + v + w));
  }
  std::sort(heights.begin(), heights.end());
  return heights;
}

}  // namespace

std::vector<Vec3> volume_samples(const Shape& shape, std::size_t count) {
  const double volume = shape.mass.volume;
  if (count <= 1 || !(volume > 0)) return {Vec3{}};
  const double spacing = std::cbrt(volume / static_cast<double>(count));
  Box3 box = bounding_box(shape.mesh);
  if (shape.kind == ShapeKind::sphere) {
    const double r = shape.sphere_radius;
    box = {};
    box.add(Vec3{-r, -r, -r});
    box.add(Vec3{r, r, r});
  }
  std::vector<Vec3> points;
  // offsets that no mesh has its edges at
  double phase = 0.5;
  for (double x = box.lower.x + 0.4871 * spacing; x < box.upper.x; x += spacing) {
    for (double y = box.lower.y + 0.5153 * spacing; y < box.upper.y; y += spacing) {
      phase = std::fmod(phase + std::numbers::phi, 1.0);
      const std::vector<double> heights = crossings(shape, x, y);
      for (std::size_t k = 0; k + 1 < heights.size(); k += 2) {
        for (double z = std::ceil(heights[k] / spacing - phase) + phase; z * spacing < heights[k + 1]; z += 1)
          points.push_back({x, y, z * spacing});
      }
    }
  }
  if (points.empty()) points.push_back({});
  // their middle is the centre of mass
  Vec3 middle;
  for (const Vec3& p : points) middle += (1.0 / static_cast<double>(points.size())) * p;
  for (Vec3& p : points) p -= middle;
  return points;
}

}  // namespace scree
