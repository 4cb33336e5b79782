// The single-precision descent of two eight-wide hierarchies: candidates for the exact distance. Internal to
// core/distance.
//
// Everything happens in A's frame, from the middle of A's tree. A filter may keep a pair too many, never lose one: every comparison allows for
// `allowance`, a bound on what rounding to single precision can do to any distance in this frame.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/distance/triangle_distance.hpp"
#include "core/geometry/bvh.hpp"

namespace scree {

struct TrianglePair;
struct Placement;

/// The placement of B's tree in the frame of A's in single precision, each from its own middle, and its error.
struct DescentFrame {
  float linear[3][3], absolute[3][3], translation[3];
  float allowance;  ///< [units of A's shape]
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
      : base(at_centre + static_cast<float>(growth) * frame.allowance), slope(static_cast<float>(growth * (1 + 0x1p-18))),
        centre{static_cast<float>(place.x), static_cast<float>(place.y), static_cast<float>(place.z)} {}
};

/// Two subtrees to visit: >= 0 a node, < 0 leaf ~code; with their boxes (lower, upper) in A's frame.
struct SubtreePair {
  std::int32_t a, b;
  float gap2;   ///< squared distance of the boxes
  float reach;  ///< the largest in B's box
  float box_a[6], box_b[6];
};

/// A leaf of B in A's frame, with its triangles' boxes and separating slabs: n . x in low..high holds the triangle
/// and everything within reach of its plane's triangle.
struct alignas(32) PlacedLeaf {
  float corner[9][kBvhWidth];
  float lower[3][kBvhWidth], upper[3][kBvhWidth];
  float normal[3][kBvhWidth], low[kBvhWidth], high[kBvhWidth];
  float reach[kBvhWidth], largest_reach;
};

/// Boxes of the children of a node of B in A's frame.
struct alignas(32) PlacedNode {
  float lower[3][kBvhWidth], upper[3][kBvhWidth];
  float reach[kBvhWidth];
};

struct DescentScratch {
  /// Leaves and nodes of B placed lately: the same one meets several of A.
  static constexpr std::int32_t kCacheSize = 32;
  std::array<std::int32_t, kCacheSize> cached, cached_nodes;
  std::array<PlacedLeaf, kCacheSize> cache;
  std::array<PlacedNode, kCacheSize> node_cache;
  std::vector<SubtreePair> pairs;
  std::vector<TrianglePair> candidates;
  /// Where asked for, the corners of each candidate in A's tree frame as well, eighteen rows of a batch at a time: those of
  /// candidate k are in column k % kBlock of block k / kBlock.
  static constexpr std::int64_t kBlock = 128, kStride = kBlock + kBatchPadding, kBlockSize = 18 * kStride;
  bool keep_corners = false;
  std::vector<float> corners;
  /// To be called when another tree, placement or larger reach begins.
  void forget_placed() {
    cached.fill(-1);
    cached_nodes.fill(-1);
  }
};

/// The two roots, taken as within any reach. Both trees must have triangles.
SubtreePair root_pair(const Bvh& a);

/// Appends to scratch.candidates every pair of triangles within reach below the pair of subtrees. Gives up and returns
/// false once there are more than `limit`.
bool collect_candidates(const Bvh& a, const Bvh& b, const DescentFrame& frame, const SubtreePair& root,
                        const DescentReach& reach, DescentScratch& scratch, std::size_t limit = ~std::size_t{0});

/// Goes on where the last call gave up, within a reach that is not larger and the same everywhere.
bool collect_more_candidates(const Bvh& a, const Bvh& b, const DescentFrame& frame, float reach, DescentScratch& scratch,
                             std::size_t limit);

/// One step of it: two leaves give candidates, anything else gives smaller pairs within reach, in scratch.pairs.
void open_subtrees(const Bvh& a, const Bvh& b, const DescentFrame& frame, const SubtreePair& pair, const DescentReach& reach,
                   DescentScratch& scratch);

}  // namespace scree
