#include "core/surface/face_outline.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/index.hpp"
#include "core/geometry/polygon_moments.hpp"

namespace scree {

namespace {

/// Height of the flattest triangle over its longest side: rounding turns its normal by 1e-7, far less than kFlatAngle.
constexpr double kMinHeight = 1e-9;
/// A vertex inside keeps its place where it is farther than this share of a side from it: triangles between them are no needles.
constexpr double kClearance = 1e-3;

struct Point {
  double x = 0, y = 0;
};
Point operator-(const Point& a, const Point& b) { return {a.x - b.x, a.y - b.y}; }
double dot(const Point& a, const Point& b) { return a.x * b.x + a.y * b.y; }
double cross(const Point& a, const Point& b) { return a.x * b.y - a.y * b.x; }
/// Twice the area of the triangle, positive to the left.
double turn(const Point& a, const Point& b, const Point& c) { return cross(b - a, c - a); }

bool meet(const Point& a, const Point& b, const Point& c, const Point& d) {
  const auto on_one_side = [](double s, double t) { return (s > 0 && t > 0) || (s < 0 && t < 0); };
  return std::max(a.x, b.x) >= std::min(c.x, d.x) && std::max(c.x, d.x) >= std::min(a.x, b.x) && std::max(a.y, b.y) >= std::min(c.y, d.y) &&
         std::max(c.y, d.y) >= std::min(a.y, b.y) && !on_one_side(turn(a, b, c), turn(a, b, d)) &&
         !on_one_side(turn(c, d, a), turn(c, d, b));
}

using Side = std::array<std::int32_t, 2>;

bool share_an_end(const Side& a, const Side& b) { return a[0] == b[0] || a[0] == b[1] || a[1] == b[0] || a[1] == b[1]; }

std::vector<Point> in_plane(const FaceOutline& outline, const std::vector<Vec3>& places) {
  const PlaneAxes axes(outline.normal, places.front());
  std::vector<Point> points;
  for (const Vec3& p : places) points.push_back({dot(axes.u, p - axes.origin), dot(axes.v, p - axes.origin)});
  return points;
}

/// What is left of a face between triangles that lie already.
class Front {
 public:
  Front(const std::vector<Point>& points, const std::vector<Side>& sides, const std::vector<std::int32_t>& inside)
      : points_(points), front_(sides), active_(inside), sides_at_(points.size(), 0) {
    for (const Side& side : sides)
      for (const std::int32_t v : side)
        if (sides_at_[at(v)]++ == 0) active_.push_back(v);
  }

  /// Returns whether nothing is left.
  bool fill(std::size_t most, std::vector<Triangle>& triangles) {
    while (!front_.empty() && triangles.size() < most) {
      const auto [a, b] = front_.back();
      const std::int32_t c = third_corner(a, b);
      if (c < 0) return false;
      front_.pop_back();
      triangles.push_back({a, b, c});
      lay(b, c);
      lay(c, a);
      --sides_at_[at(a)];
      --sides_at_[at(b)];
      std::erase_if(active_, [&](std::int32_t v) { return (v == a || v == b || v == c) && sides_at_[at(v)] == 0; });
    }
    return front_.empty();
  }

 private:
  /// A side of a new triangle: it closes the front, or becomes part of it.
  void lay(std::int32_t from, std::int32_t to) {
    const auto known = std::find(front_.begin(), front_.end(), Side{from, to});
    const int change = known == front_.end() ? 1 : -1;
    sides_at_[at(from)] += change;
    sides_at_[at(to)] += change;
    if (known == front_.end())
      front_.push_back({to, from});
    else
      front_.erase(known);
  }

  /// -1: none.
  std::int32_t third_corner(std::int32_t a, std::int32_t b) {
    const Point &pa = points_[at(a)], &pb = points_[at(b)];
    found_.clear();
    for (const std::int32_t c : active_) {
      const Point to_a = pa - points_[at(c)], to_b = pb - points_[at(c)];
      const double twice = cross(to_a, to_b), longest = std::max({dot(to_a, to_a), dot(to_b, to_b), dot(pb - pa, pb - pa)});
      if (twice > kMinHeight * longest) found_.push_back({dot(to_a, to_b) / twice, c});
    }
    // the widest angle has the least cotangent
    const auto is_later = [](const Seen& s, const Seen& t) {
      return s.cotangent != t.cotangent ? s.cotangent > t.cotangent : s.vertex > t.vertex;
    };
    std::make_heap(found_.begin(), found_.end(), is_later);
    while (!found_.empty()) {
      const std::int32_t c = found_.front().vertex;
      if (sees(a, c) && sees(b, c)) return c;
      std::pop_heap(found_.begin(), found_.end(), is_later);
      found_.pop_back();
    }
    return -1;
  }

  bool sees(std::int32_t from, std::int32_t to) const {
    return std::none_of(front_.begin(), front_.end(), [&](const Side& side) {
      return !share_an_end(side, {from, to}) && meet(points_[at(from)], points_[at(to)], points_[at(side[0])], points_[at(side[1])]);
    });
  }

  struct Seen {
    double cotangent;
    std::int32_t vertex;
  };
  const std::vector<Point>& points_;
  std::vector<Side> front_;           ///< what is left lies to the left
  std::vector<std::int32_t> active_;  ///< vertices of the front, and inside of what is left
  std::vector<int> sides_at_;         ///< of the front, at each vertex
  std::vector<Seen> found_;
};

/// Whether a point lies between the sides and well away from each.
bool is_well_inside(const Point& p, const std::vector<Point>& points, const std::vector<Side>& sides) {
  bool inside = false;
  for (const Side& side : sides) {
    const Point &a = points[at(side[0])], &b = points[at(side[1])], along = b - a;
    const double squared = dot(along, along), share = squared > 0 ? std::clamp(dot(p - a, along) / squared, 0.0, 1.0) : 0;
    const Point off = {p.x - a.x - share * along.x, p.y - a.y - share * along.y};
    if (!(dot(off, off) > kClearance * kClearance * squared)) return false;
    if ((a.y > p.y) != (b.y > p.y) && (turn(a, b, p) > 0) == (b.y > a.y)) inside = !inside;
  }
  return inside;
}

}  // namespace

bool is_sound(const FaceOutline& outline, const std::vector<Vec3>& places, double least_area) {
  const std::vector<Point> points = in_plane(outline, places);
  double doubled = 0;
  for (const auto& [a, b] : outline.edges) doubled += cross(points[at(a)], points[at(b)]);
  if (!(0.5 * doubled > least_area)) return false;
  const auto low = [&](const Side& side) { return std::min(points[at(side[0])].x, points[at(side[1])].x); };
  std::vector<Side> edges = outline.edges;
  std::sort(edges.begin(), edges.end(), [&](const Side& s, const Side& t) { return low(s) < low(t); });
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const Point &a = points[at(edges[i][0])], &b = points[at(edges[i][1])];
    for (std::size_t j = i + 1; j < edges.size() && low(edges[j]) <= std::max(a.x, b.x); ++j)
      if (!share_an_end(edges[i], edges[j]) && meet(a, b, points[at(edges[j][0])], points[at(edges[j][1])])) return false;
  }
  return true;
}

std::vector<Triangle> triangles_between(const FaceOutline& outline, std::vector<Vec3>& places) {
  std::vector<Point> points = in_plane(outline, places);
  std::vector<char> is_on_side(points.size(), 0);
  for (const Side& side : outline.sides)
    for (const std::int32_t v : side) is_on_side[at(v)] = 1;
  std::vector<std::int32_t> kept, others;
  for (std::int32_t v = 0; at(v) < points.size(); ++v)
    if (!is_on_side[at(v)]) (is_well_inside(points[at(v)], points, outline.sides) ? kept : others).push_back(v);
  std::vector<Triangle> found;
  // without those inside where they lie too close to each other
  while (!Front(points, outline.sides, kept).fill(outline.triangles.size(), found)) {
    if (kept.empty()) return {};
    others.insert(others.end(), kept.begin(), kept.end());
    kept.clear();
    found.clear();
  }
  for (const std::int32_t v : others) {
    const auto area = [&](const Triangle& t) { return turn(points[at(t[0])], points[at(t[1])], points[at(t[2])]); };
    const auto largest = std::max_element(found.begin(), found.end(), [&](const auto& s, const auto& t) { return area(s) < area(t); });
    const auto [a, b, c] = *largest;
    places[at(v)] = (1.0 / 3) * (places[at(a)] + places[at(b)] + places[at(c)]);
    points[at(v)] = {(points[at(a)].x + points[at(b)].x + points[at(c)].x) / 3, (points[at(a)].y + points[at(b)].y + points[at(c)].y) / 3};
    *largest = {a, b, v};
    found.push_back({b, c, v});
    found.push_back({c, a, v});
  }
  if (found.size() != outline.triangles.size()) return {};
  for (Triangle& t : found)
    for (std::int32_t& v : t) v = outline.vertices[at(v)];
  return found;
}

}  // namespace scree
