#include "mesher/self_intersections.hpp"

#include <algorithm>

#include "core/distance/triangle_distance.hpp"
#include "core/geometry/bvh.hpp"

namespace scree {

namespace {

bool overlap(const BvhNode& a, const BvhNode& b) {
  for (int i = 0; i < 3; ++i) {
    if (a.lower[i] > b.upper[i] || b.lower[i] > a.upper[i]) return false;
  }
  return true;
}

bool boxes_overlap(const TriangleMesh& mesh, std::int32_t s, std::int32_t t) {
  for (int i = 0; i < 3; ++i) {
    const auto [s_low, s_high] =
        std::minmax({mesh.corner(s, 0)[i], mesh.corner(s, 1)[i], mesh.corner(s, 2)[i]});
    const auto [t_low, t_high] =
        std::minmax({mesh.corner(t, 0)[i], mesh.corner(t, 1)[i], mesh.corner(t, 2)[i]});
    if (s_low > t_high || t_low > s_high) return false;
  }
  return true;
}

bool share_a_vertex(const Triangle& s, const Triangle& t) {
  return std::any_of(s.begin(), s.end(),
                     [&](std::int32_t v) { return std::find(t.begin(), t.end(), v) != t.end(); });
}

}  // namespace

std::vector<CrossingPair> find_crossing_pairs(const TriangleMesh& mesh) {
  const Bvh bvh = build_bvh(mesh);
  std::vector<CrossingPair> found;
  if (bvh.nodes.empty()) return found;
  const auto test = [&](std::int32_t s, std::int32_t t) {
    if (s > t) std::swap(s, t);
    if (share_a_vertex(mesh.triangles[static_cast<std::size_t>(s)],
                       mesh.triangles[static_cast<std::size_t>(t)]))
      return;
    if (!boxes_overlap(mesh, s, t)) return;
    const Vec3 a[3] = {mesh.corner(s, 0), mesh.corner(s, 1), mesh.corner(s, 2)};
    const Vec3 b[3] = {mesh.corner(t, 0), mesh.corner(t, 1), mesh.corner(t, 2)};
    if (triangle_distance(a, b).intersecting) found.push_back({s, t});
  };
  std::vector<std::pair<std::int32_t, std::int32_t>> stack{{0, 0}};
  while (!stack.empty()) {
    const auto [i, j] = stack.back();
    stack.pop_back();
    const BvhNode &a = bvh.nodes[static_cast<std::size_t>(i)], &b = bvh.nodes[static_cast<std::size_t>(j)];
    if (i != j && !overlap(a, b)) continue;
    const bool a_is_leaf = a.second_child < 0, b_is_leaf = b.second_child < 0;
    if (a_is_leaf && b_is_leaf) {
      for (std::int32_t m = a.first; m < a.first + a.count; ++m) {
        for (std::int32_t n = i == j ? m + 1 : b.first; n < b.first + b.count; ++n) {
          test(bvh.order[static_cast<std::size_t>(m)], bvh.order[static_cast<std::size_t>(n)]);
        }
      }
    } else if (i == j) {
      stack.insert(stack.end(), {{i + 1, i + 1}, {a.second_child, a.second_child}, {i + 1, a.second_child}});
    } else if (b_is_leaf) {
      stack.insert(stack.end(), {{i + 1, j}, {a.second_child, j}});
    } else {
      stack.insert(stack.end(), {{i, j + 1}, {i, b.second_child}});
    }
  }
  std::sort(found.begin(), found.end(), [](const CrossingPair& p, const CrossingPair& q) {
    return p.first != q.first ? p.first < q.first : p.second < q.second;
  });
  return found;
}

}  // namespace scree
