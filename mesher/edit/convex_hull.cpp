#include "mesher/edit/convex_hull.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "mesher/repair/mesh_repair.hpp"

namespace scree {

namespace {

struct Face {
  Triangle corner;
  std::array<std::int32_t, 3> across;  // face over the edge from corner k to k + 1
  Vec3 normal;
  double offset = 0;
  std::vector<std::int32_t> outside;  // points that see this face and no earlier one
  bool is_dead = false;
};

std::size_t at(std::int32_t i) { return static_cast<std::size_t>(i); }

class Quickhull {
 public:
  explicit Quickhull(const std::vector<Vec3>& points) : points_(points) {}

  TriangleMesh run() {
    if (!start()) return {};
    for (std::size_t f = 0; f < faces_.size(); ++f) {
      if (!faces_[f].is_dead && !faces_[f].outside.empty()) grow(static_cast<std::int32_t>(f));
    }
    TriangleMesh mesh;
    mesh.vertices = points_;
    for (const Face& face : faces_) {
      if (!face.is_dead) mesh.triangles.push_back(face.corner);
    }
    drop_unreferenced(mesh);
    return mesh;
  }

 private:
  double height(const Face& f, std::int32_t p) const { return dot(f.normal, points_[at(p)]) - f.offset; }

  std::int32_t add_face(std::int32_t a, std::int32_t b, std::int32_t c) {
    Face f;
    f.corner = {a, b, c};
    f.across = {-1, -1, -1};
    const Vec3 n = cross(points_[at(b)] - points_[at(a)], points_[at(c)] - points_[at(a)]);
    const double l = length(n);
    f.normal = l > 0 ? (1 / l) * n : n;
    f.offset = dot(f.normal, (1.0 / 3) * (points_[at(a)] + points_[at(b)] + points_[at(c)]));
    faces_.push_back(std::move(f));
    return static_cast<std::int32_t>(faces_.size()) - 1;
  }

  /// A tetrahedron of points far apart; false when all lie in a plane.
  bool start() {
    if (points_.size() < 4) return false;
    Box3 box;
    for (const Vec3& p : points_) box.add(p);
    const Vec3 e = box.extent();
    tolerance_ = kHullTolerance * std::max({e.x, e.y, e.z});
    const auto furthest = [&](const auto& measure) {
      std::int32_t best = 0;
      double most = -1;
      for (std::int32_t p = 0; p < static_cast<std::int32_t>(points_.size()); ++p) {
        const double d = measure(points_[at(p)]);
        if (d > most) most = d, best = p;
      }
      return std::pair(best, most);
    };
    const Vec3 middle = box.centre();
    const std::int32_t a = furthest([&](const Vec3& p) { return length(p - middle); }).first;
    const Vec3 pa = points_[at(a)];
    const auto [b, ab] = furthest([&](const Vec3& p) { return length(p - pa); });
    if (!(ab > tolerance_)) return false;
    const Vec3 u = normalised(points_[at(b)] - pa);
    const auto [c, high] = furthest([&](const Vec3& p) { return length(cross(p - pa, u)); });
    if (!(high > tolerance_)) return false;
    const Vec3 n = normalised(cross(u, points_[at(c)] - pa));
    const auto [d, deep] = furthest([&](const Vec3& p) { return std::abs(dot(p - pa, n)); });
    if (!(deep > tolerance_)) return false;
    const bool is_above = dot(points_[at(d)] - pa, n) > 0;
    const std::int32_t p = is_above ? c : b, q = is_above ? b : c;  // a p q seen from outside, d behind it
    add_face(a, p, q);
    add_face(a, d, p);
    add_face(p, d, q);
    add_face(q, d, a);
    link({0, 1, 2, 3});
    std::vector<std::int32_t> all(points_.size());
    for (std::size_t i = 0; i < all.size(); ++i) all[i] = static_cast<std::int32_t>(i);
    share_out(all, {0, 1, 2, 3});
    return true;
  }

  /// Fills `across` among these faces.
  void link(const std::vector<std::int32_t>& faces) {
    std::map<std::pair<std::int32_t, std::int32_t>, std::pair<std::int32_t, std::size_t>> sides;
    for (std::int32_t f : faces) {
      for (std::size_t k = 0; k < 3; ++k) {
        const std::int32_t a = faces_[at(f)].corner[k], b = faces_[at(f)].corner[(k + 1) % 3];
        if (const auto twin = sides.find({b, a}); twin != sides.end()) {
          faces_[at(f)].across[k] = twin->second.first;
          faces_[at(twin->second.first)].across[twin->second.second] = f;
        } else {
          sides[{a, b}] = {f, k};
        }
      }
    }
  }

  void share_out(const std::vector<std::int32_t>& points, const std::vector<std::int32_t>& faces) {
    for (std::int32_t p : points) {
      for (std::int32_t f : faces) {
        if (!(height(faces_[at(f)], p) > tolerance_)) continue;
        faces_[at(f)].outside.push_back(p);
        break;
      }
    }
  }

  void grow(std::int32_t start_face) {
    const std::vector<std::int32_t>& seen_from = faces_[at(start_face)].outside;
    const std::int32_t apex = *std::max_element(seen_from.begin(), seen_from.end(), [&](std::int32_t p, std::int32_t q) {
      return height(faces_[at(start_face)], p) < height(faces_[at(start_face)], q);
    });
    // the faces that see the apex, and their horizon
    std::vector<std::int32_t> visible{start_face}, orphans;
    faces_[at(start_face)].is_dead = true;
    struct Side {
      std::int32_t a, b, face;
    };
    std::vector<Side> horizon;
    for (std::size_t i = 0; i < visible.size(); ++i) {
      const Face f = faces_[at(visible[i])];
      for (std::size_t k = 0; k < 3; ++k) {
        const std::int32_t g = f.across[k];
        if (faces_[at(g)].is_dead) continue;
        if (height(faces_[at(g)], apex) > 0) {
          faces_[at(g)].is_dead = true;
          visible.push_back(g);
        }
      }
    }
    for (std::int32_t v : visible) {
      const Face& f = faces_[at(v)];
      for (std::size_t k = 0; k < 3; ++k) {
        if (!faces_[at(f.across[k])].is_dead) horizon.push_back({f.corner[k], f.corner[(k + 1) % 3], f.across[k]});
      }
      orphans.insert(orphans.end(), f.outside.begin(), f.outside.end());
    }
    std::erase(orphans, apex);
    std::vector<std::int32_t> cone;
    for (const Side& side : horizon) {
      const std::int32_t f = add_face(side.a, side.b, apex);
      cone.push_back(f);
      faces_[at(f)].across[0] = side.face;
      Face& neighbour = faces_[at(side.face)];
      for (std::size_t k = 0; k < 3; ++k) {
        if (neighbour.corner[k] == side.b && neighbour.corner[(k + 1) % 3] == side.a) neighbour.across[k] = f;
      }
    }
    link(cone);
    share_out(orphans, cone);
    for (std::int32_t v : visible) faces_[at(v)].outside = {};
  }

  const std::vector<Vec3>& points_;
  double tolerance_ = 0;
  std::vector<Face> faces_;
};

}  // namespace

TriangleMesh convex_hull(const std::vector<Vec3>& points) { return Quickhull(points).run(); }

}  // namespace scree
