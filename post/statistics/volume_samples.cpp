#include "post/statistics/volume_samples.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace scree {

namespace {

/// More points of the lattice are not looked at for one that is asked for: shapes that fill less of their box get fewer points.
constexpr double kMostTried = 500;

/// The roots of x^3 - x^2 - 2 x + 1: 2 cos(pi / 7), 2 cos(3 pi / 7), 2 cos(5 pi / 7).
constexpr std::array<double, 3> kRoots = {1.8019377358048383, 0.44504186791262873, -1.2469796037174672};
constexpr double kCell = 7;  ///< volume of a cell of the lattice: the root of the polynomial's discriminant

/// Points of the lattice of Frolov (1976): columns 1, r, r^2 for the three roots r. Flat cells of any thickness along the axes
/// have their share of the points, since no product of the coordinates of two points' difference is below 1.
std::vector<Vec3> lattice_in(const Box3& box, double size) {
  const auto power = [&](int k) { return size * Vec3{std::pow(kRoots[0], k), std::pow(kRoots[1], k), std::pow(kRoots[2], k)}; };
  const Vec3 first = power(0), second = power(1), third = power(2);
  const Vec3 offset = 0.5 * (box.lower + box.upper) + size * Vec3{0.4871, 0.1357, 0.3253};  // no symmetry of the shape
  const Box3 room{box.lower - offset, box.upper - offset};
  const double volume = dot(first, cross(second, third));
  /// Range of an integer over the box: its dual vector at the corners.
  const auto range = [&](const Vec3& dual) {
    double low = 0, high = 0;
    for (int k = 0; k < 3; ++k) {
      low += std::min(dual[k] * room.lower[k], dual[k] * room.upper[k]);
      high += std::max(dual[k] * room.lower[k], dual[k] * room.upper[k]);
    }
    return std::array<double, 2>{std::ceil(low), std::floor(high)};
  };
  const auto thirds = range((1 / volume) * cross(first, second)), seconds = range((1 / volume) * cross(third, first));
  std::vector<Vec3> points;
  for (double c = thirds[0]; c <= thirds[1]; ++c) {
    for (double b = seconds[0]; b <= seconds[1]; ++b) {
      const Vec3 line = b * second + c * third;
      double low = -1e308, high = 1e308;
      for (int k = 0; k < 3; ++k) {
        low = std::max(low, (room.lower[k] - line[k]) / size);
        high = std::min(high, (room.upper[k] - line[k]) / size);
      }
      for (double a = std::ceil(low); a <= high; ++a) points.push_back(offset + a * first + line);
    }
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
  const double share = std::max(shape.mass.volume / number, room / (kMostTried * number));
  std::vector<Vec3> points = lattice_in(box, std::cbrt(share / kCell));
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
