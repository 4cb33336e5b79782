#include "mesher/check/mesh_deviation.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "core/base/long_work.hpp"
#include "core/distance/mesh_distance.hpp"
#include "core/distance/triangle_distance.hpp"
#include "core/geometry/bvh.hpp"

namespace scree {

namespace {

/// A point of one surface, its distance from the other and the triangle that it has it from.
struct Probe {
  Vec3 point;
  double distance;
  std::int32_t nearest;
};

/// A piece of a triangle that may hold the maximum.
struct Piece {
  std::array<Probe, 3> corner;
  double upper;
  bool operator<(const Piece& o) const { return upper < o.upper; }
};

class Search {
 public:
  Search(const TriangleMesh& from, const TriangleMesh& to) : from_(from), to_(to), bvh_(build_bvh(to)) {
    Box3 all = bounding_box(from);
    all.add(bounding_box(to));
    floor_ = kDeviationFloor * length(all.extent());
  }

  Deviation run() {
    std::vector<Probe> probes(from_.vertices.size());
    std::vector<char> used(from_.vertices.size(), 0);
    // the vertices of all triangles, then their faces, then what is left of them: that part is mostly short
    LongWork work("distance", 2 * static_cast<double>(from_.triangles.size()));
    for (const Triangle& t : from_.triangles) {
      for (std::int32_t v : t) {
        const auto i = static_cast<std::size_t>(v);
        if (!used[i]) probes[i] = probe(from_.vertices[i]);
        used[i] = 1;
      }
      work.advance();
    }
    work_ = 0;
    std::vector<Piece> heap;
    for (const Triangle& t : from_.triangles) {
      add({probes[static_cast<std::size_t>(t[0])], probes[static_cast<std::size_t>(t[1])], probes[static_cast<std::size_t>(t[2])]}, heap);
      work.advance();
    }
    std::make_heap(heap.begin(), heap.end());
    double left = 0;  // the largest bound that was not followed up
    while (!heap.empty()) {
      std::pop_heap(heap.begin(), heap.end());
      const Piece piece = heap.back();
      heap.pop_back();
      if (!matters(piece.upper) || work_ > kDeviationWork) {
        left = piece.upper;
        break;
      }
      std::size_t longest = 0;
      for (std::size_t k = 1; k < 3; ++k) {
        if (edge2(piece, k) > edge2(piece, longest)) longest = k;
      }
      const Probe &a = piece.corner[longest], &b = piece.corner[(longest + 1) % 3], &c = piece.corner[(longest + 2) % 3];
      const Probe m = probe(0.5 * (a.point + b.point));
      work.advance(0);
      for (const auto& half : {std::array{a, m, c}, std::array{m, b, c}}) {
        const std::size_t before = heap.size();
        add(half, heap);
        if (heap.size() > before) std::push_heap(heap.begin(), heap.end());
      }
    }
    result_.upper = std::max({result_.lower, left, ignored_});
    return result_;
  }

 private:
  static double edge2(const Piece& p, std::size_t k) { return squared_length(p.corner[(k + 1) % 3].point - p.corner[k].point); }
  bool matters(double upper) const { return upper > (1 + kDeviationTolerance) * result_.lower + floor_; }

  Probe probe(const Vec3& point) {
    ++work_;
    Probe p{point, 0, -1};
    Vec3 nearest;
    p.distance = point_mesh_distance({&to_, &bvh_}, point, std::numeric_limits<double>::infinity(), nearest, p.nearest);
    if (p.distance > result_.lower) result_.lower = p.distance, result_.place = point;
    return p;
  }

  double distance_to(const Vec3& point, std::int32_t triangle) const {
    const Vec3 face[3] = {to_.corner(triangle, 0), to_.corner(triangle, 1), to_.corner(triangle, 2)};
    const Vec3 points[3] = {point, point, point};
    return triangle_distance(face, points).distance;
  }

  /// Largest distance of a corner from one triangle of the other surface: a bound for the whole piece.
  double convex_bound(const std::array<Probe, 3>& corner, std::int32_t triangle) const {
    double bound = 0;
    for (const Probe& p : corner) {
      bound = std::max(bound, p.nearest == triangle ? p.distance : distance_to(p.point, triangle));
    }
    return bound;
  }

  /// Pushes the piece when it may hold the maximum; what is left out is remembered in ignored_.
  void add(const std::array<Probe, 3>& corner, std::vector<Piece>& heap) {
    const double largest = std::max({corner[0].distance, corner[1].distance, corner[2].distance});
    double longest2 = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      longest2 = std::max(longest2, squared_length(corner[(k + 1) % 3].point - corner[k].point));
    }
    // every point of a triangle is within 1 / sqrt 3 of its longest edge from a corner
    double upper = largest + std::sqrt(longest2 / 3);
    for (std::size_t k = 0; k < 3 && matters(upper); ++k) {
      upper = std::min(upper, convex_bound(corner, corner[k].nearest));
    }
    if (matters(upper)) {
      const Vec3 middle = (1.0 / 3) * (corner[0].point + corner[1].point + corner[2].point);
      const Probe centre = probe(middle);
      double radius = 0;
      for (const Probe& p : corner) radius = std::max(radius, length(p.point - middle));
      upper = std::min({upper, centre.distance + radius, convex_bound(corner, centre.nearest)});
    }
    if (matters(upper)) {
      heap.push_back({corner, upper});
    } else {
      ignored_ = std::max(ignored_, upper);
    }
  }

  const TriangleMesh &from_, &to_;
  Bvh bvh_;
  double floor_ = 0, ignored_ = 0;
  std::int64_t work_ = 0;
  Deviation result_;
};

}  // namespace

Deviation one_sided_deviation(const TriangleMesh& from, const TriangleMesh& to) { return Search(from, to).run(); }

HausdorffDistance hausdorff_distance(const TriangleMesh& a, const TriangleMesh& b) {
  return {one_sided_deviation(a, b), one_sided_deviation(b, a)};
}

}  // namespace scree
