// The single-precision descent of two eight-wide hierarchies: candidates for the exact distance. Internal to
// core/distance.
//
// Everything happens in A's frame, from the middle of A's tree. A filter may keep a pair too many, never lose one: every comparison allows
// for `allowance`, a bound on what rounding to single precision can do to any distance in this frame.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/distance/placement.hpp"
#include "core/distance/triangle_distance.hpp"
#include "core/geometry/bvh.hpp"

namespace scree {

/// linear x + translation, and the absolute values of linear.
struct SinglePlacement {
  float linear[3][3], absolute[3][3], translation[3];
};

/// The placement of B's tree in the frame of A's in single precision, each from its own middle, and its error.
struct DescentFrame : SinglePlacement {
  float allowance;       ///< [units of A's shape]
  SinglePlacement back;  ///< of A's tree in the frame of B's
  float back_scale;      ///< a length in A's units in those of B
};
DescentFrame make_descent_frame(const Bvh& a, const Bvh& b, const Placement& b_in_a);

/// What a search for pairs within `reach` compares with, and the reach up to which single precision can square.
float filter_reach(const DescentFrame& frame, double reach);

/// How near a pair counts: at a point of B, base + slope * (its distance from a centre). All in A's tree frame, base a
/// filter_reach; without a slope the same everywhere.
struct DescentReach {
  float base, slope = 0, centre[3] = {};
  DescentReach(float everywhere) : base(everywhere) {}
  /// Rounding of the distances included.
  DescentReach(float at_centre, double growth, const Vec3& place, const DescentFrame& frame)
      : base(at_centre + static_cast<float>(growth) * frame.allowance),
        slope(static_cast<float>(growth * (1 + 0x1p-18))),
        centre{static_cast<float>(place.x), static_cast<float>(place.y), static_cast<float>(place.z)} {}
};

/// Two subtrees to visit: >= 0 a node, < 0 leaf ~code. Boxes are looked up where they are: copying them into every pair takes
/// longer than to compare them.
struct SubtreePair {
  std::int32_t a, b;
  std::int32_t slot_a;  ///< A's box is slot_a % kBvhWidth of node slot_a / kBvhWidth; -1: the root's
  float gap2;           ///< squared distance of the boxes
  float reach;          ///< the largest in B's box
};

/// What a leaf's triangles are compared by: their boxes and slabs, n . x in low..high, which hold them. All that is within
/// reach of a triangle lies in its slab widened by reach |n|.
struct alignas(32) LeafBounds {
  float lower[3][kBvhWidth], upper[3][kBvhWidth];
  float normal[3][kBvhWidth], low[kBvhWidth], high[kBvhWidth], normal_length[kBvhWidth];
};

/// A leaf of B in A's frame.
struct alignas(32) PlacedLeaf {
  LeafBounds bounds;
  float corner[9][kBvhWidth];
  float lower[3], upper[3];  ///< of all triangles: tighter than the box of the leaf, turned
  float reach[kBvhWidth];    ///< only where it differs from place to place
};

/// Boxes of the children of a node of B in A's frame, or the other way round.
struct alignas(32) PlacedNode {
  float lower[3][kBvhWidth], upper[3][kBvhWidth];
  float reach[kBvhWidth];  ///< only where it differs from place to place
};

/// What was made lately for leaves or nodes, by their index: each has one place, which it shares with others.
template <class T>
class RecentCache {
 public:
  /// The place of `index`, and whether it has to be filled, which is then taken as done.
  std::pair<T&, bool> place_of(std::int32_t index) {
    const auto slot = static_cast<std::size_t>(index % kSize);
    const bool is_new = std::exchange(index_[slot], index) != index;
    return {made_[slot], is_new};
  }
  void forget() { index_.fill(-1); }

 private:
  static constexpr std::int32_t kSize = 32;
  std::array<std::int32_t, kSize> index_;
  std::array<T, kSize> made_;
};

struct DescentScratch {
  /// Leaves and nodes of B placed lately, nodes of A in B's frame, and leaves of A: the same one meets several of the other body.
  RecentCache<PlacedLeaf> placed_leaves;
  RecentCache<PlacedNode> placed_nodes, turned_nodes;
  RecentCache<LeafBounds> own_leaves;
  float root_lower[3][kBvhWidth], root_upper[3][kBvhWidth];  ///< of A, in the first column
  std::vector<SubtreePair> pairs;
  std::vector<TrianglePair> candidates;
  /// Where asked for, the corners of each candidate in A's tree frame as well, eighteen rows of a batch at a time: those of
  /// candidate k are in column k % kBlock of block k / kBlock.
  static constexpr std::int64_t kBlock = 128, kStride = kBlock + kBatchPadding, kBlockSize = 18 * kStride;
  bool keep_corners = false;
  std::vector<float> corners;
  /// To be called when another tree, placement or reach begins. One that is the same everywhere may change in between.
  void forget_placed() {
    placed_leaves.forget();
    placed_nodes.forget();
    turned_nodes.forget();
    own_leaves.forget();
  }
};

/// found(pair, distance) for every candidate, in their order: distances in single precision, from the corners that were
/// asked for, each off by at most the frame's allowance.
template <class Found>
void for_each_single_distance(const DescentScratch& scratch, const Found& found) {
  alignas(64) std::array<float, DescentScratch::kBlock> distance;
  const auto count = static_cast<std::int64_t>(scratch.candidates.size());
  for (std::int64_t begin = 0; begin < count; begin += DescentScratch::kBlock) {
    const std::int64_t size = std::min(count - begin, DescentScratch::kBlock);
    const float* corners = scratch.corners.data() + begin / DescentScratch::kBlock * DescentScratch::kBlockSize;
    triangle_distances(PairBatch<float>{corners, DescentScratch::kStride, size}, distance.data());
    for (std::int64_t k = 0; k < size; ++k)
      found(scratch.candidates[static_cast<std::size_t>(begin + k)], distance[static_cast<std::size_t>(k)]);
  }
}

/// The two roots, taken as within any reach. Both trees must have triangles.
SubtreePair root_pair(const Bvh& a, DescentScratch& scratch);

/// Appends to scratch.candidates every pair of triangles within reach. Gives up and returns false once there are more than
/// `limit`.
bool collect_candidates(const Bvh& a, const Bvh& b, const DescentFrame& frame, const DescentReach& reach, DescentScratch& scratch,
                        std::size_t limit = ~std::size_t{0});

/// Goes on where the last call gave up, within a reach that is not larger and the same everywhere.
bool collect_more_candidates(const Bvh& a, const Bvh& b, const DescentFrame& frame, float reach, DescentScratch& scratch,
                             std::size_t limit);

/// One step of it: two leaves give candidates, anything else gives smaller pairs within reach, in scratch.pairs.
void open_subtrees(const Bvh& a, const Bvh& b, const DescentFrame& frame, const SubtreePair& pair, const DescentReach& reach,
                   DescentScratch& scratch);

/// The pairs of subtrees that look nearest so far, nearest first.
struct NearestSubtrees {
  static constexpr std::size_t kMax = 2;
  std::size_t count = 0;
  std::array<float, kMax> key;
  std::array<SubtreePair, kMax> pair;
  float worst() const { return count < kMax ? 3e38f : key[kMax - 1]; }
  /// With a key below the worst.
  void offer(float of_next, const SubtreePair& next) {
    std::size_t k = count < kMax ? count++ : kMax - 1;
    for (; k > 0 && key[k - 1] > of_next; --k) key[k] = key[k - 1], pair[k] = pair[k - 1];
    key[k] = of_next;
    pair[k] = next;
  }
};

/// Offers every pair of children of a pair of subtrees, not both leaves, by the gap and the middles of their boxes.
void offer_children(const Bvh& a, const Bvh& b, const DescentFrame& frame, const SubtreePair& pair, DescentScratch& scratch,
                    NearestSubtrees& nearest);

/// The smallest distance of two corners of a pair of leaves, in single precision.
float nearest_corners(const Bvh& a, const Bvh& b, const DescentFrame& frame, const SubtreePair& leaves, DescentScratch& scratch);

}  // namespace scree
