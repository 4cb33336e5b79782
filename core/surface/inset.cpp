#include "core/surface/inset.hpp"

#include <Eigen/SVD>
#include <algorithm>
#include <array>
#include <cmath>

#include "core/distance/mesh_distance.hpp"
#include "core/geometry/features.hpp"
#include "core/surface/flat_faces.hpp"
#include "core/surface/self_intersections.hpp"

namespace scree {

namespace {

/// Singular values below this share of the largest count as none: the way has no part where the normals do not say.
constexpr double kLeastSingular = 1e-3;
/// A triangle has turned over when its normal has gone further than 60 degrees, or nothing is left of its area.
constexpr double kLeastCosine = 0.5, kLeastArea = 1e-3;
constexpr double kReducedByTurn = 0.6, kReducedByCrossing = 0.5;
constexpr double kLeastShare = 1e-2;  // below, a vertex stays where it is
constexpr int kMostRounds = 200;

Vec3 doubled_normal(const TriangleMesh& mesh, std::int32_t t) {
  return cross(mesh.corner(t, 1) - mesh.corner(t, 0), mesh.corner(t, 2) - mesh.corner(t, 0));
}

/// The shortest way that takes all planes of these normals back by `margin`, as nearly as can be.
Vec3 way_of(const std::vector<Vec3>& normals, double margin) {
  if (normals.empty()) return {};
  if (normals.size() == 1) return -margin * normals.front();
  Eigen::MatrixXd planes(static_cast<Eigen::Index>(normals.size()), 3);
  for (std::size_t i = 0; i < normals.size(); ++i) planes.row(static_cast<Eigen::Index>(i)) << normals[i].x, normals[i].y, normals[i].z;
  Eigen::JacobiSVD<Eigen::MatrixXd> svd(planes, Eigen::ComputeThinU | Eigen::ComputeThinV);
  svd.setThreshold(kLeastSingular);
  const Eigen::Vector3d way = svd.solve(Eigen::VectorXd::Constant(planes.rows(), -margin));
  const Vec3 found{way(0), way(1), way(2)};
  const double size = length(found), most = kLongestMove * margin;
  return size > most ? (most / size) * found : found;
}

/// At corners; zero elsewhere. A face has one normal, whichever of its triangles are at the corner.
std::vector<Vec3> ways_of(const TriangleMesh& mesh, const FlatFaces& faces, double margin) {
  std::vector<Vec3> of_face(faces.face_count());
  for (std::int32_t t = 0; t < mesh.triangle_count(); ++t) of_face[faces.face(t)] += doubled_normal(mesh, t);
  std::vector<std::vector<Vec3>> normals(mesh.vertices.size());
  const double kSame = std::cos(kFlatAngle);
  for (std::int32_t t = 0; t < mesh.triangle_count(); ++t) {
    const Vec3& doubled = of_face[faces.face(t)];
    if (!(squared_length(doubled) > 0)) continue;
    const Vec3 n = normalised(doubled);
    for (const std::int32_t v : mesh.triangles[static_cast<std::size_t>(t)]) {
      if (!faces.is_corner(v)) continue;
      std::vector<Vec3>& known = normals[static_cast<std::size_t>(v)];
      if (std::none_of(known.begin(), known.end(), [&](const Vec3& other) { return dot(n, other) >= kSame; })) known.push_back(n);
    }
  }
  std::vector<Vec3> ways;
  for (const std::vector<Vec3>& of_vertex : normals) ways.push_back(way_of(of_vertex, margin));
  return ways;
}

/// Shares of the ways of corners, reduced until nothing is wrong.
class Shares {
 public:
  Shares(const TriangleMesh& mesh, double margin)
      : mesh_(mesh), faces_(mesh), ways_(ways_of(mesh, faces_, margin)), share_(mesh.vertices.size(), 1.0), moved_(mesh) {}

  Inset find() {
    for (int round = 0; round < kMostRounds; ++round) {
      move();
      std::vector<double> factor(share_.size(), 1.0);
      if (!reduce_turned(factor) && !reduce_crossing(factor)) return {std::move(moved_), of_all_vertices()};
      for (std::size_t v = 0; v < share_.size(); ++v) share_[v] *= factor[v];
      even_out();
      for (double& t : share_)
        if (t < kLeastShare) t = 0;
      hold_flat_faces();
    }
    std::fill(share_.begin(), share_.end(), 0.0);
    return {mesh_, std::move(share_)};
  }

 private:
  void move() {
    std::vector<Vec3> way(share_.size());
    for (const std::int32_t c : faces_.corners())
      way[static_cast<std::size_t>(c)] = share_[static_cast<std::size_t>(c)] * ways_[static_cast<std::size_t>(c)];
    faces_.spread(way);
    for (std::size_t v = 0; v < share_.size(); ++v) moved_.vertices[v] = mesh_.vertices[v] + way[v];
  }

  std::vector<double> of_all_vertices() const {
    std::vector<double> all = share_;
    for (std::int32_t t = 0; t < mesh_.triangle_count(); ++t)
      for (const std::int32_t v : mesh_.triangles[static_cast<std::size_t>(t)])
        if (!faces_.is_corner(v))
          for (const std::int32_t c : faces_.corners_of_face(t))
            all[static_cast<std::size_t>(v)] = std::min(all[static_cast<std::size_t>(v)], share_[static_cast<std::size_t>(c)]);
    return all;
  }

  bool moves(std::int32_t t) const {
    const std::vector<std::int32_t>& corners = faces_.corners_of_face(t);
    return std::any_of(corners.begin(), corners.end(), [&](std::int32_t v) { return share_[static_cast<std::size_t>(v)] > 0; });
  }

  void reduce(std::int32_t t, double by, std::vector<double>& factor) const {
    for (const std::int32_t v : faces_.corners_of_face(t)) factor[static_cast<std::size_t>(v)] = by;
  }

  bool reduce_turned(std::vector<double>& factor) const {
    bool any = false;
    for (std::int32_t t = 0; t < mesh_.triangle_count(); ++t) {
      const Vec3 before = doubled_normal(mesh_, t), now = doubled_normal(moved_, t);
      const double area_before = length(before), area = length(now);
      if (!(area_before > 0) || !moves(t)) continue;
      if (dot(before, now) >= kLeastCosine * area_before * area && area >= kLeastArea * area_before) continue;
      reduce(t, kReducedByTurn, factor);
      any = true;
    }
    return any;
  }

  bool reduce_crossing(std::vector<double>& factor) const {
    bool any = false;
    for (const CrossingPair& pair : find_crossing_pairs(moved_, CrossingAt::corners_too)) {
      for (const std::int32_t t : {pair.first, pair.second}) {
        if (!moves(t)) continue;
        reduce(t, kReducedByCrossing, factor);
        any = true;
      }
    }
    return any;
  }

  /// A corner goes at most half way between its share and the mean of those that edges join it with.
  void even_out() {
    std::vector<double> sum(share_.size(), 0.0), count(share_.size(), 0.0);
    for (const auto& [first, second] : faces_.edges()) {
      const auto a = static_cast<std::size_t>(first), b = static_cast<std::size_t>(second);
      sum[a] += share_[b];
      sum[b] += share_[a];
      count[a] += 1;
      count[b] += 1;
    }
    for (std::size_t v = 0; v < share_.size(); ++v)
      if (count[v] > 0) share_[v] = std::min(share_[v], 0.5 * (share_[v] + sum[v] / count[v]));
  }

  void hold_flat_faces() {
    for (bool changed = true; changed;) {
      changed = false;
      for (const std::vector<std::int32_t>& corners : faces_.rigid_faces()) {
        double least = 1;
        for (const std::int32_t v : corners) least = std::min(least, share_[static_cast<std::size_t>(v)]);
        for (const std::int32_t v : corners) {
          changed = changed || least < share_[static_cast<std::size_t>(v)];
          share_[static_cast<std::size_t>(v)] = least;
        }
      }
    }
  }

  const TriangleMesh& mesh_;
  FlatFaces faces_;
  std::vector<Vec3> ways_;
  std::vector<double> share_;  ///< of corners; 1 of other vertices
  TriangleMesh moved_;
};

}  // namespace

Inset inset(const TriangleMesh& mesh, double margin) { return Shares(mesh, margin).find(); }

namespace {

/// Integrates the deviation over a triangle: cut in four where the rounding of an edge or a corner makes it uneven, down to a quarter of
/// the margin.
class DeviationOver {
 public:
  DeviationOver(const TriangleMesh& moved, double margin) : moved_(moved), tree_(build_bvh(moved)), margin_(margin) {}

  void add(const Vec3& a, const Vec3& b, const Vec3& c) { add({a, off(a)}, {b, off(b)}, {c, off(c)}, 0); }
  InsetDeviation result() const { return {area_ > 0 ? integral_ / area_ : 0, largest_}; }

 private:
  struct Point {
    Vec3 x;
    double off;
  };
  // corners 1/20, middles of edges 2/15, centroid 9/20: exact for cubic functions on a triangle (Stroud 1971)
  static constexpr double kCorner = 1.0 / 20, kMiddle = 2.0 / 15, kCentroid = 9.0 / 20;
  static constexpr double kEven = 0.1, kFinest = 0.5;  // of the margin
  static constexpr int kMostCuts = 6;

  double off(const Vec3& at) {
    Vec3 nearest;
    std::int32_t triangle = -1;
    const double off = std::abs(point_mesh_distance({&moved_, &tree_}, at, 1e300, nearest, triangle) - margin_);
    largest_ = std::max(largest_, off);
    return off;
  }

  Point between(const Point& a, const Point& b) {
    const Vec3 x = 0.5 * (a.x + b.x);
    return {x, off(x)};
  }

  void add(const Point& a, const Point& b, const Point& c, int cuts) {
    const Point ab = between(a, b), bc = between(b, c), ca = between(c, a);
    const double middle = off((1.0 / 3) * (a.x + b.x + c.x));
    const auto [least, most] = std::minmax({a.off, b.off, c.off, ab.off, bc.off, ca.off, middle});
    const double longest = std::max({length(b.x - a.x), length(c.x - b.x), length(a.x - c.x)});
    if (most - least > kEven * margin_ && longest > kFinest * margin_ && cuts < kMostCuts) {
      add(a, ab, ca, cuts + 1);
      add(ab, b, bc, cuts + 1);
      add(ca, bc, c, cuts + 1);
      add(ab, bc, ca, cuts + 1);
      return;
    }
    const double size = 0.5 * length(cross(b.x - a.x, c.x - a.x));
    integral_ += size * (kCorner * (a.off + b.off + c.off) + kMiddle * (ab.off + bc.off + ca.off) + kCentroid * middle);
    area_ += size;
  }

  const TriangleMesh& moved_;
  Bvh tree_;
  double margin_, integral_ = 0, area_ = 0, largest_ = 0;
};

}  // namespace

InsetDeviation deviation_of_inset(const TriangleMesh& drawn, const TriangleMesh& moved, double margin) {
  DeviationOver over(moved, margin);
  for (std::int32_t t = 0; t < drawn.triangle_count(); ++t) over.add(drawn.corner(t, 0), drawn.corner(t, 1), drawn.corner(t, 2));
  return over.result();
}

}  // namespace scree
