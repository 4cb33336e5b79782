#include "post/statistics/volume_samples.hpp"

#include <algorithm>
#include <cmath>

namespace scree {

namespace {

/// Columns in proportion to points, and the least number of them: a wall with a thousandth of the outline's area is still hit.
constexpr std::size_t kColumnsPerPoint = 8, kMinColumns = 4096;

/// Steps of an even sequence in the plane and on the line, each from the root of x^{d+1} = x + 1 (M. Roberts 2018, "R2"):
/// their multiples, less the whole part, leave no gap and have no direction of their own.
constexpr double kStepX = 0.7548776662466927, kStepY = 0.5698402909980532, kStepZ = 0.6180339887498949;

double fraction(double x) { return x - std::floor(x); }

/// A vertical line through a shape and the heights at which it crosses the surface, ascending.
struct Chord {
  double x = 0, y = 0;
  std::vector<double> heights;
  double length() const {
    double sum = 0;
    for (std::size_t k = 0; k + 1 < heights.size(); k += 2) sum += heights[k + 1] - heights[k];
    return sum;
  }
  /// Height of the point with this length of the column's solid below it.
  double height_of(double solid_below) const {
    for (std::size_t k = 0; k + 1 < heights.size(); k += 2) {
      const double part = heights[k + 1] - heights[k];
      if (solid_below <= part || k + 3 >= heights.size()) return heights[k] + std::min(solid_below, part);
      solid_below -= part;
    }
    return 0;
  }
};

std::vector<Chord> chords_in(const Box3& box, std::size_t count) {
  std::vector<Chord> columns(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double n = static_cast<double>(i) + 0.5;
    columns[i].x = box.lower.x + fraction(n * kStepX) * (box.upper.x - box.lower.x);
    columns[i].y = box.lower.y + fraction(n * kStepY) * (box.upper.y - box.lower.y);
  }
  return columns;
}

void cross_sphere(double radius, std::vector<Chord>& columns) {
  for (Chord& column : columns) {
    const double square = radius * radius - column.x * column.x - column.y * column.y;
    if (square > 0) column.heights = {-std::sqrt(square), std::sqrt(square)};
  }
}

void cross_mesh(const TriangleMesh& mesh, std::vector<Chord>& columns) {
  std::vector<std::size_t> by_x(columns.size());
  for (std::size_t i = 0; i < by_x.size(); ++i) by_x[i] = i;
  std::sort(by_x.begin(), by_x.end(), [&](std::size_t i, std::size_t j) { return columns[i].x < columns[j].x; });
  for (std::int32_t t = 0; t < mesh.triangle_count(); ++t) {
    const Vec3 &a = mesh.corner(t, 0), &b = mesh.corner(t, 1), &c = mesh.corner(t, 2);
    const double left = std::min({a.x, b.x, c.x}), right = std::max({a.x, b.x, c.x});
    auto next = std::lower_bound(by_x.begin(), by_x.end(), left, [&](std::size_t i, double x) { return columns[i].x < x; });
    for (; next != by_x.end() && columns[*next].x <= right; ++next) {
      Chord& column = columns[*next];
      const auto side = [&](const Vec3& p, const Vec3& q) { return (q.x - p.x) * (column.y - p.y) - (q.y - p.y) * (column.x - p.x); };
      const double u = side(b, c), v = side(c, a), w = side(a, b);
      if (!((u > 0 && v > 0 && w > 0) || (u < 0 && v < 0 && w < 0))) continue;
      column.heights.push_back((u * a.z + v * b.z + w * c.z) / (u + v + w));
    }
  }
  for (Chord& column : columns) std::sort(column.heights.begin(), column.heights.end());
}

}  // namespace

std::vector<Vec3> volume_samples(const Shape& shape, std::size_t count) {
  if (count <= 1 || !(shape.mass.volume > 0)) return {Vec3{}};
  const bool ball = shape.kind == ShapeKind::sphere;
  Box3 box = bounding_box(shape.mesh);
  if (ball) {
    const double r = shape.sphere_radius;
    box = {};
    box.add(Vec3{-r, -r, -r});
    box.add(Vec3{r, r, r});
  }
  std::vector<Chord> columns = chords_in(box, std::max(kColumnsPerPoint * count, kMinColumns));
  ball ? cross_sphere(shape.sphere_radius, columns) : cross_mesh(shape.mesh, columns);
  double total = 0;
  for (const Chord& column : columns) total += column.length();
  if (!(total > 0)) return {Vec3{}};
  const double share = total / static_cast<double>(count);
  std::vector<Vec3> points;
  points.reserve(count);
  double passed = 0;  // length of the columns before this one
  for (const Chord& column : columns) {
    const double length = column.length();
    passed += length;
    for (; points.size() < count && (static_cast<double>(points.size()) + 0.5) * share <= passed;)
      points.push_back({column.x, column.y, column.height_of(length * fraction((static_cast<double>(points.size()) + 0.5) * kStepZ))});
  }
  // their middle is the centre of mass
  Vec3 middle;
  for (const Vec3& p : points) middle += (1.0 / static_cast<double>(points.size())) * p;
  for (Vec3& p : points) p -= middle;
  return points;
}

}  // namespace scree
