#include "post/bed/closed_cut.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "core/base/index.hpp"
#include "core/geometry/half_edges.hpp"
#include "core/geometry/plane_faces.hpp"

namespace scree {

namespace {

using Index = std::int32_t;
using Edge = std::pair<Index, Index>;

constexpr Index next(Index k) { return (k + 1) % 3; }

class Cutter {
 public:
  Cutter(const TriangleMesh& mesh, const Vec3& plane, const Vec3& normal, double snap) : mesh_(mesh), normal_(normal), snap_(snap) {
    height_.reserve(mesh.vertices.size());
    for (const Vec3& p : mesh.vertices) height_.push_back(dot(p - plane, normal));
  }

  bool anything_beyond() const {
    return std::any_of(height_.begin(), height_.end(), [](double h) { return h > 0; });
  }

  /// Chooses the part nearest to a place; returns how far it reaches beyond the plane.
  double choose_part(const Vec3& place) {
    std::vector<Index> root(height_.size());
    std::iota(root.begin(), root.end(), 0);
    const auto find = [&](Index i) {
      while (root[at(i)] != i) i = root[at(i)] = root[at(root[at(i)])];
      return i;
    };
    for_each_edge([&](Index a, Index b) {
      if (beyond_plane(a) && beyond_plane(b)) root[at(find(a))] = find(b);
    });
    double nearest = std::numeric_limits<double>::infinity();
    Index chosen = -1;
    const auto offer = [&](Index vertex, const Vec3& p) {
      const double d = squared_length(p - place);
      if (d < nearest) nearest = d, chosen = find(vertex);
    };
    for (Index v = 0; v < mesh_.vertex_count(); ++v) {
      if (beyond_plane(v)) offer(v, mesh_.vertices[at(v)]);
    }
    for_each_edge([&](Index a, Index b) {
      if (beyond_plane(a) != beyond_plane(b)) offer(beyond_plane(a) ? a : b, crossing(a, b));
    });
    removed_.assign(height_.size(), false);
    double deepest = 0;
    for (Index v = 0; v < mesh_.vertex_count(); ++v) {
      if (!beyond_plane(v) || find(v) != chosen) continue;
      removed_[at(v)] = true;
      deepest = std::max(deepest, height_[at(v)]);
    }
    return deepest;
  }

  /// The mesh without the chosen part; none where the rim bounds no face.
  std::optional<TriangleMesh> without_part() {
    result_.vertices = mesh_.vertices;
    for (const Triangle& t : mesh_.triangles) cut_triangle(t);
    if (result_.triangles.empty() || !close_rim()) return std::nullopt;
    drop_unused_vertices();
    return std::move(result_);
  }

 private:
  bool beyond_plane(Index v) const { return height_[at(v)] > 0; }

  template <class Visit>
  void for_each_edge(const Visit& visit) const {
    for (const Triangle& t : mesh_.triangles) {
      for (Index k = 0; k < 3; ++k) visit(t[at(k)], t[at(next(k))]);
    }
  }

  /// The same point, whichever end is named first.
  Vec3 crossing(Index a, Index b) const {
    if (a > b) std::swap(a, b);
    const double share = height_[at(a)] / (height_[at(a)] - height_[at(b)]);
    return mesh_.vertices[at(a)] + share * (mesh_.vertices[at(b)] - mesh_.vertices[at(a)]);
  }

  /// The vertex where an edge leaves through the plane.
  Index rim_vertex(Index a, Index b) {
    const Edge edge = std::minmax(a, b);
    const auto [it, is_new] = rim_vertices_.try_emplace(edge, -1);
    if (!is_new) return it->second;
    const Vec3 p = crossing(a, b);
    for (const Index end : {edge.first, edge.second}) {
      if (length(p - mesh_.vertices[at(end)]) < snap_) return it->second = end;
    }
    result_.vertices.push_back(p);
    return it->second = static_cast<Index>(result_.vertices.size()) - 1;
  }

  void cut_triangle(const Triangle& t) {
    std::vector<Index> kept;
    Edge rim{-1, -1};  // where the outline of what is kept leaves the old surface, and where it comes back
    for (Index k = 0; k < 3; ++k) {
      const Index a = t[at(k)], b = t[at(next(k))];
      if (!removed_[at(a)]) kept.push_back(a);
      if (removed_[at(a)] == removed_[at(b)]) continue;
      const Index v = rim_vertex(a, b);
      kept.push_back(v);
      (removed_[at(b)] ? rim.first : rim.second) = v;
    }
    kept.erase(std::unique(kept.begin(), kept.end()), kept.end());
    while (kept.size() > 1 && kept.front() == kept.back()) kept.pop_back();
    for (std::size_t k = 1; k + 1 < kept.size(); ++k) result_.triangles.push_back({kept[0], kept[k], kept[k + 1]});
    if (rim.first >= 0 && rim.first != rim.second) add_rim(rim.second, rim.first);
  }

  /// An edge of the flat face; one that runs the other way takes it back: both bound a triangle that snapping has flattened.
  void add_rim(Index from, Index to) {
    const auto [first, last] = rim_.equal_range(to);
    for (auto it = first; it != last; ++it) {
      if (it->second != from) continue;
      rim_.erase(it);
      return;
    }
    rim_.emplace(from, to);
  }

  bool close_rim() {
    const std::vector<Edge> edges(rim_.begin(), rim_.end());
    const std::optional<std::vector<PlaneFace>> faces = plane_faces(edges, result_.vertices, normal_);
    if (!faces) return false;
    for (const PlaneFace& face : *faces) {
      if (!covers(face)) return false;
      result_.triangles.insert(result_.triangles.end(), face.triangles.begin(), face.triangles.end());
    }
    return true;
  }

  /// Whether no triangles of a face lie over each other: those of a fan do where the rim is not convex.
  bool covers(const PlaneFace& face) const {
    constexpr double kOver = 1e-3;
    double net = 0, sum = 0;
    for (const Triangle& t : face.triangles) {
      const Vec3& o = result_.vertices[at(t[0])];
      const double twice = dot(cross(result_.vertices[at(t[1])] - o, result_.vertices[at(t[2])] - o), normal_);
      net += twice;
      sum += std::abs(twice);
    }
    return sum <= (1 + kOver) * net;
  }

  void drop_unused_vertices() {
    std::vector<Index> place(result_.vertices.size(), -1);
    std::vector<Vec3> used;
    for (Triangle& t : result_.triangles) {
      for (Index& v : t) {
        if (place[at(v)] < 0) {
          place[at(v)] = static_cast<Index>(used.size());
          used.push_back(result_.vertices[at(v)]);
        }
        v = place[at(v)];
      }
    }
    result_.vertices = std::move(used);
  }

  const TriangleMesh& mesh_;
  Vec3 normal_;
  double snap_;
  std::vector<double> height_;  ///< of each vertex over the plane [m]
  std::vector<bool> removed_;
  std::map<Edge, Index> rim_vertices_;
  std::multimap<Index, Index> rim_;
  TriangleMesh result_;
};

/// The triangles about each vertex, kept up to date while edges are merged.
class EdgeCollapse {
 public:
  explicit EdgeCollapse(TriangleMesh& mesh) : mesh_(mesh), gone_(mesh.triangles.size()), about_(mesh.vertices.size()) {
    for (Index t = 0; t < mesh.triangle_count(); ++t) {
      for (const Index v : mesh.triangles[at(t)]) about_[at(v)].insert(t);
    }
  }

  void run(double shortest) {
    std::set<std::pair<double, Edge>> open;
    const auto offer = [&](Index a, Index b) {
      const double d = length(mesh_.vertices[at(a)] - mesh_.vertices[at(b)]);
      if (d < shortest) open.insert({d, std::minmax(a, b)});
    };
    for (const Triangle& t : mesh_.triangles) {
      for (Index k = 0; k < 3; ++k) offer(t[at(k)], t[at(next(k))]);
    }
    while (!open.empty()) {
      const Edge edge = open.begin()->second;
      open.erase(open.begin());
      for (const auto& [from, to] : {edge, Edge{edge.second, edge.first}}) {
        if (!may_merge(from, to)) continue;
        merge(from, to);
        for (const Index v : neighbours(to)) offer(to, v);
        break;
      }
    }
    std::vector<Triangle> kept;
    for (std::size_t t = 0; t < gone_.size(); ++t) {
      if (!gone_[t]) kept.push_back(mesh_.triangles[t]);
    }
    mesh_.triangles = std::move(kept);
  }

 private:
  std::set<Index> neighbours(Index v) const {
    std::set<Index> found;
    for (const Index t : about_[at(v)]) found.insert(mesh_.triangles[at(t)].begin(), mesh_.triangles[at(t)].end());
    found.erase(v);
    return found;
  }
  Vec3 normal_of(const Triangle& t) const {
    const Vec3& o = mesh_.vertices[at(t[0])];
    return cross(mesh_.vertices[at(t[1])] - o, mesh_.vertices[at(t[2])] - o);
  }

  bool may_merge(Index from, Index to) const {
    const std::set<Index> a = neighbours(from), b = neighbours(to);
    if (!a.contains(to)) return false;  // merged already
    const auto common = std::count_if(a.begin(), a.end(), [&](Index v) { return b.contains(v); });
    if (common != 2 || a.size() + b.size() <= 6) return false;  // a tetrahedron has nothing to lose
    for (const Index t : about_[at(from)]) {
      Triangle moved = mesh_.triangles[at(t)];
      if (std::find(moved.begin(), moved.end(), to) != moved.end()) continue;
      const Vec3 before = normal_of(moved);
      std::replace(moved.begin(), moved.end(), from, to);
      if (dot(before, normal_of(moved)) < 0) return false;
    }
    return true;
  }

  void merge(Index from, Index to) {
    for (const Index t : std::set<Index>(about_[at(from)])) {
      Triangle& triangle = mesh_.triangles[at(t)];
      if (std::find(triangle.begin(), triangle.end(), to) != triangle.end()) {
        gone_[at(t)] = true;
        for (const Index v : triangle) about_[at(v)].erase(t);
        continue;
      }
      std::replace(triangle.begin(), triangle.end(), from, to);
      about_[at(to)].insert(t);
    }
    about_[at(from)].clear();
  }

  TriangleMesh& mesh_;
  std::vector<bool> gone_;
  std::vector<std::set<Index>> about_;
};

}  // namespace

void collapse_short_edges(TriangleMesh& mesh, double shortest) { EdgeCollapse(mesh).run(shortest); }

void flip_flat_triangles(TriangleMesh& mesh, double lowest) {
  constexpr int kPasses = 10;
  std::map<Edge, Index> triangle_of;  // by its directed edges
  for (Index t = 0; t < mesh.triangle_count(); ++t) {
    for (Index k = 0; k < 3; ++k) triangle_of[{mesh.triangles[at(t)][at(k)], mesh.triangles[at(t)][at(next(k))]}] = t;
  }
  const auto edge_vector = [&](Index a, Index b) { return mesh.vertices[at(b)] - mesh.vertices[at(a)]; };
  const auto normal_of = [&](const Triangle& t) { return cross(edge_vector(t[0], t[1]), edge_vector(t[0], t[2])); };
  const auto longest_of = [&](const Triangle& t) {
    Index longest = 0;
    for (Index k = 1; k < 3; ++k) {
      if (length(edge_vector(t[at(k)], t[at(next(k))])) > length(edge_vector(t[at(longest)], t[at(next(longest))]))) longest = k;
    }
    return longest;
  };
  const auto height_of = [&](const Triangle& t) {
    const Index k = longest_of(t);
    return length(normal_of(t)) / length(edge_vector(t[at(k)], t[at(next(k))]));
  };
  for (int pass = 0; pass < kPasses; ++pass) {
    bool any = false;
    for (Index t = 0; t < mesh.triangle_count(); ++t) {
      const Triangle flat = mesh.triangles[at(t)];
      if (!(height_of(flat) < lowest)) continue;
      const Index k = longest_of(flat), a = flat[at(k)], b = flat[at(next(k))], c = flat[at(next(next(k)))];
      const auto over = triangle_of.find({b, a});
      if (over == triangle_of.end()) continue;
      const Index o = over->second;
      const Triangle other = mesh.triangles[at(o)];
      const Index d = *std::find_if(other.begin(), other.end(), [&](Index v) { return v != a && v != b; });
      if (triangle_of.contains({c, d}) || triangle_of.contains({d, c})) continue;
      const Triangle first{a, d, c}, second{d, b, c};
      const Vec3 facing = normal_of(other);
      if (dot(normal_of(first), facing) <= 0 || dot(normal_of(second), facing) <= 0) continue;
      if (std::min(height_of(first), height_of(second)) <= std::min(height_of(flat), height_of(other))) continue;
      for (const Triangle& old : {flat, other}) {
        for (Index e = 0; e < 3; ++e) triangle_of.erase({old[at(e)], old[at(next(e))]});
      }
      mesh.triangles[at(t)] = first;
      mesh.triangles[at(o)] = second;
      for (const Index n : {t, o}) {
        for (Index e = 0; e < 3; ++e) triangle_of[{mesh.triangles[at(n)][at(e)], mesh.triangles[at(n)][at(next(e))]}] = n;
      }
      any = true;
    }
    if (!any) return;
  }
}

CutOutcome cut_off(TriangleMesh& mesh, const Vec3& plane, const Vec3& normal, const Vec3& place, double deepest, double snap) {
  Cutter cutter(mesh, plane, normal, snap);
  if (!cutter.anything_beyond()) return CutOutcome::nothing;
  if (cutter.choose_part(place) > deepest) return CutOutcome::deep;
  std::optional<TriangleMesh> rest = cutter.without_part();
  if (!rest || open_edges(*rest) > 0) return CutOutcome::refused;
  mesh = std::move(*rest);
  return CutOutcome::cut;
}

std::size_t open_edges(const TriangleMesh& mesh) {
  const std::vector<HalfEdge> half = sorted_half_edges(mesh);
  std::size_t open = 0;
  for_each_edge(half, [&](std::size_t first, std::size_t last) {
    if (last - first != 2 || half[first].is_forward == half[first + 1].is_forward) ++open;
  });
  return open;
}

}  // namespace scree
