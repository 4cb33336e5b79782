#include "core/distance/mesh_distance.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>

#include "core/base/error.hpp"

namespace scree {
namespace {

constexpr std::int64_t kBatchPairs = 128;

/// Rounding of a box or a vertex moved into the other frame, per unit of the largest coordinate involved:
/// ten roundoffs would do. Boxes grow by it, so that none ever loses a triangle.
constexpr double kTransformRounding = 1e-14;

struct NodeBox {
  double lower[3], upper[3];
};

/// A pair of nodes to visit, with the box of the second one in the first one's frame.
struct NodePair {
  std::int32_t a, b;
  double gap2;  ///< squared distance of the boxes
  NodeBox box_b;
};

struct LeafPair {
  std::int32_t a, b;
};

struct PlacedTriangle {
  Vec3 corner[3];
  NodeBox box;
};
using PlacedLeaf = std::array<PlacedTriangle, kBvhLeafSize>;

}  // namespace

struct MeshDistanceScratch {
  std::vector<NodePair> stack;
  std::vector<LeafPair> leaf_pairs;
  PlacedLeaf leaf_a, leaf_b;
  std::int32_t count_a = 0, count_b = 0;
  std::int64_t batch_count = 0;
  std::array<TrianglePair, kBatchPairs> batch_pair;
  alignas(64) std::array<double, 18 * kBatchPairs> batch;
  alignas(64) std::array<double, kBatchPairs> distance;
};

void MeshDistanceScratchDeleter::operator()(MeshDistanceScratch* scratch) const { delete scratch; }
MeshDistanceScratchPtr make_mesh_distance_scratch() { return MeshDistanceScratchPtr(new MeshDistanceScratch()); }

Placement relative_placement(const Vec3& x_a, const Quat& q_a, double scale_a, const Vec3& x_b, const Quat& q_b,
                             double scale_b) {
  Placement p;
  p.rotation = matrix_of(conjugate(q_a) * q_b);
  p.translation = (1.0 / scale_a) * rotate_inverse(q_a, x_b - x_a);
  p.scale = scale_b / scale_a;
  return p;
}

namespace {

/// x_A = linear x_B + translation, and what it does to boxes.
struct Transform {
  Mat3 linear, absolute;
  Vec3 translation;
  double margin = 0;  ///< rounding of the transform

  Transform(const Placement& p, const Bvh& b) : translation(p.translation) {
    double largest = std::max({std::abs(p.translation.x), std::abs(p.translation.y), std::abs(p.translation.z)});
    double reach = 0;
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) {
        linear[i][j] = p.scale * p.rotation[i][j];
        absolute[i][j] = std::abs(linear[i][j]);
      }
      reach += std::max(std::abs(static_cast<double>(b.nodes[0].lower[i])), std::abs(static_cast<double>(b.nodes[0].upper[i])));
    }
    margin = kTransformRounding * (largest + p.scale * reach);
  }

  Vec3 apply(const Vec3& x) const { return linear * x + translation; }

  NodeBox box(const BvhNode& node) const {
    Vec3 centre, half;
    for (int c = 0; c < 3; ++c) {
      centre[c] = 0.5 * (static_cast<double>(node.lower[c]) + static_cast<double>(node.upper[c]));
      half[c] = 0.5 * (static_cast<double>(node.upper[c]) - static_cast<double>(node.lower[c]));
    }
    const Vec3 moved = apply(centre), size = absolute * half;
    NodeBox out;
    for (int c = 0; c < 3; ++c) {
      out.lower[c] = moved[c] - size[c] - margin;
      out.upper[c] = moved[c] + size[c] + margin;
    }
    return out;
  }
};

NodeBox box_of(const BvhNode& node) {
  return {{node.lower[0], node.lower[1], node.lower[2]}, {node.upper[0], node.upper[1], node.upper[2]}};
}

/// Squared distance of two boxes.
double gap_squared(const NodeBox& a, const NodeBox& b) {
  double sum = 0;
  for (int c = 0; c < 3; ++c) {
    const double gap = std::max({a.lower[c] - b.upper[c], b.lower[c] - a.upper[c], 0.0});
    sum += gap * gap;
  }
  return sum;
}

double size_of(const NodeBox& b) { return (b.upper[0] - b.lower[0]) + (b.upper[1] - b.lower[1]) + (b.upper[2] - b.lower[2]); }
bool is_leaf(const BvhNode& node) { return node.second_child < 0; }

void set_box(PlacedTriangle& t, double margin) {
  for (int c = 0; c < 3; ++c) {
    t.box.lower[c] = std::min({t.corner[0][c], t.corner[1][c], t.corner[2][c]}) - margin;
    t.box.upper[c] = std::max({t.corner[0][c], t.corner[1][c], t.corner[2][c]}) + margin;
  }
}

void load_leaf_a(const MeshView& a, const BvhNode& leaf, MeshDistanceScratch& s) {
  s.count_a = leaf.count;
  for (std::int32_t i = 0; i < leaf.count; ++i) {
    PlacedTriangle& t = s.leaf_a[static_cast<std::size_t>(i)];
    const std::int32_t triangle = a.bvh->order[static_cast<std::size_t>(leaf.first + i)];
    for (int k = 0; k < 3; ++k) t.corner[k] = a.mesh->corner(triangle, k);
    set_box(t, 0);
  }
}

void load_leaf_b(const MeshView& b, const BvhNode& leaf, const Transform& transform, MeshDistanceScratch& s) {
  s.count_b = leaf.count;
  for (std::int32_t i = 0; i < leaf.count; ++i) {
    PlacedTriangle& t = s.leaf_b[static_cast<std::size_t>(i)];
    const std::int32_t triangle = b.bvh->order[static_cast<std::size_t>(leaf.first + i)];
    for (int k = 0; k < 3; ++k) t.corner[k] = transform.apply(b.mesh->corner(triangle, k));
    set_box(t, transform.margin);
  }
}

void add_to_batch(MeshDistanceScratch& s, const PlacedTriangle& a, const PlacedTriangle& b, TrianglePair pair) {
  double* value = s.batch.data() + s.batch_count;
  for (int k = 0; k < 3; ++k)
    for (int c = 0; c < 3; ++c) {
      value[(3 * k + c) * kBatchPairs] = a.corner[k][c];
      value[(9 + 3 * k + c) * kBatchPairs] = b.corner[k][c];
    }
  s.batch_pair[static_cast<std::size_t>(s.batch_count++)] = pair;
}

/// Distances of what is in the batch; empties it.
std::span<const double> solve_batch(MeshDistanceScratch& s) {
  const std::int64_t count = s.batch_count;
  triangle_distances(PairBatch<double>{s.batch.data(), kBatchPairs, count}, s.distance.data());
  s.batch_count = 0;
  return {s.distance.data(), static_cast<std::size_t>(count)};
}

/// Children of a node pair, the larger node being opened; calls visit(NodePair) for each.
template <class Visit>
void open_pair(const NodePair& pair, const MeshView& a, const MeshView& b, const Transform& transform, const Visit& visit) {
  const BvhNode& node_a = a.bvh->nodes[static_cast<std::size_t>(pair.a)];
  const BvhNode& node_b = b.bvh->nodes[static_cast<std::size_t>(pair.b)];
  const bool open_a = !is_leaf(node_a) && (is_leaf(node_b) || size_of(box_of(node_a)) >= size_of(pair.box_b));
  for (int child = 0; child < 2; ++child) {
    NodePair next = pair;
    if (open_a) {
      next.a = child == 0 ? pair.a + 1 : node_a.second_child;
    } else {
      next.b = child == 0 ? pair.b + 1 : node_b.second_child;
      next.box_b = transform.box(b.bvh->nodes[static_cast<std::size_t>(next.b)]);
    }
    next.gap2 = gap_squared(box_of(a.bvh->nodes[static_cast<std::size_t>(next.a)]), next.box_b);
    visit(next);
  }
}

NodePair root_pair(const MeshView& a, const MeshView& b, const Transform& transform) {
  NodePair root{0, 0, 0, transform.box(b.bvh->nodes[0])};
  root.gap2 = gap_squared(box_of(a.bvh->nodes[0]), root.box_b);
  return root;
}

bool both_leaves(const NodePair& pair, const MeshView& a, const MeshView& b) {
  return is_leaf(a.bvh->nodes[static_cast<std::size_t>(pair.a)]) && is_leaf(b.bvh->nodes[static_cast<std::size_t>(pair.b)]);
}

}  // namespace

bool triangle_pairs_within(const MeshView& a, const MeshView& b, const Placement& b_in_a, double reach,
                           MeshDistanceScratch& s, std::vector<TrianglePair>& pairs) {
  pairs.clear();
  if (a.bvh->nodes.empty() || b.bvh->nodes.empty()) return false;
  const Transform transform(b_in_a, *b.bvh);
  const double reach2 = (1 + kTransformRounding) * reach * reach;

  // leaf pairs whose boxes are within reach
  s.leaf_pairs.clear();
  s.stack.clear();
  const auto visit = [&](const NodePair& pair) {
    if (pair.gap2 > reach2) return;
    if (both_leaves(pair, a, b)) {
      s.leaf_pairs.push_back({pair.a, pair.b});
    } else {
      s.stack.push_back(pair);
    }
  };
  visit(root_pair(a, b, transform));
  while (!s.stack.empty()) {
    const NodePair pair = s.stack.back();
    s.stack.pop_back();
    open_pair(pair, a, b, transform, visit);
  }

  // their triangles: box against box, then the exact distance, many at a time; each leaf of b is placed once
  std::sort(s.leaf_pairs.begin(), s.leaf_pairs.end(), [](const LeafPair& p, const LeafPair& q) {
    return p.b != q.b ? p.b < q.b : p.a < q.a;
  });
  bool intersecting = false;
  const auto flush = [&] {
    const std::span<const double> distance = solve_batch(s);
    for (std::size_t i = 0; i < distance.size(); ++i) {
      if (distance[i] == 0) intersecting = true;
      if (distance[i] < reach || distance[i] == 0) pairs.push_back(s.batch_pair[i]);
    }
  };
  std::int32_t placed = -1;
  s.batch_count = 0;
  for (const LeafPair& leaves : s.leaf_pairs) {
    const BvhNode& leaf_a = a.bvh->nodes[static_cast<std::size_t>(leaves.a)];
    const BvhNode& leaf_b = b.bvh->nodes[static_cast<std::size_t>(leaves.b)];
    if (leaves.b != placed) load_leaf_b(b, leaf_b, transform, s);
    placed = leaves.b;
    load_leaf_a(a, leaf_a, s);
    for (std::int32_t i = 0; i < s.count_a; ++i)
      for (std::int32_t j = 0; j < s.count_b; ++j) {
        const PlacedTriangle& ta = s.leaf_a[static_cast<std::size_t>(i)];
        const PlacedTriangle& tb = s.leaf_b[static_cast<std::size_t>(j)];
        if (gap_squared(ta.box, tb.box) > reach2) continue;
        if (s.batch_count == kBatchPairs) flush();
        add_to_batch(s, ta, tb, {a.bvh->order[static_cast<std::size_t>(leaf_a.first + i)],
                                 b.bvh->order[static_cast<std::size_t>(leaf_b.first + j)]});
      }
  }
  flush();
  std::sort(pairs.begin(), pairs.end(), [](const TrianglePair& p, const TrianglePair& q) {
    return p.a != q.a ? p.a < q.a : p.b < q.b;
  });
  return intersecting;
}

double mesh_distance(const MeshView& a, const MeshView& b, const Placement& b_in_a, double upper_bound,
                     MeshDistanceScratch& s) {
  if (a.bvh->nodes.empty() || b.bvh->nodes.empty()) return upper_bound;
  const Transform transform(b_in_a, *b.bvh);
  double best = upper_bound;
  s.batch_count = 0;
  s.stack.clear();
  s.stack.push_back(root_pair(a, b, transform));
  while (!s.stack.empty() && best > 0) {
    const NodePair pair = s.stack.back();
    s.stack.pop_back();
    if (pair.gap2 >= best * best) continue;
    if (both_leaves(pair, a, b)) {
      load_leaf_a(a, a.bvh->nodes[static_cast<std::size_t>(pair.a)], s);
      load_leaf_b(b, b.bvh->nodes[static_cast<std::size_t>(pair.b)], transform, s);
      for (std::int32_t i = 0; i < s.count_a; ++i)
        for (std::int32_t j = 0; j < s.count_b; ++j) {
          const PlacedTriangle& ta = s.leaf_a[static_cast<std::size_t>(i)];
          const PlacedTriangle& tb = s.leaf_b[static_cast<std::size_t>(j)];
          if (gap_squared(ta.box, tb.box) < best * best) add_to_batch(s, ta, tb, {i, j});
        }
      for (const double d : solve_batch(s)) best = std::min(best, d);
      continue;
    }
    // the nearer child is pushed last and visited first
    std::array<NodePair, 2> child;
    std::size_t count = 0;
    open_pair(pair, a, b, transform, [&](const NodePair& next) { child[count++] = next; });
    if (child[0].gap2 < child[1].gap2) std::swap(child[0], child[1]);
    for (const NodePair& next : child)
      if (next.gap2 < best * best) s.stack.push_back(next);
  }
  return best;
}

double point_mesh_distance(const MeshView& mesh, const Vec3& point, double upper_bound, Vec3& nearest,
                           std::int32_t& triangle) {
  struct Entry {
    std::int32_t node;
    double gap2;
  };
  triangle = -1;
  if (mesh.bvh->nodes.empty()) return upper_bound;
  const NodeBox here{{point.x, point.y, point.z}, {point.x, point.y, point.z}};
  const auto entry = [&](std::int32_t n) {
    return Entry{n, gap_squared(box_of(mesh.bvh->nodes[static_cast<std::size_t>(n)]), here)};
  };
  // a point is a triangle whose corners coincide: the same kernel, the same rounding
  alignas(64) double values[18 * kBatchPadding], distance[kBatchPadding];
  static_assert(kBvhLeafSize <= kBatchPadding);
  for (int k = 0; k < 9; ++k) {
    std::fill_n(values + k * kBatchPadding, kBatchPadding, 0.0);
    std::fill_n(values + (9 + k) * kBatchPadding, kBatchPadding, point[k % 3]);
  }
  std::array<Entry, 2 * kBvhMaxDepth> stack;
  std::size_t size = 0;
  stack[size++] = entry(0);
  double best = upper_bound;
  while (size > 0) {
    const Entry top = stack[--size];
    if (top.gap2 >= best * best) continue;
    const BvhNode& node = mesh.bvh->nodes[static_cast<std::size_t>(top.node)];
    if (!is_leaf(node)) {
      Entry near = entry(top.node + 1), far = entry(node.second_child);
      if (far.gap2 < near.gap2) std::swap(near, far);
      SCREE_ASSERT(size + 2 <= stack.size());
      stack[size++] = far;
      stack[size++] = near;
      continue;
    }
    for (std::int32_t i = 0; i < node.count; ++i) {
      const std::int32_t t = mesh.bvh->order[static_cast<std::size_t>(node.first + i)];
      for (int k = 0; k < 9; ++k) values[k * kBatchPadding + i] = mesh.mesh->corner(t, k / 3)[k % 3];
    }
    triangle_distances(PairBatch<double>{values, kBatchPadding, node.count}, distance);
    for (std::int32_t i = 0; i < node.count; ++i) {
      if (!(distance[i] < best)) continue;
      best = distance[i];
      triangle = mesh.bvh->order[static_cast<std::size_t>(node.first + i)];
    }
  }
  if (triangle >= 0) {
    const Vec3 face[3] = {mesh.mesh->corner(triangle, 0), mesh.mesh->corner(triangle, 1), mesh.mesh->corner(triangle, 2)};
    const Vec3 points[3] = {point, point, point};
    nearest = triangle_distance(face, points).point_a;
  }
  return best;
}

bool is_inside(const TriangleMesh& mesh, const Vec3& point) {
  // solid angle of each triangle: A. van Oosterom, J. Strackee, IEEE Trans. Biomed. Eng. 30 (1983) 125, eq. 8
  double angle = 0;
  for (std::int32_t t = 0; t < mesh.triangle_count(); ++t) {
    const Vec3 a = mesh.corner(t, 0) - point, b = mesh.corner(t, 1) - point, c = mesh.corner(t, 2) - point;
    const double la = length(a), lb = length(b), lc = length(c);
    const double volume = dot(a, cross(b, c));
    const double rest = la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb;
    angle += 2.0 * std::atan2(volume, rest);
  }
  constexpr double kSphere = 12.566370614359172;  // 4 pi
  return angle > 0.5 * kSphere;
}

}  // namespace scree
