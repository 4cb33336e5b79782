#include "core/geometry/features.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

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

FeatureTable find_features(const TriangleMesh& mesh, Sides sides) {
  const auto triangle_count = static_cast<std::size_t>(mesh.triangle_count());
  const auto vertex_count = static_cast<std::size_t>(mesh.vertex_count());
  FeatureTable table;
  table.corner_of.assign(vertex_count, -1);
  table.edge_of.assign(triangle_count, {-1, -1, -1});
  table.marks.assign(triangle_count, 0);
  table.region.assign(triangle_count, 0);
  if (triangle_count == 0) {  // a lone point (the centre of an analytic sphere) is a corner
    std::iota(table.corner_of.begin(), table.corner_of.end(), 0);
    table.corners = table.corner_of;
    return table;
  }

  std::vector<Vec3> normal(triangle_count);
  for (std::size_t t = 0; t < triangle_count; ++t) normal[t] = unit_normal(mesh, static_cast<std::int32_t>(t));

  // mesh edges from sorted half edges
  const std::vector<HalfEdge> half = sorted_half_edges(mesh);
  std::vector<MeshEdge> edges;
  for_each_edge(half, [&](std::size_t i, std::size_t j) {
    MeshEdge edge{half[i].low, half[i].high, static_cast<std::int32_t>(i), static_cast<std::int32_t>(j - i)};
    edge.faces[0] = half[i].triangle;
    if (j - i > 1) {
      edge.faces[1] = half[i + 1].triangle;
      edge.is_turned = half[i].is_forward == half[i + 1].is_forward;
    }
    edges.push_back(edge);
  });

  // flat regions: faces joined over edges whose normals agree
  const double flat_cosine = std::cos(kFlatAngle);
  DisjointSets joined(triangle_count);
  for (const MeshEdge& edge : edges) {
    if (edge.face_count != 2) continue;
    const auto f = static_cast<std::size_t>(edge.faces[0]), g = static_cast<std::size_t>(edge.faces[1]);
    const double cosine = dot(normal[f], normal[g]);
    if ((edge.is_turned ? -cosine : cosine) <= flat_cosine) continue;
    joined.join(edge.faces[0], edge.faces[1]);
  }
  std::vector<std::int32_t> region_of_root(triangle_count, -1);
  for (std::size_t t = 0; t < triangle_count; ++t) {
    const auto root = static_cast<std::size_t>(joined.find(static_cast<std::int32_t>(t)));
    if (region_of_root[root] < 0) region_of_root[root] = table.region_count++;
    table.region[t] = region_of_root[root];
  }

  // kind of each edge, and the sharp edges around each vertex
  std::vector<std::vector<std::int32_t>> sharp_at(vertex_count);
  std::vector<std::int32_t> around;
  for (std::size_t e = 0; e < edges.size(); ++e) {
    MeshEdge& edge = edges[e];
    if (edge.face_count == 1) {
      edge.kind = EdgeKind::boundary;
    } else if (edge.face_count > 2) {
      edge.kind = EdgeKind::non_manifold;
      if (sides == Sides::both) {
        around.clear();
        for (std::int32_t h = edge.first_face; h < edge.first_face + edge.face_count; ++h)
          around.push_back(half[static_cast<std::size_t>(h)].triangle);
        const Vec3 &a = mesh.vertices[static_cast<std::size_t>(edge.low)], &b = mesh.vertices[static_cast<std::size_t>(edge.high)];
        edge.kind = find_convex_side(mesh, normal, around, a, b - a, edge.faces) ? EdgeKind::convex : EdgeKind::concave;
      }
    } else if (table.region[static_cast<std::size_t>(edge.faces[0])] != table.region[static_cast<std::size_t>(edge.faces[1])]) {
      const Vec3 &a = mesh.vertices[static_cast<std::size_t>(edge.low)], &b = mesh.vertices[static_cast<std::size_t>(edge.high)];
      const Vec3 into = conormal_of(mesh, edge.faces[1], normal[static_cast<std::size_t>(edge.faces[1])], a, b - a);
      const double side = dot(normal[static_cast<std::size_t>(edge.faces[0])], into);
      edge.is_fold = sides == Sides::both && side > 0;
      edge.kind = side > 0 && sides == Sides::outside ? EdgeKind::concave : EdgeKind::convex;
    }
    if (edge.kind != EdgeKind::flat) {
      sharp_at[static_cast<std::size_t>(edge.low)].push_back(static_cast<std::int32_t>(e));
      sharp_at[static_cast<std::size_t>(edge.high)].push_back(static_cast<std::int32_t>(e));
    }
    for (std::int32_t h = edge.first_face; h < edge.first_face + edge.face_count; ++h) {
      const HalfEdge& he = half[static_cast<std::size_t>(h)];
      table.marks[static_cast<std::size_t>(he.triangle)] |= kind_mark(edge.kind, static_cast<std::size_t>(he.k));
    }
  }

  // corners: not flat, and not the inside of a straight edge
  const auto other_end = [&](std::int32_t e, std::int32_t v) {
    const MeshEdge& edge = edges[static_cast<std::size_t>(e)];
    return edge.low == v ? edge.high : edge.low;
  };
  const auto is_corner = [&](std::int32_t v) {
    const auto& sharp = sharp_at[static_cast<std::size_t>(v)];
    if (sharp.empty()) return false;
    if (sharp.size() != 2) return true;
    if (edges[static_cast<std::size_t>(sharp[0])].kind != edges[static_cast<std::size_t>(sharp[1])].kind) return true;
    const Vec3& p = mesh.vertices[static_cast<std::size_t>(v)];
    const Vec3 a = mesh.vertices[static_cast<std::size_t>(other_end(sharp[0], v))] - p;
    const Vec3 b = mesh.vertices[static_cast<std::size_t>(other_end(sharp[1], v))] - p;
    return dot(a, b) > -flat_cosine * length(a) * length(b);
  };
  std::vector<std::int32_t>& corner_of = table.corner_of;
  for (std::int32_t v = 0; v < mesh.vertex_count(); ++v) {
    if (!is_corner(v)) continue;
    corner_of[static_cast<std::size_t>(v)] = static_cast<std::int32_t>(table.corners.size());
    table.corners.push_back(v);
  }
  std::vector<char> corner_taken(table.corners.size(), 0);
  for (std::size_t t = 0; t < triangle_count; ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::int32_t c = corner_of[static_cast<std::size_t>(mesh.triangles[t][k])];
      if (c < 0 || corner_taken[static_cast<std::size_t>(c)]) continue;
      corner_taken[static_cast<std::size_t>(c)] = 1;
      table.marks[t] |= corner_mark(k);
    }
  }

  // feature edges: walk each straight run of sharp edges from corner to corner
  const auto walk = [&](std::int32_t v, std::int32_t e, std::int32_t feature) {
    while (corner_of[static_cast<std::size_t>(v)] < 0) {
      const auto& sharp = sharp_at[static_cast<std::size_t>(v)];
      const std::int32_t next = sharp[0] == e ? sharp[1] : sharp[0];
      if (edges[static_cast<std::size_t>(next)].feature >= 0) break;
      edges[static_cast<std::size_t>(next)].feature = feature;
      v = other_end(next, v);
      e = next;
    }
    return v;
  };
  const auto number_edges = [&](bool folds) {
    for (std::size_t e = 0; e < edges.size(); ++e) {
      MeshEdge& edge = edges[e];
      if (edge.kind == EdgeKind::flat || edge.kind == EdgeKind::concave || edge.feature >= 0 || edge.is_fold != folds) continue;
      edge.feature = static_cast<std::int32_t>(table.edges.size());
      FeatureEdge feature;
      feature.vertex_a = walk(edge.low, static_cast<std::int32_t>(e), edge.feature);
      feature.vertex_b = walk(edge.high, static_cast<std::int32_t>(e), edge.feature);
      if (edge.kind != EdgeKind::non_manifold) std::copy(edge.faces, edge.faces + 2, feature.face);
      table.edges.push_back(feature);
    }
  };
  number_edges(false);
  if (sides == Sides::both) number_edges(true);
  for (const MeshEdge& edge : edges) {
    if (edge.feature < 0) continue;
    const HalfEdge& owner = half[static_cast<std::size_t>(edge.first_face)];
    table.marks[static_cast<std::size_t>(owner.triangle)] |= edge_mark(static_cast<std::size_t>(owner.k));
    for (std::int32_t h = edge.first_face; h < edge.first_face + edge.face_count; ++h) {
      const HalfEdge& he = half[static_cast<std::size_t>(h)];
      table.edge_of[static_cast<std::size_t>(he.triangle)][static_cast<std::size_t>(he.k)] = edge.feature;
    }
  }
  table.corners.shrink_to_fit();
  table.edges.shrink_to_fit();
  return table;
}

}  // namespace scree
