#include "core/distance/mesh_distance.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/error.hpp"
#include "core/distance/mesh_descent.hpp"

namespace scree {

struct MeshDistanceScratch {
  static constexpr std::int64_t kBatchPairs = 128;
  DescentScratch descent;
  // search with a shrinking bound: pairs of subtrees, and a heap of them with the nearest on top
  struct Waiting {
    float gap2;
    std::int32_t index;
    bool operator<(const Waiting& other) const { return gap2 > other.gap2; }
  };
  std::vector<SubtreePair> subtrees;
  std::vector<Waiting> heap;
  // triangles on their way to the exact kernel
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

constexpr std::int64_t kBatchPairs = MeshDistanceScratch::kBatchPairs;

/// The exact stage: distances in double precision of candidates, a batch at a time.
class ExactStage {
 public:
  ExactStage(const MeshView& a, const MeshView& b, const Placement& placement, MeshDistanceScratch& scratch)
      : a_(*a.mesh), b_(*b.mesh), translation_(placement.translation), s_(scratch) {
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) linear_[i][j] = placement.scale * placement.rotation[i][j];
    s_.batch_count = 0;
  }

  /// Calls found(pair, distance) for each candidate, in some order, and empties the list.
  template <class Found>
  void solve_candidates(const Found& found) {
    for (const TrianglePair& pair : s_.descent.candidates) {
      if (s_.batch_count == kBatchPairs) flush(found);
      add(pair);
    }
    if (s_.batch_count > 0) flush(found);
    s_.descent.candidates.clear();
  }

 private:
  void add(const TrianglePair& pair) {
    // candidates come row by row, so the placed triangle of b often serves again
    if (pair.b != placed_triangle_) {
      for (int k = 0; k < 3; ++k) placed_[k] = linear_ * b_.corner(pair.b, k) + translation_;
      placed_triangle_ = pair.b;
    }
    double* value = s_.batch.data() + s_.batch_count;
    for (int k = 0; k < 3; ++k) {
      const Vec3& corner = a_.corner(pair.a, k);
      value[(3 * k) * kBatchPairs] = corner.x;
      value[(3 * k + 1) * kBatchPairs] = corner.y;
      value[(3 * k + 2) * kBatchPairs] = corner.z;
      value[(9 + 3 * k) * kBatchPairs] = placed_[k].x;
      value[(10 + 3 * k) * kBatchPairs] = placed_[k].y;
      value[(11 + 3 * k) * kBatchPairs] = placed_[k].z;
    }
    s_.batch_pair[static_cast<std::size_t>(s_.batch_count++)] = pair;
  }

  template <class Found>
  void flush(const Found& found) {
    const auto count = static_cast<std::size_t>(s_.batch_count);
    triangle_distances(PairBatch<double>{s_.batch.data(), kBatchPairs, s_.batch_count}, s_.distance.data());
    for (std::size_t i = 0; i < count; ++i) found(s_.batch_pair[i], s_.distance[i]);
    s_.batch_count = 0;
  }

  const TriangleMesh &a_, &b_;
  Mat3 linear_;
  Vec3 translation_;
  MeshDistanceScratch& s_;
  std::int32_t placed_triangle_ = -1;
  Vec3 placed_[3];
};

}  // namespace

bool triangle_pairs_within(const MeshView& a, const MeshView& b, const Placement& b_in_a, double reach,
                           MeshDistanceScratch& s, std::vector<TrianglePair>& pairs) {
  pairs.clear();
  const WideBvh &tree_a = a.bvh->wide, &tree_b = b.bvh->wide;
  if (tree_a.nodes.empty() || tree_b.nodes.empty()) return false;
  const DescentFrame frame = make_descent_frame(tree_a, tree_b, b_in_a);
  s.descent.forget_leaves();
  s.descent.candidates.clear();
  collect_candidates(tree_a, tree_b, frame, root_pair(tree_a), filter_reach(frame, reach), s.descent);
  bool intersecting = false;
  ExactStage(a, b, b_in_a, s).solve_candidates([&](const TrianglePair& pair, double distance) {
    if (distance == 0) intersecting = true;
    if (distance < reach || distance == 0) pairs.push_back(pair);
  });
  std::sort(pairs.begin(), pairs.end(), [](const TrianglePair& p, const TrianglePair& q) {
    return p.a != q.a ? p.a < q.a : p.b < q.b;
  });
  return intersecting;
}

double mesh_distance(const MeshView& a, const MeshView& b, const Placement& b_in_a, double upper_bound,
                     MeshDistanceScratch& s) {
  const WideBvh &tree_a = a.bvh->wide, &tree_b = b.bvh->wide;
  if (tree_a.nodes.empty() || tree_b.nodes.empty()) return upper_bound;
  const DescentFrame frame = make_descent_frame(tree_a, tree_b, b_in_a);
  ExactStage exact(a, b, b_in_a, s);
  s.descent.forget_leaves();
  s.descent.candidates.clear();
  s.subtrees.assign(1, root_pair(tree_a));
  s.heap.assign(1, {0, 0});
  double best = upper_bound;
  // nearest pair of subtrees first; done when the nearest is farther than the best distance found
  while (!s.heap.empty() && best > 0) {
    const float reach = filter_reach(frame, best);
    const MeshDistanceScratch::Waiting nearest = s.heap.front();
    if (nearest.gap2 > reach * reach) break;
    std::pop_heap(s.heap.begin(), s.heap.end());
    s.heap.pop_back();
    s.descent.pairs.clear();
    open_subtrees(tree_a, tree_b, frame, s.subtrees[static_cast<std::size_t>(nearest.index)], reach, s.descent);
    for (const SubtreePair& pair : s.descent.pairs) {
      s.heap.push_back({pair.gap2, static_cast<std::int32_t>(s.subtrees.size())});
      s.subtrees.push_back(pair);
      std::push_heap(s.heap.begin(), s.heap.end());
    }
    exact.solve_candidates([&](const TrianglePair&, double distance) { best = std::min(best, distance); });
  }
  return best;
}

namespace {

// the binary tree, for one point

struct NodeBox {
  double lower[3], upper[3];
};

NodeBox box_of(const BvhNode& node) {
  return {{node.lower[0], node.lower[1], node.lower[2]}, {node.upper[0], node.upper[1], node.upper[2]}};
}

double gap_squared(const NodeBox& a, const NodeBox& b) {
  double sum = 0;
  for (int c = 0; c < 3; ++c) {
    const double gap = std::max({a.lower[c] - b.upper[c], b.lower[c] - a.upper[c], 0.0});
    sum += gap * gap;
  }
  return sum;
}

}  // namespace

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
    if (node.second_child >= 0) {
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
