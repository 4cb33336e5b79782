#include "post/statistics/volume_samples.hpp"

#include <algorithm>
#include <cmath>
#include <random>

namespace scree {

namespace {

/// More cells are not looked at for one point that is asked for: shapes that fill less of their box get fewer points.
constexpr double kMostTried = 500;

/// One point in each cube of a grid over the box, anywhere in its cube.
std::vector<Vec3> scattered_in(const Box3& box, double size) {
  std::mt19937_64 generator(1);  // the same points every time
  const auto step = [&]() { return size * (static_cast<double>(generator() >> 11) * 0x1p-53); };
  std::vector<Vec3> points;
  for (double x = box.lower.x; x < box.upper.x; x += size)
    for (double y = box.lower.y; y < box.upper.y; y += size)
      for (double z = box.lower.z; z < box.upper.z; z += size) {
        const double a = step(), b = step(), c = step();
        points.push_back({x + a, y + b, z + c});
      }
  return points;
}

/// Keeps the points with an odd number of crossings of the surface below them.
void keep_inside(const TriangleMesh& mesh, std::vector<Vec3>& points) {
  std::sort(points.begin(), points.end(), [](const Vec3& p, const Vec3& q) { return p.x < q.x; });
  std::vector<bool> inside(points.size(), false);
  for (std::int32_t t = 0; t < mesh.triangle_count(); ++t) {
    const Vec3 &a = mesh.corner(t, 0), &b = mesh.corner(t, 1), &c = mesh.corner(t, 2);
    const double left = std::min({a.x, b.x, c.x}), right = std::max({a.x, b.x, c.x});
    const auto begin = std::lower_bound(points.begin(), points.end(), left, [](const Vec3& p, double x) { return p.x < x; });
    for (auto i = static_cast<std::size_t>(begin - points.begin()); i < points.size() && points[i].x <= right; ++i) {
      const Vec3& at = points[i];
      const auto side = [&](const Vec3& p, const Vec3& q) { return (q.x - p.x) * (at.y - p.y) - (q.y - p.y) * (at.x - p.x); };
      const double u = side(b, c), v = side(c, a), w = side(a, b);
      if (!((u > 0 && v > 0 && w > 0) || (u < 0 && v < 0 && w < 0))) continue;
      if ((u * a.z + v * b.z + w * c.z) / (u + v + w) < at.z) inside[i] = !inside[i];
    }
  }
  std::size_t kept = 0;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (inside[i]) points[kept++] = points[i];
  points.resize(kept);
}

}  // namespace

std::vector<Vec3> volume_samples(const Shape& shape, std::size_t count) {
  if (count <= 1 || !(shape.mass.volume > 0)) return {Vec3{}};
  const bool ball = shape.kind == ShapeKind::sphere;
  Box3 box = bounding_box(shape.mesh);
  if (ball) {
    const double r = shape.sphere_radius;
    box = {{-r, -r, -r}, {r, r, r}};
  }
  const double number = static_cast<double>(count), room = box.extent().x * box.extent().y * box.extent().z;
  double size = std::cbrt(std::max(shape.mass.volume / number, room / (kMostTried * number)));
  // a flat box is one cube thick however thin it is
  const auto cubes = [&] {
    double product = 1;
    for (int k = 0; k < 3; ++k) product *= std::ceil(box.extent()[k] / size);
    return product;
  };
  while (cubes() > 2 * kMostTried * number) size *= 1.25;
  std::vector<Vec3> points = scattered_in(box, size);
  if (ball)
    std::erase_if(points, [&](const Vec3& p) { return !(dot(p, p) < shape.sphere_radius * shape.sphere_radius); });
  else
    keep_inside(shape.mesh, points);
  if (points.empty()) return {Vec3{}};
  // their middle is the centre of mass
  Vec3 middle;
  for (const Vec3& p : points) middle += (1.0 / static_cast<double>(points.size())) * p;
  for (Vec3& p : points) p -= middle;
  return points;
}

}  // namespace scree
