#include "core/surface/self_intersections.hpp"

#include <algorithm>

#include "core/base/long_work.hpp"
#include "core/distance/triangle_distance.hpp"
#include "core/geometry/bvh.hpp"

namespace scree {

namespace {

/// Box of a node's child or of a leaf, from the middle of the tree; rounded outward, or monotonically, so that boxes which
/// overlap still do.
struct Box {
  float lower[3], upper[3];
};

Box child_box(const BvhNode& node, std::int32_t k) {
  return {{node.lower[0][k], node.lower[1][k], node.lower[2][k]}, {node.upper[0][k], node.upper[1][k], node.upper[2][k]}};
}

bool overlap(const Box& a, const Box& b) {
  for (int i = 0; i < 3; ++i) {
    if (a.lower[i] > b.upper[i] || b.lower[i] > a.upper[i]) return false;
  }
  return true;
}

bool boxes_overlap(const TriangleMesh& mesh, std::int32_t s, std::int32_t t) {
  for (int i = 0; i < 3; ++i) {
    const auto [s_low, s_high] = std::minmax({mesh.corner(s, 0)[i], mesh.corner(s, 1)[i], mesh.corner(s, 2)[i]});
    const auto [t_low, t_high] = std::minmax({mesh.corner(t, 0)[i], mesh.corner(t, 1)[i], mesh.corner(t, 2)[i]});
    if (s_low > t_high || t_low > s_high) return false;
  }
  return true;
}

std::size_t shared_vertices(const Triangle& s, const Triangle& t) {
  return static_cast<std::size_t>(
      std::count_if(s.begin(), s.end(), [&](std::int32_t v) { return std::find(t.begin(), t.end(), v) != t.end(); }));
}

/// Whether the edge of `s` that is opposite to the vertex which it shares with `t` meets `t`.
bool opposite_edge_meets(const TriangleMesh& mesh, std::int32_t s, std::int32_t t) {
  const Triangle &of_s = mesh.triangles[static_cast<std::size_t>(s)], &of_t = mesh.triangles[static_cast<std::size_t>(t)];
  int k = 0;
  while (std::find(of_t.begin(), of_t.end(), of_s[static_cast<std::size_t>(k)]) == of_t.end()) ++k;
  const Vec3 a = mesh.corner(s, (k + 1) % 3), b = mesh.corner(s, (k + 2) % 3);
  const Vec3 edge[3] = {a, b, b}, triangle[3] = {mesh.corner(t, 0), mesh.corner(t, 1), mesh.corner(t, 2)};
  return triangle_distance(edge, triangle).intersecting;
}

}  // namespace

std::vector<CrossingPair> find_crossing_pairs(const TriangleMesh& mesh, CrossingAt where) {
  const Bvh bvh = build_bvh(mesh);
  std::vector<CrossingPair> found;
  if (bvh.nodes.empty()) return found;
  const auto test = [&](std::int32_t s, std::int32_t t) {
    if (s > t) std::swap(s, t);
    const std::size_t shared = shared_vertices(mesh.triangles[static_cast<std::size_t>(s)], mesh.triangles[static_cast<std::size_t>(t)]);
    if (shared > 1 || (shared == 1 && where == CrossingAt::no_corner)) return;
    if (!boxes_overlap(mesh, s, t)) return;
    if (shared == 1) {
      if (opposite_edge_meets(mesh, s, t) || opposite_edge_meets(mesh, t, s)) found.push_back({s, t});
      return;
    }
    const Vec3 a[3] = {mesh.corner(s, 0), mesh.corner(s, 1), mesh.corner(s, 2)};
    const Vec3 b[3] = {mesh.corner(t, 0), mesh.corner(t, 1), mesh.corner(t, 2)};
    if (triangle_distance(a, b).intersecting) found.push_back({s, t});
  };
  // pairs of subtrees whose boxes overlap: >= 0 a node, < 0 leaf ~code; one and the same to begin with
  struct Subtrees {
    std::int32_t a, b;
    Box box_a, box_b;
  };
  std::vector<Subtrees> stack{{0, 0, {}, {}}};
  LongWork work("check", static_cast<double>(bvh.leaves.size()));
  while (!stack.empty()) {
    const Subtrees pair = stack.back();
    stack.pop_back();
    if (pair.a < 0 && pair.b < 0) {
      if (pair.a == pair.b) work.advance();
      const BvhLeaf &a = bvh.leaves[static_cast<std::size_t>(~pair.a)], &b = bvh.leaves[static_cast<std::size_t>(~pair.b)];
      for (std::int32_t m = 0; m < a.count; ++m)
        for (std::int32_t n = pair.a == pair.b ? m + 1 : 0; n < b.count; ++n) test(a.triangle[m], b.triangle[n]);
    } else if (pair.a == pair.b) {
      const BvhNode& node = bvh.nodes[static_cast<std::size_t>(pair.a)];
      for (std::int32_t k = 0; k < node.count; ++k)
        for (std::int32_t l = k; l < node.count; ++l) {
          const Box first = child_box(node, k), second = child_box(node, l);
          if (overlap(first, second)) stack.push_back({node.child[k], node.child[l], first, second});
        }
    } else {
      const bool opens_a = pair.a >= 0;
      const BvhNode& node = bvh.nodes[static_cast<std::size_t>(opens_a ? pair.a : pair.b)];
      for (std::int32_t k = 0; k < node.count; ++k) {
        const Box child = child_box(node, k);
        if (!overlap(child, opens_a ? pair.box_b : pair.box_a)) continue;
        stack.push_back(opens_a ? Subtrees{node.child[k], pair.b, child, pair.box_b} : Subtrees{pair.a, node.child[k], pair.box_a, child});
      }
    }
  }
  std::sort(found.begin(), found.end(),
            [](const CrossingPair& p, const CrossingPair& q) { return p.first != q.first ? p.first < q.first : p.second < q.second; });
  return found;
}

}  // namespace scree
