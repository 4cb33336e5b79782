#include "core/geometry/features.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>
#include <vector>

#include "core/geometry/half_edges.hpp"

namespace scree {

namespace {

/// One undirected mesh edge and the faces on it.
struct MeshEdge {
  std::int32_t low, high;               // vertex indices
  std::int32_t first_face, face_count;  // range in the sorted half-edge list
  std::int32_t faces[2] = {-1, -1};
  bool is_turned = false;  // the two faces run along it in the same direction: their normals point to opposite sides
  EdgeKind kind = EdgeKind::flat;
  bool is_fold = false;  // convex from the side that the normals look away from
  std::int32_t feature = -1;
};

Vec3 unit_normal(const TriangleMesh& mesh, std::int32_t t) {
  const Vec3 n = cross(mesh.corner(t, 1) - mesh.corner(t, 0), mesh.corner(t, 2) - mesh.corner(t, 0));
  const double l = length(n);
  return l > 0 ? (1 / l) * n : Vec3{};
}

/// Of a face with this normal at the edge from a along u: the corner farthest from the edge tells which side it is on.
Vec3 conormal_of(const TriangleMesh& mesh, std::int32_t face, const Vec3& normal, const Vec3& a, const Vec3& u) {
  Vec3 t = cross(normal, u);
  const double l = length(t);
  if (!(l > 0)) return Vec3{};
  t = (1 / l) * t;
  double farthest = 0;
  for (int k = 0; k < 3; ++k) {
    const double across = dot(t, mesh.corner(face, k) - a);
    if (std::abs(across) > std::abs(farthest)) farthest = across;
  }
  return farthest < 0 ? -t : t;
}

/// The two faces with the widest angle between them around an edge from a along u, if it is convex there: wider than a half turn by more
/// than a flat surface is.
bool find_convex_side(const TriangleMesh& mesh, const std::vector<Vec3>& normal, const std::vector<std::int32_t>& faces, const Vec3& a,
                      const Vec3& u, std::int32_t (&bounds)[2]) {
  struct Around {
    double angle;
    std::int32_t face;
  };
  std::vector<Around> around;
  Vec3 first;
  for (const std::int32_t face : faces) {
    const Vec3 c = conormal_of(mesh, face, normal[static_cast<std::size_t>(face)], a, u);
    if (!(squared_length(c) > 0)) continue;
    if (around.empty()) first = c;
    around.push_back({std::atan2(dot(cross(first, c), u) / length(u), dot(first, c)), face});
  }
  if (around.empty()) return false;
  std::sort(around.begin(), around.end(),
            [](const Around& l, const Around& r) { return l.angle != r.angle ? l.angle < r.angle : l.face < r.face; });
  double widest = 0;
  for (std::size_t i = 0; i < around.size(); ++i) {
    const bool is_last = i + 1 == around.size();
    const Around& next = around[is_last ? 0 : i + 1];
    const double gap = next.angle - around[i].angle + (is_last ? 2 * std::numbers::pi : 0.0);
    if (!(gap > widest)) continue;
    widest = gap;
    bounds[0] = around[i].face;
    bounds[1] = next.face;
  }
  return widest > std::numbers::pi + kFlatAngle;
}

// bits of FeatureTable::marks: 0-2 owned corners, 3-5 owned edges, 6-14 kinds
std::uint16_t corner_mark(std::size_t k) { return static_cast<std::uint16_t>(1u << k); }
std::uint16_t edge_mark(std::size_t k) { return static_cast<std::uint16_t>(1u << (3 + k)); }
std::uint16_t kind_mark(EdgeKind kind, std::size_t k) { return static_cast<std::uint16_t>(static_cast<unsigned>(kind) << (6 + 3 * k)); }

/// The parts of find_features(), in their order.
class FeatureFinder {
 public:
  FeatureFinder(const TriangleMesh& mesh, Sides sides)
      : mesh_(mesh), sides_(sides), half_(sorted_half_edges(mesh)), sharp_at_(static_cast<std::size_t>(mesh.vertex_count())) {
    const auto triangles = static_cast<std::size_t>(mesh.triangle_count());
    table_.corner_of.assign(sharp_at_.size(), -1);
    table_.edge_of.assign(triangles, {-1, -1, -1});
    table_.marks.assign(triangles, 0);
    table_.region.assign(triangles, 0);
    for (std::size_t t = 0; t < triangles; ++t) normal_.push_back(unit_normal(mesh, static_cast<std::int32_t>(t)));
  }

  FeatureTable find() {
    if (mesh_.triangle_count() == 0) {  // a lone point (the centre of an analytic sphere) is a corner
      std::iota(table_.corner_of.begin(), table_.corner_of.end(), 0);
      table_.corners = table_.corner_of;
      return std::move(table_);
    }
    list_edges();
    find_regions();
    find_kinds();
    find_corners();
    number_edges(false);
    if (sides_ == Sides::both) number_edges(true);
    mark_edges();
    table_.corners.shrink_to_fit();
    table_.edges.shrink_to_fit();
    return std::move(table_);
  }

 private:
  void list_edges();
  void find_regions();
  void find_kinds();
  void find_kind(MeshEdge& edge);
  void find_corners();
  void number_edges(bool folds);
  void mark_edges();

  bool is_corner(std::int32_t v) const;
  std::int32_t walk(std::int32_t v, std::int32_t e, std::int32_t feature);
  std::int32_t other_end(std::int32_t e, std::int32_t v) const {
    const MeshEdge& edge = edges_[static_cast<std::size_t>(e)];
    return edge.low == v ? edge.high : edge.low;
  }
  const Vec3& vertex(std::int32_t v) const { return mesh_.vertices[static_cast<std::size_t>(v)]; }
  const Vec3& normal(std::int32_t face) const { return normal_[static_cast<std::size_t>(face)]; }

  const TriangleMesh& mesh_;
  Sides sides_;
  const std::vector<HalfEdge> half_;
  const double flat_cosine_ = std::cos(kFlatAngle);
  std::vector<Vec3> normal_;  // of each triangle
  std::vector<MeshEdge> edges_;
  std::vector<std::vector<std::int32_t>> sharp_at_;  // edges that are not flat, of each vertex
  FeatureTable table_;
};

/// Mesh edges from sorted half edges.
void FeatureFinder::list_edges() {
  for_each_edge(half_, [&](std::size_t i, std::size_t j) {
    MeshEdge edge{half_[i].low, half_[i].high, static_cast<std::int32_t>(i), static_cast<std::int32_t>(j - i)};
    edge.faces[0] = half_[i].triangle;
    if (j - i > 1) {
      edge.faces[1] = half_[i + 1].triangle;
      edge.is_turned = half_[i].is_forward == half_[i + 1].is_forward;
    }
    edges_.push_back(edge);
  });
}

/// Flat regions: faces joined over edges whose normals agree.
void FeatureFinder::find_regions() {
  DisjointSets joined(normal_.size());
  for (const MeshEdge& edge : edges_) {
    if (edge.face_count != 2) continue;
    const double cosine = dot(normal(edge.faces[0]), normal(edge.faces[1]));
    if ((edge.is_turned ? -cosine : cosine) <= flat_cosine_) continue;
    joined.join(edge.faces[0], edge.faces[1]);
  }
  std::vector<std::int32_t> region_of_root(normal_.size(), -1);
  for (std::size_t t = 0; t < normal_.size(); ++t) {
    const auto root = static_cast<std::size_t>(joined.find(static_cast<std::int32_t>(t)));
    if (region_of_root[root] < 0) region_of_root[root] = table_.region_count++;
    table_.region[t] = region_of_root[root];
  }
}

void FeatureFinder::find_kind(MeshEdge& edge) {
  if (edge.face_count == 1) {
    edge.kind = EdgeKind::boundary;
  } else if (edge.face_count > 2) {
    edge.kind = EdgeKind::non_manifold;
    if (sides_ != Sides::both) return;
    std::vector<std::int32_t> around;
    for (std::int32_t h = edge.first_face; h < edge.first_face + edge.face_count; ++h)
      around.push_back(half_[static_cast<std::size_t>(h)].triangle);
    const Vec3 &a = vertex(edge.low), &b = vertex(edge.high);
    edge.kind = find_convex_side(mesh_, normal_, around, a, b - a, edge.faces) ? EdgeKind::convex : EdgeKind::concave;
  } else if (table_.region[static_cast<std::size_t>(edge.faces[0])] != table_.region[static_cast<std::size_t>(edge.faces[1])]) {
    const Vec3 &a = vertex(edge.low), &b = vertex(edge.high);
    const double side = dot(normal(edge.faces[0]), conormal_of(mesh_, edge.faces[1], normal(edge.faces[1]), a, b - a));
    edge.is_fold = sides_ == Sides::both && side > 0;
    edge.kind = side > 0 && sides_ == Sides::outside ? EdgeKind::concave : EdgeKind::convex;
  }
}

/// The kind of each edge, and the sharp edges around each vertex.
void FeatureFinder::find_kinds() {
  for (std::size_t e = 0; e < edges_.size(); ++e) {
    MeshEdge& edge = edges_[e];
    find_kind(edge);
    if (edge.kind != EdgeKind::flat) {
      for (const std::int32_t end : {edge.low, edge.high}) sharp_at_[static_cast<std::size_t>(end)].push_back(static_cast<std::int32_t>(e));
    }
    for (std::int32_t h = edge.first_face; h < edge.first_face + edge.face_count; ++h) {
      const HalfEdge& he = half_[static_cast<std::size_t>(h)];
      table_.marks[static_cast<std::size_t>(he.triangle)] |= kind_mark(edge.kind, static_cast<std::size_t>(he.k));
    }
  }
}

/// Not flat, and not the inside of a straight edge.
bool FeatureFinder::is_corner(std::int32_t v) const {
  const auto& sharp = sharp_at_[static_cast<std::size_t>(v)];
  if (sharp.empty()) return false;
  if (sharp.size() != 2) return true;
  if (edges_[static_cast<std::size_t>(sharp[0])].kind != edges_[static_cast<std::size_t>(sharp[1])].kind) return true;
  const Vec3 a = vertex(other_end(sharp[0], v)) - vertex(v), b = vertex(other_end(sharp[1], v)) - vertex(v);
  return dot(a, b) > -flat_cosine_ * length(a) * length(b);
}

void FeatureFinder::find_corners() {
  for (std::int32_t v = 0; v < mesh_.vertex_count(); ++v) {
    if (!is_corner(v)) continue;
    table_.corner_of[static_cast<std::size_t>(v)] = static_cast<std::int32_t>(table_.corners.size());
    table_.corners.push_back(v);
  }
  std::vector<char> taken(table_.corners.size(), 0);
  for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::int32_t c = table_.corner_of[static_cast<std::size_t>(mesh_.triangles[t][k])];
      if (c < 0 || taken[static_cast<std::size_t>(c)]) continue;
      taken[static_cast<std::size_t>(c)] = 1;
      table_.marks[t] |= corner_mark(k);
    }
  }
}

/// Follows a straight run of sharp edges from a vertex on, and numbers them. Returns the vertex where the run ends.
std::int32_t FeatureFinder::walk(std::int32_t v, std::int32_t e, std::int32_t feature) {
  while (table_.corner_of[static_cast<std::size_t>(v)] < 0) {
    const auto& sharp = sharp_at_[static_cast<std::size_t>(v)];
    const std::int32_t next = sharp[0] == e ? sharp[1] : sharp[0];
    if (edges_[static_cast<std::size_t>(next)].feature >= 0) break;
    edges_[static_cast<std::size_t>(next)].feature = feature;
    v = other_end(next, v);
    e = next;
  }
  return v;
}

/// Feature edges: each straight run of sharp edges from corner to corner.   in   folds   those that are convex from behind, or the others
void FeatureFinder::number_edges(bool folds) {
  for (std::size_t e = 0; e < edges_.size(); ++e) {
    MeshEdge& edge = edges_[e];
    if (edge.kind == EdgeKind::flat || edge.kind == EdgeKind::concave || edge.feature >= 0 || edge.is_fold != folds) continue;
    edge.feature = static_cast<std::int32_t>(table_.edges.size());
    FeatureEdge feature;
    feature.vertex_a = walk(edge.low, static_cast<std::int32_t>(e), edge.feature);
    feature.vertex_b = walk(edge.high, static_cast<std::int32_t>(e), edge.feature);
    if (edge.kind != EdgeKind::non_manifold) std::copy(edge.faces, edge.faces + 2, feature.face);
    table_.edges.push_back(feature);
  }
}

void FeatureFinder::mark_edges() {
  for (const MeshEdge& edge : edges_) {
    if (edge.feature < 0) continue;
    const HalfEdge& owner = half_[static_cast<std::size_t>(edge.first_face)];
    table_.marks[static_cast<std::size_t>(owner.triangle)] |= edge_mark(static_cast<std::size_t>(owner.k));
    for (std::int32_t h = edge.first_face; h < edge.first_face + edge.face_count; ++h) {
      const HalfEdge& he = half_[static_cast<std::size_t>(h)];
      table_.edge_of[static_cast<std::size_t>(he.triangle)][static_cast<std::size_t>(he.k)] = edge.feature;
    }
  }
}

}  // namespace

Vec3 conormal(const TriangleMesh& mesh, const FeatureEdge& edge, int side) {
  const std::int32_t face = edge.face[side];
  if (face < 0) return {};
  const Vec3& a = mesh.vertices[static_cast<std::size_t>(edge.vertex_a)];
  return conormal_of(mesh, face, unit_normal(mesh, face), a, mesh.vertices[static_cast<std::size_t>(edge.vertex_b)] - a);
}

std::size_t FeatureTable::memory() const {
  const auto bytes = [](const auto& v) { return v.capacity() * sizeof(v[0]); };
  return bytes(corners) + bytes(corner_of) + bytes(edges) + bytes(edge_of) + bytes(marks) + bytes(region);
}

FeatureTable find_features(const TriangleMesh& mesh, Sides sides) { return FeatureFinder(mesh, sides).find(); }

}  // namespace scree
