#include "mesher/make/sections.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/numbers.hpp"

namespace scree {

namespace {

std::int32_t add(CrossSection& section, double r, double angle, double x = 0, double y = 0) {
  section.points.push_back({x + r * std::cos(angle), y + r * std::sin(angle)});
  return static_cast<std::int32_t>(section.points.size()) - 1;
}

/// Indices of `count` points on a circle about the axis, counter-clockwise from the x axis.
std::vector<std::int32_t> add_circle(CrossSection& section, double r, int count, double x = 0, double y = 0, double from = 0) {
  std::vector<std::int32_t> circle;
  for (int i = 0; i < count; ++i) circle.push_back(add(section, r, from + 2 * kPi * i / count, x, y));
  return circle;
}

/// Triangles between a border and a hole, both counter-clockwise and both seen whole from `centre`: points are met in the order of their
/// angles, and each makes a triangle with the last one of either. Such a triangle lies outside a convex hole.
void join(CrossSection& section, const std::vector<std::int32_t>& border, const std::vector<std::int32_t>& hole,
          const std::array<double, 2>& centre) {
  const auto angle = [&](std::int32_t i) {
    const auto& p = section.points[static_cast<std::size_t>(i)];
    return std::atan2(p[1] - centre[1], p[0] - centre[0]);
  };
  struct Point {
    double angle;
    bool of_hole;
    std::int32_t index;
  };
  std::vector<Point> around;
  for (const std::int32_t i : border) around.push_back({angle(i), false, i});
  for (const std::int32_t i : hole) around.push_back({angle(i), true, i});
  std::stable_sort(around.begin(), around.end(), [](const Point& a, const Point& b) { return a.angle < b.angle; });
  std::int32_t last_of_border = -1, last_of_hole = -1;
  for (const Point& p : around) (p.of_hole ? last_of_hole : last_of_border) = p.index;
  for (const Point& p : around) {
    section.triangles.push_back({last_of_border, p.index, last_of_hole});
    (p.of_hole ? last_of_hole : last_of_border) = p.index;
  }
}

std::vector<std::int32_t> reversed(std::vector<std::int32_t> loop) {
  std::reverse(loop.begin(), loop.end());
  return loop;
}

/// Of a lobe about the x axis: the angle, seen from the middle of its circle, at which its border meets that of the next. The two meet at
/// the angle pi / count, seen from the axis.
double end_of_lobe(int count, double radius, double spread) {
  const double half = kPi / count, s = spread * std::sin(half);
  const double reach = spread * std::cos(half) + std::sqrt(radius * radius - s * s);
  return std::atan2(reach * std::sin(half), reach * std::cos(half) - spread);
}

}  // namespace

double arc_of_lobe(int count, double radius, double spread) { return 2 * radius * end_of_lobe(count, radius, spread); }

CrossSection lobes(int count, double radius, double spread, int steps) {
  CrossSection section;
  const double half = kPi / count, end = end_of_lobe(count, radius, spread);
  std::vector<std::int32_t> border;
  for (int lobe = 0; lobe < count; ++lobe) {
    const double middle = 2 * half * lobe;
    for (int i = 0; i < steps; ++i) {
      const double a = end * (2.0 * i / steps - 1);
      border.push_back(add(section, radius, middle + a, spread * std::cos(middle), spread * std::sin(middle)));
    }
  }
  const std::int32_t axis = add(section, 0, 0);
  for (std::size_t i = 0; i < border.size(); ++i) section.triangles.push_back({axis, border[i], border[(i + 1) % border.size()]});
  section.loops = {border};
  return section;
}

double area_of_lobes(int count, double radius, double spread) {
  const double t = kPi / count, s = spread * std::sin(t), rr = radius * radius;
  return count * (0.5 * spread * spread * std::sin(2 * t) + rr * t + s * std::sqrt(rr - s * s) + rr * std::asin(s / radius));
}

const char* fault_of(const Drilled& d) {
  if (!(d.inner < d.radius)) return "the hole in the middle reaches the rim";
  if (d.holes == 0) return "";
  if (!(d.circle + d.hole_radius < d.radius)) return "the holes reach the rim";
  if (!(d.circle - d.hole_radius > d.inner)) return d.inner > 0 ? "the holes reach the one in the middle" : "the holes meet in the middle";
  if (!(d.circle * std::sin(kPi / d.holes) > d.hole_radius)) return "the holes meet each other";
  // of the part around a hole, all of the inner border is seen from the middle of the hole
  if (d.inner > 0 && !(d.inner < d.circle * std::cos(kPi / d.holes))) return "the hole in the middle is too wide beside the others";
  return "";
}

CrossSection drilled(const Drilled& disc, int sectors, int hole_sectors) {
  CrossSection section;
  const std::vector<std::int32_t> rim = add_circle(section, disc.radius, sectors);
  std::vector<std::int32_t> middle;
  if (disc.inner > 0)
    middle = add_circle(section, disc.inner, sectors);
  else
    middle = {add(section, 0, 0)};
  section.loops.push_back(rim);
  if (disc.inner > 0) section.loops.push_back(reversed(middle));
  const auto of = [](const std::vector<std::int32_t>& circle, int i) { return circle[static_cast<std::size_t>(i) % circle.size()]; };
  if (disc.holes == 0) {
    for (int i = 0; i < sectors; ++i) {
      section.triangles.push_back({of(rim, i), of(rim, i + 1), of(middle, i)});
      if (disc.inner > 0) section.triangles.push_back({of(rim, i + 1), of(middle, i + 1), of(middle, i)});
    }
    return section;
  }
  const int steps = sectors / disc.holes;
  for (int h = 0; h < disc.holes; ++h) {
    const double direction = 2 * kPi * (h + 0.5) / disc.holes, x = disc.circle * std::cos(direction), y = disc.circle * std::sin(direction);
    const std::vector<std::int32_t> hole = add_circle(section, disc.hole_radius, hole_sectors, x, y, direction);
    std::vector<std::int32_t> border;
    for (int i = 0; i <= steps; ++i) border.push_back(of(rim, h * steps + i));
    if (disc.inner > 0) {
      for (int i = steps; i >= 0; --i) border.push_back(of(middle, h * steps + i));
    } else {
      border.push_back(middle.front());
    }
    join(section, border, hole, {x, y});
    section.loops.push_back(reversed(hole));
  }
  return section;
}

}  // namespace scree
