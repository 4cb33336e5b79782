#include "core/geometry/polygons.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace scree {

namespace {

struct Point {
  double x, y;
  bool operator==(const Point&) const = default;
};

double squared_distance(const Point& a, const Point& b) { return (b.x - a.x) * (b.x - a.x) + (b.y - a.y) * (b.y - a.y); }

/// Which way a triangle turns: 1 to the left, -1 to the right, 0 when its height is within kDegenerateHeight of its longest edge.
int turn(const Point& a, const Point& b, const Point& c) {
  const double twice = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
  const double longest2 = std::max({squared_distance(a, b), squared_distance(b, c), squared_distance(c, a)});
  if (!(std::abs(twice) > kDegenerateHeight * longest2)) return 0;
  return twice > 0 ? 1 : -1;
}

/// Cuts one polygon at a time; keeps its arrays between them.
class EarCutter {
 public:
  explicit EarCutter(const std::vector<Vec3>& vertices) : vertices_(vertices) {}

  /// Adds the triangles of a facet; returns false when it had to be cut as a fan.
  bool cut(std::span<const std::int32_t> facet, std::vector<Triangle>& triangles) {
    take_ring(facet);
    const std::size_t n = ring_.size();
    if (n < 3) {  // its corners coincide: one triangle without area stands for it and is counted when it is dropped
      triangles.push_back({facet[0], facet[1], facet[2]});
      return true;
    }
    if (n == 3) {
      triangles.push_back({ring_[0], ring_[1], ring_[2]});
      return true;
    }
    project();
    const std::size_t before = triangles.size();
    if (n == 4 ? cut_in_two(triangles) : cut_ears(triangles)) return true;
    triangles.resize(before);
    for (std::size_t i = 1; i + 1 < n; ++i) triangles.push_back({ring_[0], ring_[i], ring_[i + 1]});
    return !std::all_of(ring_.begin(), ring_.end(), [&](std::int32_t v) { return is_finite(position(v)); });
  }

 private:
  const Vec3& position(std::int32_t v) const { return vertices_[static_cast<std::size_t>(v)]; }

  /// The corners without those at the position of the one before.
  void take_ring(std::span<const std::int32_t> facet) {
    ring_.clear();
    for (std::int32_t v : facet) {
      if (ring_.empty() || facet.size() == 3 || position(v) != position(ring_.back())) ring_.push_back(v);
    }
    while (facet.size() > 3 && ring_.size() > 1 && position(ring_.back()) == position(ring_.front())) ring_.pop_back();
  }

  /// Drops the axis next to the normal, so that the polygon turns to the left.
  void project() {
    Vec3 normal{};
    const Vec3 origin = position(ring_[0]);
    for (std::size_t i = 1; i + 1 < ring_.size(); ++i) normal += cross(position(ring_[i]) - origin, position(ring_[i + 1]) - origin);
    int axis = 0;
    for (int k = 1; k < 3; ++k) {
      if (std::abs(normal[k]) > std::abs(normal[axis])) axis = k;
    }
    int u = (axis + 1) % 3, v = (axis + 2) % 3;
    if (normal[axis] < 0) std::swap(u, v);
    points_.clear();
    for (std::int32_t i : ring_) points_.push_back({position(i)[u], position(i)[v]});
  }

  bool cut_in_two(std::vector<Triangle>& triangles) {
    const auto turns_left = [&](std::size_t i, std::size_t j, std::size_t k) { return turn(points_[i], points_[j], points_[k]) > 0; };
    for (std::size_t first : {0U, 1U}) {
      const std::size_t a = first, b = first + 1, c = first + 2, d = (first + 3) % 4;
      if (!turns_left(a, b, c) || !turns_left(a, c, d)) continue;
      triangles.push_back({ring_[a], ring_[b], ring_[c]});
      triangles.push_back({ring_[a], ring_[c], ring_[d]});
      return true;
    }
    return false;
  }

  /// Whether the triangle at corner i turns left and holds no other corner, on its border included. Corners that lie where one of
  /// its own does, as along a cut to a hole, do not count.
  bool is_ear(std::size_t i) const {
    const Point &a = points_[before_[i]], &b = points_[i], &c = points_[after_[i]];
    if (turn(a, b, c) <= 0) return false;
    for (std::size_t j = after_[after_[i]]; j != before_[i]; j = after_[j]) {
      const Point& p = points_[j];
      if (p == a || p == b || p == c) continue;
      if (turn(a, b, p) >= 0 && turn(b, c, p) >= 0 && turn(c, a, p) >= 0) return false;
    }
    return true;
  }

  bool cut_ears(std::vector<Triangle>& triangles) {
    const std::size_t n = ring_.size();
    before_.resize(n);
    after_.resize(n);
    ear_.resize(n);
    for (std::size_t i = 0; i < n; ++i) before_[i] = (i + n - 1) % n, after_[i] = (i + 1) % n;
    for (std::size_t i = 0; i < n; ++i) ear_[i] = is_ear(i);
    std::size_t start = 0;
    for (std::size_t left = n; left > 3; --left) {
      std::size_t best = shortest_ear(start);
      if (best == n) {  // what blocked a corner may be gone
        for (std::size_t i = after_[start];; i = after_[i]) {
          ear_[i] = is_ear(i);
          if (i == start) break;
        }
        best = shortest_ear(start);
        if (best == n) return false;
      }
      const std::size_t a = before_[best], c = after_[best];
      triangles.push_back({ring_[a], ring_[best], ring_[c]});
      after_[a] = c;
      before_[c] = a;
      ear_[a] = is_ear(a);
      ear_[c] = is_ear(c);
      start = a;
    }
    const std::size_t a = before_[start], c = after_[start];
    if (turn(points_[a], points_[start], points_[c]) < 0) return false;
    triangles.push_back({ring_[a], ring_[start], ring_[c]});
    return true;
  }

  /// Of the corners that are left, the ear whose cut is shortest, the first in the facet of several; n when there is none.
  std::size_t shortest_ear(std::size_t start) const {
    std::size_t best = ring_.size(), i = start;
    double shortest = std::numeric_limits<double>::infinity();
    do {
      if (ear_[i]) {
        const double l2 = squared_distance(points_[before_[i]], points_[after_[i]]);
        if (l2 < shortest || (l2 == shortest && i < best)) shortest = l2, best = i;
      }
      i = after_[i];
    } while (i != start);
    return best;
  }

  const std::vector<Vec3>& vertices_;
  std::vector<std::int32_t> ring_;
  std::vector<Point> points_;
  std::vector<std::size_t> before_, after_;
  std::vector<char> ear_;
};

}  // namespace

TriangleMesh triangulated(PolygonMesh&& polygons, PolygonCounts& counts) {
  TriangleMesh mesh;
  mesh.triangles.reserve(polygons.facet_count());
  EarCutter cutter(polygons.vertices);
  for (std::size_t f = 0; f < polygons.facet_count(); ++f) {
    const std::span<const std::int32_t> facet = polygons.facet(f);
    if (facet.size() < 3) {
      ++counts.too_few;
    } else if (facet.size() == 3) {
      mesh.triangles.push_back({facet[0], facet[1], facet[2]});
    } else if (!cutter.cut(facet, mesh.triangles)) {
      ++counts.crossing;
    }
  }
  mesh.vertices = std::move(polygons.vertices);
  return mesh;
}

}  // namespace scree
