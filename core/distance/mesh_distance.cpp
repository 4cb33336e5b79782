#include "core/distance/mesh_distance.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/base/error.hpp"
#include "core/distance/mesh_descent.hpp"
#include "core/distance/plain_distance.hpp"

namespace scree {

struct MeshDistanceScratch {
  static constexpr std::int64_t kBatchPairs = 128;
  DescentScratch descent;
  // of mesh_distance: pairs that may be nearest, and how near they can be at least
  struct Kept {
    TrianglePair pair;
    double least;
  };
  std::vector<Kept> kept;
  std::vector<TrianglePair> rivals;  // of reproducible_mesh_distance: pairs that may be nearest
  // triangles on their way to the exact kernel
  std::int64_t batch_count = 0;
  std::array<TrianglePair, kBatchPairs> batch_pair;
  alignas(64) std::array<double, 18 * kBatchPairs> batch;
  alignas(64) std::array<double, kBatchPairs> distance;
};

void MeshDistanceScratchDeleter::operator()(MeshDistanceScratch* scratch) const { delete scratch; }
MeshDistanceScratchPtr make_mesh_distance_scratch() { return MeshDistanceScratchPtr(new MeshDistanceScratch()); }

Placement relative_placement(const Vec3& x_a, const Quat& q_a, double scale_a, const Vec3& x_b, const Quat& q_b, double scale_b) {
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

namespace {

/// By a, then by b; one comparison without branches.
std::uint64_t order_of(const TrianglePair& pair) {
  return static_cast<std::uint64_t>(static_cast<std::uint32_t>(pair.a)) << 32 | static_cast<std::uint32_t>(pair.b);
}

}  // namespace

bool triangle_pairs_within(const MeshView& a, const MeshView& b, const Placement& b_in_a, double reach, MeshDistanceScratch& s,
                           std::vector<TrianglePair>& pairs) {
  pairs.clear();
  const Bvh &tree_a = *a.bvh, &tree_b = *b.bvh;
  if (tree_a.nodes.empty() || tree_b.nodes.empty()) return false;
  const DescentFrame frame = make_descent_frame(tree_a, tree_b, b_in_a);
  const double allowance = static_cast<double>(frame.allowance);
  DescentScratch& descent = s.descent;
  descent.forget_placed();
  descent.candidates.clear();
  descent.keep_corners = true;
  collect_candidates(tree_a, tree_b, frame, filter_reach(frame, reach), descent);
  descent.keep_corners = false;
  // single precision settles all but those whose distance is near the reach or near 0
  std::size_t doubtful = 0;
  for_each_single_distance(descent, [&](const TrianglePair& pair, float single) {
    const auto distance = static_cast<double>(single);
    if (distance - allowance >= reach) return;
    if (distance + allowance < reach && distance > allowance) {
      pairs.push_back(pair);
    } else {
      descent.candidates[doubtful++] = pair;  // one that has been read
    }
  });
  descent.candidates.resize(doubtful);
  bool intersecting = false;
  ExactStage(a, b, b_in_a, s).solve_candidates([&](const TrianglePair& pair, double distance) {
    if (distance == 0) intersecting = true;
    if (distance < reach || distance == 0) pairs.push_back(pair);
  });
  std::sort(pairs.begin(), pairs.end(), [](const TrianglePair& p, const TrianglePair& q) { return order_of(p) < order_of(q); });
  return intersecting;
}

bool meshes_intersect(const MeshView& a, const MeshView& b, const Placement& b_in_a, MeshDistanceScratch& s) {
  const Bvh &tree_a = *a.bvh, &tree_b = *b.bvh;
  if (tree_a.nodes.empty() || tree_b.nodes.empty()) return false;
  const DescentFrame frame = make_descent_frame(tree_a, tree_b, b_in_a);
  ExactStage exact(a, b, b_in_a, s);
  bool intersecting = false, all = false;
  // a few candidates often tell; then four times as many
  for (std::size_t limit = 32; !all && !intersecting; limit *= 4) {
    s.descent.forget_placed();
    s.descent.candidates.clear();
    all = collect_candidates(tree_a, tree_b, frame, filter_reach(frame, 0), s.descent, limit);
    exact.solve_candidates([&](const TrianglePair&, double distance) { intersecting = intersecting || distance == 0; });
  }
  return intersecting;
}

namespace {

/// Goes down both trees along the few pairs of subtrees that look nearest, and calls solve(pair) for the pairs of leaves that
/// it comes to.
template <class Solve>
void descend_to_leaves(const Bvh& a, const Bvh& b, const DescentFrame& frame, DescentScratch& scratch, const Solve& solve) {
  NearestSubtrees beam, next;
  beam.offer(0, root_pair(a, scratch));
  while (beam.count > 0) {
    next.count = 0;
    for (std::size_t k = 0; k < beam.count; ++k) {
      if (beam.pair[k].a < 0 && beam.pair[k].b < 0) {
        solve(beam.pair[k]);
      } else {
        offer_children(a, b, frame, beam.pair[k], scratch, next);
      }
    }
    std::swap(beam, next);
  }
}

/// The search of mesh_distance. Where `rivals` is not null, the pairs that may be nearest, rounding allowed for, are added to it.
double find_nearest(const MeshView& a, const MeshView& b, const Placement& b_in_a, double upper_bound, MeshDistanceScratch& s,
                    TrianglePair* nearest, std::vector<TrianglePair>* rivals) {
  const Bvh &tree_a = *a.bvh, &tree_b = *b.bvh;
  TrianglePair found{-1, -1};
  const TrianglePair start = nearest != nullptr ? *nearest : found;
  if (nearest != nullptr) *nearest = found;
  if (tree_a.nodes.empty() || tree_b.nodes.empty()) return upper_bound;
  const DescentFrame frame = make_descent_frame(tree_a, tree_b, b_in_a);
  const auto allowance = static_cast<double>(frame.allowance);
  ExactStage exact(a, b, b_in_a, s);
  double best = upper_bound;
  const auto take = [&](const TrianglePair& pair, double distance) {
    if (!(distance < best)) return;
    best = distance;
    found = pair;
  };
  // In single precision until the end: every distance is a bound from above, and only pairs that can be nearer than the
  // least of these, errors included, are kept for the exact stage. One that intersects, it seems, is decided at once.
  double bound = upper_bound;
  DescentScratch& descent = s.descent;
  s.kept.clear();
  const auto filter = [&] {
    for_each_single_distance(descent, [&](const TrianglePair& pair, float single) {
      const auto distance = static_cast<double>(single);
      if (distance - allowance > bound) return;
      bound = std::min(bound, distance + allowance);
      s.kept.push_back({pair, distance - allowance});
    });
    descent.candidates.clear();
  };
  const auto solve = [&] {
    if (rivals != nullptr) rivals->insert(rivals->end(), descent.candidates.begin(), descent.candidates.end());
    exact.solve_candidates(take);
    bound = std::min(bound, best);
  };
  const auto decide = [&] {
    for (const auto& [pair, least] : s.kept)
      if (least <= bound) descent.candidates.push_back(pair);
    s.kept.clear();
    solve();
  };
  descent.forget_placed();
  descent.candidates.clear();
  descent.keep_corners = true;
  // a bound: the pair that was nearest last time, or the nearest of a few pairs of leaves
  if (start.a >= 0 && start.a < a.mesh->triangle_count() && start.b >= 0 && start.b < b.mesh->triangle_count()) {
    descent.candidates.push_back(start);
    solve();
  } else {
    descend_to_leaves(tree_a, tree_b, frame, descent, [&](const SubtreePair& leaves) {
      bound = std::min(bound, static_cast<double>(nearest_corners(tree_a, tree_b, frame, leaves, descent)) + allowance);
      const float reach = filter_reach(frame, bound);
      if (leaves.gap2 <= reach * reach) open_subtrees(tree_a, tree_b, frame, leaves, reach, descent);
      filter();
    });
  }
  if (bound <= 2 * allowance) decide();
  // all that can be nearer; the reach shrinks on the way
  constexpr std::size_t kAtOnce = 16;
  if (best > 0) {
    s.kept.clear();
    bool all = collect_candidates(tree_a, tree_b, frame, filter_reach(frame, bound), descent, kAtOnce);
    for (filter(); !all; filter()) {
      if (bound <= 2 * allowance) decide();
      if (best == 0) break;
      all = collect_more_candidates(tree_a, tree_b, frame, filter_reach(frame, bound), descent, kAtOnce);
    }
    decide();
  }
  descent.keep_corners = false;
  if (nearest != nullptr) *nearest = found;
  return best;
}

}  // namespace

double mesh_distance(const MeshView& a, const MeshView& b, const Placement& b_in_a, double upper_bound, MeshDistanceScratch& s,
                     TrianglePair* nearest) {
  return find_nearest(a, b, b_in_a, upper_bound, s, nearest, nullptr);
}

double reproducible_mesh_distance(const MeshView& a, const MeshView& b, const Placement& b_in_a, double upper_bound, MeshDistanceScratch& s,
                                  TrianglePair& nearest) {
  s.rivals.clear();
  // whether triangles intersect is decided exactly, on every instruction set alike
  if (find_nearest(a, b, b_in_a, upper_bound, s, &nearest, &s.rivals) == 0) return 0;
  double least = upper_bound;
  for (const TrianglePair& pair : s.rivals) {
    Vec3 corners_a[3], corners_b[3];
    for (int k = 0; k < 3; ++k) {
      corners_a[k] = a.mesh->corner(pair.a, k);
      corners_b[k] = b_in_a.scale * (b_in_a.rotation * b.mesh->corner(pair.b, k)) + b_in_a.translation;
    }
    least = std::min(least, plain_triangle_distance(corners_a, corners_b));
  }
  return least;
}

namespace {

/// Goes down the tree to the leaves that may hold a triangle nearer to `point` than `best`, which visit(leaf) lowers.
template <class Visit>
void visit_near_leaves(const Bvh& tree, const Vec3& point, double& best, const Visit& visit) {
  struct Entry {
    double gap2;
    std::int32_t code;  // >= 0 node, < 0 leaf ~code
  };
  if (tree.nodes.empty()) return;
  const Vec3 here = point - tree.middle;
  // what the difference and its square can lose: a box must not seem farther than it is
  constexpr double kGapRounding = 0x1p-49;
  const double lost = kGapRounding * (std::abs(here.x) + std::abs(here.y) + std::abs(here.z) + static_cast<double>(tree.size));
  thread_local std::vector<Entry> stack;
  stack.assign(1, {0, 0});
  while (!stack.empty()) {
    const Entry top = stack.back();
    stack.pop_back();
    if (top.gap2 >= best * best) continue;
    if (top.code >= 0) {
      const BvhNode& node = tree.nodes[static_cast<std::size_t>(top.code)];
      const auto first = static_cast<std::ptrdiff_t>(stack.size());
      for (std::int32_t k = 0; k < node.count; ++k) {
        double sum = 0;
        for (int c = 0; c < 3; ++c) {
          const double gap =
              std::max({static_cast<double>(node.lower[c][k]) - here[c], here[c] - static_cast<double>(node.upper[c][k]), lost}) - lost;
          sum += gap * gap;
        }
        if (sum < best * best) stack.push_back({sum, node.child[k]});
      }
      std::sort(stack.begin() + first, stack.end(), [](const Entry& l, const Entry& r) { return l.gap2 > r.gap2; });  // the nearest is next
      continue;
    }
    visit(tree.leaves[static_cast<std::size_t>(~top.code)]);
  }
}

}  // namespace

double point_mesh_distance(const MeshView& mesh, const Vec3& point, double upper_bound, Vec3& nearest, std::int32_t& triangle) {
  triangle = -1;
  // a point is a triangle whose corners coincide: the same kernel, the same rounding
  alignas(64) double values[18 * kBatchPadding], distance[kBatchPadding];
  static_assert(kBvhWidth <= kBatchPadding);
  for (int k = 0; k < 9; ++k) {
    std::fill_n(values + k * kBatchPadding, kBatchPadding, 0.0);
    std::fill_n(values + (9 + k) * kBatchPadding, kBatchPadding, point[k % 3]);
  }
  double best = upper_bound;
  visit_near_leaves(*mesh.bvh, point, best, [&](const BvhLeaf& leaf) {
    for (std::int32_t i = 0; i < leaf.count; ++i)
      for (int k = 0; k < 9; ++k) values[k * kBatchPadding + i] = mesh.mesh->corner(leaf.triangle[i], k / 3)[k % 3];
    triangle_distances(PairBatch<double>{values, kBatchPadding, leaf.count}, distance);
    for (std::int32_t i = 0; i < leaf.count; ++i) {
      if (!(distance[i] < best)) continue;
      best = distance[i];
      triangle = leaf.triangle[i];
    }
  });
  if (triangle >= 0) {
    const Vec3 face[3] = {mesh.mesh->corner(triangle, 0), mesh.mesh->corner(triangle, 1), mesh.mesh->corner(triangle, 2)};
    const Vec3 points[3] = {point, point, point};
    nearest = triangle_distance(face, points).point_a;
  }
  return best;
}

double reproducible_point_distance(const MeshView& mesh, const Vec3& point, double upper_bound) {
  double best = upper_bound;
  visit_near_leaves(*mesh.bvh, point, best, [&](const BvhLeaf& leaf) {
    for (std::int32_t i = 0; i < leaf.count; ++i) {
      const std::int32_t t = leaf.triangle[i];
      const Vec3 foot = nearest_on_triangle(point, mesh.mesh->corner(t, 0), mesh.mesh->corner(t, 1), mesh.mesh->corner(t, 2)).point;
      best = std::min(best, length(point - foot));
    }
  });
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
