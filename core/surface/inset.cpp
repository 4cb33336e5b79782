#include "core/surface/inset.hpp"

#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "core/base/index.hpp"
#include "core/distance/mesh_distance.hpp"
#include "core/geometry/features.hpp"
#include "core/geometry/half_edges.hpp"
#include "core/surface/flat_faces.hpp"
#include "core/surface/self_intersections.hpp"

namespace scree {

namespace {

/// Singular values below this share of the largest count as none: the way has no part where the normals do not say.
constexpr double kMinSingular = 1e-3;
/// A triangle has turned over when its normal has gone further than 60 degrees, or nothing is left of its area.
constexpr double kMinCosine = 0.5, kMinArea = 1e-3;
/// What a way longer by this share would turn over counts as turned: parts of a face that just meet have one answer, however rounded.
constexpr double kBeyond = 1e-3;
constexpr double kReducedByTurn = 0.6, kReducedByCrossing = 0.5;
constexpr double kMinShare = 1e-2;  // below, a vertex stays where it is
constexpr int kMaxRounds = 200;

Vec3 doubled_normal(const std::vector<Vec3>& vertices, const Triangle& t) {
  const Vec3& first = vertices[static_cast<std::size_t>(t[0])];
  return cross(vertices[static_cast<std::size_t>(t[1])] - first, vertices[static_cast<std::size_t>(t[2])] - first);
}

Vec3 doubled_normal(const TriangleMesh& mesh, std::int32_t t) {
  return doubled_normal(mesh.vertices, mesh.triangles[static_cast<std::size_t>(t)]);
}

/// The shortest way that takes all planes of these normals back by `margin`, as nearly as can be.
Vec3 way_of(const std::vector<Vec3>& normals, double margin) {
  if (normals.empty()) return {};
  if (normals.size() == 1) return -margin * normals.front();
  Eigen::MatrixXd planes(static_cast<Eigen::Index>(normals.size()), 3);
  for (std::size_t i = 0; i < normals.size(); ++i) planes.row(static_cast<Eigen::Index>(i)) << normals[i].x, normals[i].y, normals[i].z;
  Eigen::JacobiSVD<Eigen::MatrixXd> svd(planes, Eigen::ComputeThinU | Eigen::ComputeThinV);
  svd.setThreshold(kMinSingular);
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

/// Where a face or an edge is so small that it would vanish before the margin is reached, as the small cuts of a crushed stone do: its
/// corners go together, all by one way, so that it stays as it is; and the faces around give way to each other, each as a plane, by as
/// little as can be. Without it the smallest cut would hold back every face, since the corners of a flat face have one share.
///
/// How: unknown are the way of each group of corners and the depth s of each face over the margin, with n . way = -margin s at every corner
/// of a face that has more than three: such faces stay flat. Of all such ways, the one with the least squares of s - 1, over the area.
/// What would still turn joins more corners.
class CornerJoiner {
 public:
  CornerJoiner(const TriangleMesh& mesh, const FlatFaces& faces, double margin) : mesh_(mesh), faces_(faces), margin_(margin), groups_(0) {
    number_.assign(mesh.vertices.size(), -1);
    for (const std::int32_t c : faces.corners()) {
      number_[at(c)] = static_cast<std::int32_t>(corners_.size());
      corners_.push_back(c);
    }
    groups_ = DisjointSets(corners_.size());
    std::vector<Vec3> doubled(faces.face_count());
    std::vector<char> seen(faces.face_count(), 0);
    for (std::int32_t t = 0; t < mesh.triangle_count(); ++t) doubled[faces.face(t)] += doubled_normal(mesh, t);
    for (std::int32_t t = 0; t < mesh.triangle_count(); ++t) {
      const std::size_t f = faces.face(t);
      if (std::exchange(seen[f], 1) != 0 || !(squared_length(doubled[f]) > 0)) continue;
      planes_.push_back({normalised(doubled[f]), 0.5 * length(doubled[f]), faces.corners_of_face(t)});
    }
  }

  /// Ways of all vertices, zero but at corners. Nothing where faces would have to give way too far, or the shape has too many corners.
  std::optional<std::vector<Vec3>> find() {
    if (3 * corners_.size() + planes_.size() > kMaxUnknowns) return {};
    constexpr int kRounds = 20;
    for (int round = 0; round < kRounds; ++round) {
      if (!solve()) return {};
      if (join_vanishing() || join_far()) continue;
      if (!is_taken()) return {};
      return ways();
    }
    return {};
  }

  /// Joins the ends of the shortest edge of each face that these triangles are of. Returns whether there were any.
  bool join_at(const std::vector<std::int32_t>& triangles) {
    bool any = false;
    for (const std::int32_t t : triangles) {
      const std::vector<std::int32_t>& corners = faces_.corners_of_face(t);
      const auto is_of_face = [&](std::int32_t v) { return std::binary_search(corners.begin(), corners.end(), v); };
      double shortest = 1e300;
      const std::array<std::int32_t, 2>* best = nullptr;
      for (const auto& edge : faces_.edges()) {
        if (!is_of_face(edge[0]) || !is_of_face(edge[1]) || group(edge[0]) == group(edge[1])) continue;
        const double size = length(mesh_.vertices[at(edge[1])] - mesh_.vertices[at(edge[0])]);
        if (!(size < shortest)) continue;
        shortest = size;
        best = &edge;
      }
      if (best == nullptr) continue;
      groups_.join(number_[at((*best)[0])], number_[at((*best)[1])]);
      any = true;
    }
    return any;
  }

 private:
  static constexpr std::size_t kMaxUnknowns = 1200;  // dense matrices: a second
  /// An edge of which less than this share is left, along itself, joins its corners.
  static constexpr double kMinEdge = 0.1;
  /// Depths of faces over the margin that are taken: beyond, parts are thin, and shares say more.
  static constexpr double kMinDepth = 0.5, kMaxDepth = 2;

  struct Plane {
    Vec3 normal;
    double area;
    std::vector<std::int32_t> corners;  ///< vertices
    bool is_rigid() const { return corners.size() > 3; }
  };

  std::size_t group(std::int32_t vertex) { return at(groups_.find(number_[at(vertex)])); }
  Vec3 way(std::int32_t vertex) {
    const auto i = static_cast<Eigen::Index>(3 * column_[group(vertex)]);
    return margin_ * Vec3{found_(i), found_(i + 1), found_(i + 2)};
  }

  bool solve() {
    // columns: the ways of groups over the margin, then the depths of rigid faces
    column_.assign(corners_.size(), 0);
    std::size_t groups = 0;
    for (std::size_t c = 0; c < corners_.size(); ++c)
      if (at(groups_.find(static_cast<std::int32_t>(c))) == c) column_[c] = groups++;
    std::vector<std::vector<std::size_t>> of_plane;
    std::size_t rows = 0, wishes = 0, depths = 0;
    for (const Plane& plane : planes_) {
      std::vector<std::size_t> own;
      for (const std::int32_t v : plane.corners) own.push_back(column_[group(v)]);
      std::sort(own.begin(), own.end());
      own.erase(std::unique(own.begin(), own.end()), own.end());
      depths += plane.is_rigid() ? 1 : 0;
      (plane.is_rigid() ? rows : wishes) += own.size();
      of_plane.push_back(std::move(own));
    }
    const auto columns = static_cast<Eigen::Index>(3 * groups + depths);
    Eigen::MatrixXd held = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(rows), columns);
    Eigen::MatrixXd wanted = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(wishes + depths), columns);
    Eigen::VectorXd goal = Eigen::VectorXd::Zero(wanted.rows());
    Eigen::Index row = 0, wish = 0, depth = static_cast<Eigen::Index>(3 * groups);
    for (std::size_t k = 0; k < planes_.size(); ++k) {
      const Plane& plane = planes_[k];
      const double weight = std::sqrt(plane.area);
      for (const std::size_t g : of_plane[k]) {
        const auto first = static_cast<Eigen::Index>(3 * g);
        Eigen::MatrixXd& to = plane.is_rigid() ? held : wanted;
        const Eigen::Index r = plane.is_rigid() ? row++ : wish++;
        const double w = plane.is_rigid() ? 1 : weight / std::sqrt(static_cast<double>(of_plane[k].size()));
        for (int i = 0; i < 3; ++i) to(r, first + i) = w * plane.normal[i];
        if (plane.is_rigid())
          to(r, depth) = 1;
        else
          goal(r) = -w;
      }
      if (plane.is_rigid()) {
        wanted(wish, depth++) = weight;
        goal(wish++) = weight;
      }
    }
    // what keeps faces flat: the null space of the rows that are held
    Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> kept(held);
    kept.setThreshold(kMinSingular * 1e-6);
    const Eigen::Index rank = kept.rank();
    if (rank >= columns) return false;
    const Eigen::MatrixXd turned = kept.matrixZ().transpose();
    const Eigen::MatrixXd free = kept.colsPermutation() * turned.rightCols(columns - rank);
    Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> best;
    best.setThreshold(kMinSingular * 1e-3);
    best.compute(wanted * free);
    found_ = free * best.solve(goal);
    depths_ = found_.tail(static_cast<Eigen::Index>(depths));
    return true;
  }

  /// Whether no face gives way too far.
  bool is_taken() const { return depths_.size() == 0 || (depths_.minCoeff() >= kMinDepth && depths_.maxCoeff() <= kMaxDepth); }

  /// Joins corners that would go too far, where faces are nearly flat to each other, with the nearest. Returns whether there were any.
  bool join_far() {
    std::vector<double> nearest(corners_.size(), 1e300);
    std::vector<std::int32_t> partner(corners_.size(), -1);
    for (const auto& edge : faces_.edges()) {
      if (group(edge[0]) == group(edge[1])) continue;
      const double size = length(mesh_.vertices[at(edge[1])] - mesh_.vertices[at(edge[0])]);
      for (const int end : {0, 1}) {
        const std::size_t c = at(number_[at(edge[static_cast<std::size_t>(end)])]);
        if (size < nearest[c]) {
          nearest[c] = size;
          partner[c] = edge[static_cast<std::size_t>(1 - end)];
        }
      }
    }
    bool any = false;
    for (std::size_t c = 0; c < corners_.size(); ++c) {
      if (partner[c] < 0 || length(way(corners_[c])) <= kLongestMove * margin_) continue;
      groups_.join(static_cast<std::int32_t>(c), number_[at(partner[c])]);
      any = true;
    }
    return any;
  }

  /// Returns whether there were any.
  bool join_vanishing() {
    std::vector<std::array<std::int32_t, 2>> vanishing;
    for (const auto& edge : faces_.edges()) {
      if (group(edge[0]) == group(edge[1])) continue;
      const Vec3 along = mesh_.vertices[at(edge[1])] - mesh_.vertices[at(edge[0])];
      if (dot(along, along + way(edge[1]) - way(edge[0])) < kMinEdge * squared_length(along)) vanishing.push_back(edge);
    }
    for (const auto& edge : vanishing) groups_.join(number_[at(edge[0])], number_[at(edge[1])]);
    return !vanishing.empty();
  }

  std::vector<Vec3> ways() {
    std::vector<Vec3> all(mesh_.vertices.size());
    for (const std::int32_t c : corners_) all[at(c)] = way(c);
    return all;
  }

  const TriangleMesh& mesh_;
  const FlatFaces& faces_;
  double margin_;
  std::vector<std::int32_t> corners_, number_;  // vertices; and of a vertex, which corner it is
  std::vector<Plane> planes_;
  DisjointSets groups_;              ///< of corners that go together
  std::vector<std::size_t> column_;  // of a group
  Eigen::VectorXd found_, depths_;
};

/// Shares of the ways of corners, reduced until nothing is wrong.
class Shares {
 public:
  Shares(const TriangleMesh& mesh, double margin)
      : mesh_(mesh), margin_(margin), faces_(mesh), ways_(ways_of(mesh, faces_, margin)), share_(mesh.vertices.size(), 1.0), moved_(mesh) {}

  Inset find() {
    if (!faces_.rigid_faces().empty()) {
      move();
      if (is_wrong()) {
        const std::vector<Vec3> plain = ways_;
        CornerJoiner joiner(mesh_, faces_, margin_);
        for (std::optional<std::vector<Vec3>> joined = joiner.find(); joined; joined = joiner.find()) {
          ways_ = std::move(*joined);
          move();
          if (!is_wrong()) return {std::move(moved_), share_};
          if (!joiner.join_at(turned_faces())) break;
        }
        ways_ = plain;
      }
    }
    for (int round = 0; round < kMaxRounds; ++round) {
      move();
      std::vector<double> factor(share_.size(), 1.0);
      if (!reduce_turned(factor) && !reduce_crossing(factor)) return {std::move(moved_), of_all_vertices()};
      for (std::size_t v = 0; v < share_.size(); ++v) share_[v] *= factor[v];
      even_out();
      for (double& t : share_)
        if (t < kMinShare) t = 0;
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
    if (std::exchange(is_split_again_, false)) moved_.triangles = mesh_.triangles;
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

  bool is_turned(std::int32_t t) const {
    const Vec3 before = doubled_normal(mesh_, t), now = doubled_normal(moved_.vertices, mesh_.triangles[static_cast<std::size_t>(t)]);
    const double area_before = length(before), area = length(now);
    if (!(area_before > 0) || !moves(t)) return false;
    return dot(before, now) < kMinCosine * area_before * area || area < kMinArea * area_before;
  }

  /// Where the vertices of a face are when they go this share of their ways.
  std::vector<Vec3> places(const FaceOutline& outline, double share) const {
    std::vector<Vec3> found;
    for (const std::int32_t v : outline.vertices) {
      const Vec3 &drawn = mesh_.vertices[static_cast<std::size_t>(v)], &moved = moved_.vertices[static_cast<std::size_t>(v)];
      found.push_back(share == 1 ? moved : drawn + share * (moved - drawn));
    }
    return found;
  }

  /// Gives a face other triangles. Returns false where there are none.
  bool split_again(const FaceOutline& outline) {
    std::vector<Vec3> at = places(outline, 1);
    const std::vector<Triangle> found = triangles_between(outline, at);
    if (found.empty()) return false;
    is_split_again_ = true;
    for (std::size_t i = 0; i < at.size(); ++i) moved_.vertices[static_cast<std::size_t>(outline.vertices[i])] = at[i];
    for (std::size_t i = 0; i < found.size(); ++i) {
      const Vec3 now = doubled_normal(moved_.vertices, found[i]);
      if (dot(outline.normal, now) < kMinCosine * length(now)) return false;
      moved_.triangles[static_cast<std::size_t>(outline.triangles[i])] = found[i];
    }
    return true;
  }

  /// One triangle of each face that has turned over, or of which nothing is left. Of a face of more than three corners the outline says so;
  /// where it is sound and the triangles that it was drawn with are not, it has others from now on.
  std::vector<std::int32_t> turned_faces() {
    std::vector<char> has_turned(faces_.face_count(), 0);
    for (std::int32_t t = 0; t < mesh_.triangle_count(); ++t) {
      char& has = has_turned[faces_.face(t)];
      has = has != 0 || is_turned(t);
    }
    for (const FaceOutline& outline : faces_.outlines()) {
      const std::int32_t first = outline.triangles.front();
      if (!(outline.area > 0) || !moves(first)) continue;
      char& has = has_turned[faces_.face(first)];
      if (!is_sound(outline, places(outline, 1 + kBeyond), kMinArea * outline.area))
        has = 1;
      else if (has != 0)
        has = !split_again(outline);
    }
    std::vector<std::int32_t> turned;
    for (std::int32_t t = 0; t < mesh_.triangle_count(); ++t)
      if (std::exchange(has_turned[faces_.face(t)], 0) != 0) turned.push_back(t);
    return turned;
  }

  bool reduce_turned(std::vector<double>& factor) {
    const std::vector<std::int32_t> turned = turned_faces();
    for (const std::int32_t t : turned) reduce(t, kReducedByTurn, factor);
    return !turned.empty();
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

  bool is_wrong() {
    std::vector<double> factor(share_.size(), 1.0);
    return reduce_turned(factor) || reduce_crossing(factor);
  }

  const TriangleMesh& mesh_;
  double margin_;
  FlatFaces faces_;
  std::vector<Vec3> ways_;
  std::vector<double> share_;  ///< of corners; 1 of other vertices
  TriangleMesh moved_;
  bool is_split_again_ = false;  ///< faces of it
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
  static constexpr int kMaxCuts = 6;

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
    if (most - least > kEven * margin_ && longest > kFinest * margin_ && cuts < kMaxCuts) {
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
