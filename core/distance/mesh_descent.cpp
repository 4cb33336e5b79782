// Eight boxes or eight triangles against one, in single precision, for every SIMD target (see mesh_descent.hpp).
//
// The file must be compiled for the baseline instruction set: never with -march=native.
#include "core/distance/mesh_descent.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/distance/mesh_descent.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace scree::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// eight floats as one vector, or as several where vectors are shorter
using Tag8 = hn::CappedTag<float, kBvhWidth>;
using Vec8 = hn::Vec<Tag8>;
constexpr std::size_t kLanes = hn::MaxLanes(Tag8());

HWY_INLINE Vec8 load(const float* from) { return hn::LoadU(Tag8(), from); }
HWY_INLINE Vec8 all(float x) { return hn::Set(Tag8(), x); }
HWY_INLINE std::uint32_t bits_of(hn::Mask<Tag8> mask) {
  std::uint8_t bits[8] = {};
  hn::StoreMaskBits(Tag8(), mask, bits);
  return bits[0];
}
HWY_INLINE Vec8 dot(Vec8 ax, Vec8 ay, Vec8 az, Vec8 bx, Vec8 by, Vec8 bz) {
  return hn::MulAdd(az, bz, hn::MulAdd(ay, by, hn::Mul(ax, bx)));
}

/// One box where it lies: coordinate c of its corners at [kStride * c].
template <int kStride>
struct BoxAt {
  const float *lower_corner, *upper_corner;
  HWY_INLINE float lower(int c) const { return lower_corner[kStride * c]; }
  HWY_INLINE float upper(int c) const { return upper_corner[kStride * c]; }
};
/// One of eight boxes.
using Column = BoxAt<kBvhWidth>;
HWY_INLINE Column column_of(const float lower[3][kBvhWidth], const float upper[3][kBvhWidth], std::size_t k) {
  return {lower[0] + k, upper[0] + k};
}

/// Squared distances of eight boxes (component by component) from one.
template <class Box>
HWY_INLINE Vec8 gaps_squared(const float lower[3][kBvhWidth], const float upper[3][kBvhWidth], std::size_t part, const Box& box) {
  Vec8 sum = hn::Zero(Tag8());
  for (int c = 0; c < 3; ++c) {
    const Vec8 below = hn::Sub(load(lower[c] + part), all(box.upper(c))), above = hn::Sub(all(box.lower(c)), load(upper[c] + part));
    const Vec8 gap = hn::Max(hn::Max(below, above), hn::Zero(Tag8()));
    sum = hn::MulAdd(gap, gap, sum);
  }
  return sum;
}

/// Which of the eight boxes lie within reach of the one, the same for all or each its own; their squared distances.
template <class Box, class ReachOf>
HWY_INLINE std::uint32_t boxes_within(const float lower[3][kBvhWidth], const float upper[3][kBvhWidth], const Box& box,
                                      const ReachOf& reach_of, float gap2[kBvhWidth]) {
  std::uint32_t bits = 0;
  for (std::size_t part = 0; part < kBvhWidth; part += kLanes) {
    const Vec8 gap = gaps_squared(lower, upper, part, box), reach = reach_of(part);
    hn::StoreU(gap, Tag8(), gap2 + part);
    bits |= bits_of(hn::Le(gap, hn::Mul(reach, reach))) << part;
  }
  return bits;
}
template <class Box>
HWY_INLINE std::uint32_t near_boxes(const float lower[3][kBvhWidth], const float upper[3][kBvhWidth], const Box& box, float reach,
                                    float gap2[kBvhWidth]) {
  return boxes_within(
      lower, upper, box, [reach](std::size_t) { return all(reach); }, gap2);
}
template <class Box>
HWY_INLINE std::uint32_t near_boxes(const float lower[3][kBvhWidth], const float upper[3][kBvhWidth], const Box& box,
                                    const float reach[kBvhWidth], float gap2[kBvhWidth]) {
  return boxes_within(
      lower, upper, box, [reach](std::size_t part) { return load(reach + part); }, gap2);
}

/// The largest reach in each of eight boxes of B, where there is a slope.
HWY_INLINE void reaches(const float lower[3][kBvhWidth], const float upper[3][kBvhWidth], const DescentReach& reach, float out[kBvhWidth]) {
  if (!(reach.slope > 0)) return;
  for (std::size_t part = 0; part < kBvhWidth; part += kLanes) {
    // to the farthest corner
    Vec8 sum = hn::Zero(Tag8());
    for (int c = 0; c < 3; ++c) {
      const Vec8 far = hn::Max(hn::Sub(load(upper[c] + part), all(reach.centre[c])), hn::Sub(all(reach.centre[c]), load(lower[c] + part)));
      sum = hn::MulAdd(far, far, sum);
    }
    hn::StoreU(hn::MulAdd(all(reach.slope), hn::Sqrt(sum), all(reach.base)), Tag8(), out + part);
  }
}
/// Eight boxes of B, and what they were placed with, against one of A.
template <class Placed>
HWY_INLINE std::uint32_t near_placed(const Placed& placed, const float lower[3][kBvhWidth], const float upper[3][kBvhWidth],
                                     const Column& box, const DescentReach& reach, float gap2[kBvhWidth]) {
  if (!(reach.slope > 0)) return near_boxes(lower, upper, box, reach.base, gap2);
  return near_boxes(lower, upper, box, placed.reach, gap2);
}

void place_boxes(const BvhNode& node, const SinglePlacement& frame, const DescentReach& reach, PlacedNode& out) {
  const Vec8 half_of = all(0.5f);
  for (std::size_t part = 0; part < kBvhWidth; part += kLanes) {
    Vec8 centre[3], half[3];
    for (int c = 0; c < 3; ++c) {
      const Vec8 l = load(node.lower[c] + part), u = load(node.upper[c] + part);
      centre[c] = hn::Mul(half_of, hn::Add(l, u));
      half[c] = hn::Mul(half_of, hn::Sub(u, l));
    }
    for (int c = 0; c < 3; ++c) {
      const Vec8 x = hn::Add(all(frame.translation[c]), dot(all(frame.linear[c][0]), all(frame.linear[c][1]), all(frame.linear[c][2]),
                                                            centre[0], centre[1], centre[2]));
      const Vec8 e = dot(all(frame.absolute[c][0]), all(frame.absolute[c][1]), all(frame.absolute[c][2]), half[0], half[1], half[2]);
      hn::StoreU(hn::Sub(x, e), Tag8(), out.lower[c] + part);
      hn::StoreU(hn::Add(x, e), Tag8(), out.upper[c] + part);
    }
  }
  reaches(out.lower, out.upper, reach, out.reach);
}

/// Boxes and slabs of eight triangles. Any direction separates soundly, so the rounding of n itself does not matter; one
/// too short to trust gets an endless slab.
HWY_INLINE void bound_leaf(const float corner[9][kBvhWidth], LeafBounds& out) {
  constexpr float kShortestNormal2 = 1e-30f, kEndless = 3e38f;
  for (std::size_t part = 0; part < kBvhWidth; part += kLanes) {
    const auto at = [&](int k) { return load(corner[k] + part); };
    for (int c = 0; c < 3; ++c) {
      hn::StoreU(hn::Min(hn::Min(at(c), at(3 + c)), at(6 + c)), Tag8(), out.lower[c] + part);
      hn::StoreU(hn::Max(hn::Max(at(c), at(3 + c)), at(6 + c)), Tag8(), out.upper[c] + part);
    }
    const Vec8 e1x = hn::Sub(at(3), at(0)), e1y = hn::Sub(at(4), at(1)), e1z = hn::Sub(at(5), at(2));
    const Vec8 e2x = hn::Sub(at(6), at(0)), e2y = hn::Sub(at(7), at(1)), e2z = hn::Sub(at(8), at(2));
    const Vec8 n0 = hn::MulSub(e1y, e2z, hn::Mul(e1z, e2y));
    const Vec8 n1 = hn::MulSub(e1z, e2x, hn::Mul(e1x, e2z));
    const Vec8 n2 = hn::MulSub(e1x, e2y, hn::Mul(e1y, e2x));
    const Vec8 h0 = dot(n0, n1, n2, at(0), at(1), at(2)), h1 = dot(n0, n1, n2, at(3), at(4), at(5)),
               h2 = dot(n0, n1, n2, at(6), at(7), at(8));
    const Vec8 nn = dot(n0, n1, n2, n0, n1, n2);
    const hn::Mask<Tag8> trusted = hn::Gt(nn, all(kShortestNormal2));
    hn::StoreU(n0, Tag8(), out.normal[0] + part);
    hn::StoreU(n1, Tag8(), out.normal[1] + part);
    hn::StoreU(n2, Tag8(), out.normal[2] + part);
    hn::StoreU(hn::IfThenElse(trusted, hn::Min(hn::Min(h0, h1), h2), all(-kEndless)), Tag8(), out.low + part);
    hn::StoreU(hn::IfThenElse(trusted, hn::Max(hn::Max(h0, h1), h2), all(kEndless)), Tag8(), out.high + part);
    hn::StoreU(hn::IfThenElseZero(trusted, hn::Sqrt(nn)), Tag8(), out.normal_length + part);
  }
}

void place_leaf(const BvhLeaf& leaf, const DescentFrame& frame, const DescentReach& reach, PlacedLeaf& out) {
  for (std::size_t part = 0; part < kBvhWidth; part += kLanes)
    for (int v = 0; v < 3; ++v)
      for (int c = 0; c < 3; ++c) {
        const Vec8 x = dot(all(frame.linear[c][0]), all(frame.linear[c][1]), all(frame.linear[c][2]), load(leaf.corner[3 * v] + part),
                           load(leaf.corner[3 * v + 1] + part), load(leaf.corner[3 * v + 2] + part));
        hn::StoreU(hn::Add(all(frame.translation[c]), x), Tag8(), out.corner[3 * v + c] + part);
      }
  bound_leaf(out.corner, out.bounds);
  for (int c = 0; c < 3; ++c) {
    Vec8 lower = load(out.bounds.lower[c]), upper = load(out.bounds.upper[c]);
    for (std::size_t part = kLanes; part < kBvhWidth; part += kLanes) {
      lower = hn::Min(lower, load(out.bounds.lower[c] + part));
      upper = hn::Max(upper, load(out.bounds.upper[c] + part));
    }
    out.lower[c] = hn::GetLane(hn::MinOfLanes(Tag8(), lower));
    out.upper[c] = hn::GetLane(hn::MaxOfLanes(Tag8(), upper));
  }
  reaches(out.bounds.lower, out.bounds.upper, reach, out.reach);
}

/// Three corners of eight triangles against eight slabs, widened: bits of those that lie on one side.
HWY_INLINE std::uint32_t outside_slabs(const Vec8 h[3], Vec8 low, Vec8 high, Vec8 wider) {
  const Vec8 least = hn::Min(hn::Min(h[0], h[1]), h[2]), most = hn::Max(hn::Max(h[0], h[1]), h[2]);
  return bits_of(hn::Or(hn::Gt(least, hn::Add(high, wider)), hn::Lt(most, hn::Sub(low, wider))));
}

/// The corners of the next candidates, triangles of A (bits of `hits`) with triangle j of B. Whole vectors are written: what
/// does not fit is overwritten later or lies in the padding of a row.
HWY_INLINE void keep_corners(const BvhLeaf& a, std::uint32_t hits, const PlacedLeaf& b, std::size_t j, DescentScratch& scratch) {
  const auto first = static_cast<std::int64_t>(scratch.candidates.size()), end = first + std::popcount(hits);
  const std::int64_t size = (end - 1) / DescentScratch::kBlock * DescentScratch::kBlockSize + DescentScratch::kBlockSize;
  if (static_cast<std::int64_t>(scratch.corners.size()) < size) scratch.corners.resize(static_cast<std::size_t>(size));
  const auto store = [&](float* column) {
    for (std::size_t part = 0; part < kBvhWidth; part += kLanes) {
      const std::uint32_t here = hits >> part & ((1u << kLanes) - 1u);
      const std::uint8_t bytes[8] = {static_cast<std::uint8_t>(here)};
      for (int c = 0; c < 9; ++c) {
        hn::StoreU(hn::CompressBits(load(a.corner[c] + part), bytes), Tag8(), column + c * DescentScratch::kStride);
        hn::StoreU(all(b.corner[c][j]), Tag8(), column + (9 + c) * DescentScratch::kStride);
      }
      column += std::popcount(here);
    }
  };
  static_assert(DescentScratch::kStride - DescentScratch::kBlock >= kBvhWidth);
  const std::int64_t block = first / DescentScratch::kBlock;
  float* column = scratch.corners.data() + block * DescentScratch::kBlockSize + first % DescentScratch::kBlock;
  store(column);
  // past the end of the block: again, as much before the beginning of the next one's rows
  if ((end - 1) / DescentScratch::kBlock > block) store(column + DescentScratch::kBlockSize - DescentScratch::kBlock);
}

HWY_INLINE std::uint32_t first_bits(std::int32_t count) { return (1u << count) - 1u; }

HWY_INLINE PlacedLeaf& placed_leaf(const Bvh& b, std::int32_t leaf, const DescentFrame& frame, const DescentReach& reach,
                                   DescentScratch& scratch) {
  const auto [placed, is_new] = scratch.placed_leaves.place_of(leaf);
  if (is_new) place_leaf(b.leaves[static_cast<std::size_t>(leaf)], frame, reach, placed);
  return placed;
}

HWY_INLINE PlacedNode& placed_node(const Bvh& b, std::int32_t node, const DescentFrame& frame, const DescentReach& reach,
                                   DescentScratch& scratch) {
  const auto [placed, is_new] = scratch.placed_nodes.place_of(node);
  if (is_new) place_boxes(b.nodes[static_cast<std::size_t>(node)], frame, reach, placed);
  return placed;
}

/// The other way round.
HWY_INLINE PlacedNode& turned_node(const Bvh& a, std::int32_t node, const DescentFrame& frame, DescentScratch& scratch) {
  const auto [turned, is_new] = scratch.turned_nodes.place_of(node);
  if (is_new) place_boxes(a.nodes[static_cast<std::size_t>(node)], frame.back, DescentReach(0), turned);
  return turned;
}
/// A's corners are off there by up to twice the roundoffs that the reach allows for, counted as those of the frame.
HWY_INLINE float turned_reach(const DescentFrame& frame, float reach) { return (reach + 2 * frame.allowance) * frame.back_scale; }

void meet_leaves(const Bvh& a, const Bvh& b, const DescentFrame& frame, std::int32_t leaf_a, std::int32_t leaf_b, const Column& box_a,
                 const DescentReach& reach, DescentScratch& scratch) {
  const BvhLeaf& la = a.leaves[static_cast<std::size_t>(leaf_a)];
  const BvhLeaf& lb = b.leaves[static_cast<std::size_t>(leaf_b)];
  const PlacedLeaf& placed = placed_leaf(b, leaf_b, frame, reach, scratch);
  const LeafBounds& of_b = placed.bounds;
  float gap2[kBvhWidth];
  std::uint32_t rows = near_placed(placed, of_b.lower, of_b.upper, box_a, reach, gap2) & first_bits(lb.count);
  if (rows == 0) return;

  const auto [of_a, is_new] = scratch.own_leaves.place_of(leaf_a);
  if (is_new) bound_leaf(la.corner, of_a);
  for (; rows != 0; rows &= rows - 1) {
    const auto j = static_cast<std::size_t>(std::countr_zero(rows));
    const float reach_here = reach.slope > 0 ? placed.reach[j] : reach.base;
    std::uint32_t hits = near_boxes(of_a.lower, of_a.upper, column_of(of_b.lower, of_b.upper, j), reach_here, gap2) & first_bits(la.count);
    if (hits == 0) continue;
    // separated by the plane of one or of the other
    std::uint32_t apart = 0;
    for (std::size_t part = 0; part < kBvhWidth; part += kLanes) {
      Vec8 h[3];
      for (std::size_t v = 0; v < 3; ++v)
        h[v] = dot(load(of_a.normal[0] + part), load(of_a.normal[1] + part), load(of_a.normal[2] + part), all(placed.corner[3 * v][j]),
                   all(placed.corner[3 * v + 1][j]), all(placed.corner[3 * v + 2][j]));
      std::uint32_t bits =
          outside_slabs(h, load(of_a.low + part), load(of_a.high + part), hn::Mul(all(reach_here), load(of_a.normal_length + part)));
      for (std::size_t v = 0; v < 3; ++v)
        h[v] = dot(all(of_b.normal[0][j]), all(of_b.normal[1][j]), all(of_b.normal[2][j]), load(la.corner[3 * v] + part),
                   load(la.corner[3 * v + 1] + part), load(la.corner[3 * v + 2] + part));
      bits |= outside_slabs(h, all(of_b.low[j]), all(of_b.high[j]), all(reach_here * of_b.normal_length[j]));
      apart |= bits << part;
    }
    hits &= ~apart;
    if (hits == 0) continue;
    if (scratch.keep_corners) keep_corners(la, hits, placed, j, scratch);
    for (; hits != 0; hits &= hits - 1) scratch.candidates.push_back({la.triangle[std::countr_zero(hits)], lb.triangle[j]});
  }
}

/// The box of A's subtree.
HWY_INLINE Column box_of_a(const Bvh& a, std::int32_t slot, const DescentScratch& scratch) {
  if (slot < 0) return column_of(scratch.root_lower, scratch.root_upper, 0);
  const BvhNode& parent = a.nodes[static_cast<std::size_t>(slot / kBvhWidth)];
  return column_of(parent.lower, parent.upper, static_cast<std::size_t>(slot % kBvhWidth));
}
HWY_INLINE BoxAt<1> box_of(const PlacedLeaf& leaf) { return {leaf.lower, leaf.upper}; }

/// Calls visit for each pair of children within reach: by their boxes in A's frame and, where both are nodes, in B's, since a
/// box that is turned is larger than what it holds.
template <class Visit>
HWY_INLINE void open_pair(const Bvh& a, const Bvh& b, const DescentFrame& frame, const SubtreePair& pair, const DescentReach& reach,
                          DescentScratch& scratch, const Visit& visit) {
  float gap2[kBvhWidth];
  const auto open_a = [&](std::int32_t child_b, const auto& box_b, float reach_here, std::uint32_t mask) {
    const BvhNode& node = a.nodes[static_cast<std::size_t>(pair.a)];
    std::uint32_t hits = near_boxes(node.lower, node.upper, box_b, reach_here, gap2) & first_bits(node.count) & mask;
    for (; hits != 0; hits &= hits - 1) {
      const int i = std::countr_zero(hits);
      visit(SubtreePair{node.child[i], child_b, pair.a * kBvhWidth + i, gap2[i], reach_here});
    }
  };
  if (pair.b < 0) {
    open_a(pair.b, box_of(placed_leaf(b, ~pair.b, frame, reach, scratch)), pair.reach, ~0u);
    return;
  }
  const BvhNode& node = b.nodes[static_cast<std::size_t>(pair.b)];
  const PlacedNode& placed = placed_node(b, pair.b, frame, reach, scratch);
  std::uint32_t rows =
      near_placed(placed, placed.lower, placed.upper, box_of_a(a, pair.slot_a, scratch), reach, gap2) & first_bits(node.count);
  if (pair.a < 0) {
    for (; rows != 0; rows &= rows - 1) {
      const int j = std::countr_zero(rows);
      visit(SubtreePair{pair.a, node.child[j], pair.slot_a, gap2[j], reach.slope > 0 ? placed.reach[j] : reach.base});
    }
    return;
  }
  for (; rows != 0; rows &= rows - 1) {
    const auto j = static_cast<std::size_t>(std::countr_zero(rows));
    const float reach_here = reach.slope > 0 ? placed.reach[j] : reach.base;
    const PlacedNode& turned = turned_node(a, pair.a, frame, scratch);
    float turned_gap2[kBvhWidth];
    const std::uint32_t mask =
        near_boxes(turned.lower, turned.upper, column_of(node.lower, node.upper, j), turned_reach(frame, reach_here), turned_gap2);
    if (node.child[j] < 0) {
      open_a(node.child[j], box_of(placed_leaf(b, ~node.child[j], frame, reach, scratch)), reach_here, mask);
    } else {
      open_a(node.child[j], column_of(placed.lower, placed.upper, j), reach_here, mask);
    }
  }
}

HWY_NOINLINE void open_one(const Bvh& a, const Bvh& b, const DescentFrame& frame, const SubtreePair& pair, const DescentReach& reach,
                           DescentScratch& scratch) {
  if (pair.a < 0 && pair.b < 0) {
    meet_leaves(a, b, frame, ~pair.a, ~pair.b, box_of_a(a, pair.slot_a, scratch), reach, scratch);
    return;
  }
  open_pair(a, b, frame, pair, reach, scratch, [&](const SubtreePair& next) { scratch.pairs.push_back(next); });
}

/// Below all pairs in scratch.pairs.
HWY_NOINLINE bool open_all(const Bvh& a, const Bvh& b, const DescentFrame& frame, const DescentReach& reach, DescentScratch& scratch,
                           std::size_t limit) {
  while (!scratch.pairs.empty()) {
    const SubtreePair pair = scratch.pairs.back();
    scratch.pairs.pop_back();
    open_pair(a, b, frame, pair, reach, scratch, [&](const SubtreePair& next) {
      if (next.a < 0 && next.b < 0) {
        meet_leaves(a, b, frame, ~next.a, ~next.b, box_of_a(a, next.slot_a, scratch), reach, scratch);
      } else {
        scratch.pairs.push_back(next);
      }
    });
    if (scratch.candidates.size() > limit) return false;
  }
  return true;
}

/// Offers eight boxes against one: pair_of(k, gap2) is the pair of lane k.
template <class Box, class PairOf>
HWY_INLINE void offer_boxes(const float lower[3][kBvhWidth], const float upper[3][kBvhWidth], std::int32_t count, const Box& box,
                            NearestSubtrees& nearest, const PairOf& pair_of) {
  // boxes overlap at the top of the trees: there the middles tell more than the gaps
  constexpr float kMiddleShare = 0.03f;
  float gap2[kBvhWidth], key[kBvhWidth];
  std::uint32_t hits = 0;
  for (std::size_t part = 0; part < kBvhWidth; part += kLanes) {
    Vec8 between = hn::Zero(Tag8());
    for (int c = 0; c < 3; ++c) {
      const Vec8 twice = hn::Sub(hn::Add(load(lower[c] + part), load(upper[c] + part)), all(box.lower(c) + box.upper(c)));
      between = hn::MulAdd(twice, twice, between);
    }
    const Vec8 gap = gaps_squared(lower, upper, part, box), all_of = hn::MulAdd(all(0.25f * kMiddleShare), between, gap);
    hn::StoreU(gap, Tag8(), gap2 + part);
    hn::StoreU(all_of, Tag8(), key + part);
    hits |= bits_of(hn::Lt(all_of, all(nearest.worst()))) << part;
  }
  for (hits &= first_bits(count); hits != 0; hits &= hits - 1) {
    const int k = std::countr_zero(hits);
    if (key[k] < nearest.worst()) nearest.offer(key[k], pair_of(k, gap2[k]));
  }
}

HWY_NOINLINE void offer_pair(const Bvh& a, const Bvh& b, const DescentFrame& frame, const SubtreePair& pair, DescentScratch& scratch,
                             NearestSubtrees& nearest) {
  const auto offer_a = [&](std::int32_t child_b, const auto& box_b) {
    const BvhNode& node = a.nodes[static_cast<std::size_t>(pair.a)];
    offer_boxes(node.lower, node.upper, node.count, box_b, nearest, [&](int i, float gap2) {
      return SubtreePair{node.child[i], child_b, pair.a * kBvhWidth + i, gap2, 0};
    });
  };
  if (pair.b < 0) {
    offer_a(pair.b, box_of(placed_leaf(b, ~pair.b, frame, DescentReach(0), scratch)));
    return;
  }
  const BvhNode& node = b.nodes[static_cast<std::size_t>(pair.b)];
  const PlacedNode& placed = placed_node(b, pair.b, frame, DescentReach(0), scratch);
  if (pair.a < 0) {
    offer_boxes(placed.lower, placed.upper, node.count, box_of_a(a, pair.slot_a, scratch), nearest, [&](int j, float gap2) {
      return SubtreePair{pair.a, node.child[j], pair.slot_a, gap2, 0};
    });
    return;
  }
  for (std::int32_t j = 0; j < node.count; ++j) offer_a(node.child[j], column_of(placed.lower, placed.upper, static_cast<std::size_t>(j)));
}

HWY_NOINLINE float nearest_corners_of(const Bvh& a, const Bvh& b, const DescentFrame& frame, const SubtreePair& leaves,
                                      DescentScratch& scratch) {
  const BvhLeaf& la = a.leaves[static_cast<std::size_t>(~leaves.a)];
  const PlacedLeaf& placed = placed_leaf(b, ~leaves.b, frame, DescentReach(0), scratch);
  Vec8 least = all(3e38f);
  // a slot without a triangle repeats the first one
  for (std::size_t part = 0; part < kBvhWidth; part += kLanes)
    for (std::size_t j = 0; j < kBvhWidth; ++j)
      for (std::size_t v = 0; v < 9; v += 3) {
        const Vec8 x = all(placed.corner[v][j]), y = all(placed.corner[v + 1][j]), z = all(placed.corner[v + 2][j]);
        for (std::size_t u = 0; u < 9; u += 3) {
          const Vec8 dx = hn::Sub(load(la.corner[u] + part), x), dy = hn::Sub(load(la.corner[u + 1] + part), y),
                     dz = hn::Sub(load(la.corner[u + 2] + part), z);
          least = hn::Min(least, dot(dx, dy, dz, dx, dy, dz));
        }
      }
  float lanes[kBvhWidth];
  hn::StoreU(least, Tag8(), lanes);
  return std::sqrt(*std::min_element(lanes, lanes + kLanes));
}

}  // namespace scree::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace scree {
namespace {
HWY_EXPORT(open_one);
HWY_EXPORT(open_all);
HWY_EXPORT(offer_pair);
HWY_EXPORT(nearest_corners_of);

/// Bound on the error of a distance between two points of the frame: each coordinate of B is off by at most 10
/// roundoffs (2^-24) of the largest coordinate, each of A by 1, a projection on a normal by 6 more. Counted: 45.
constexpr double kAllowanceRoundoffs = 64;
/// Squares of larger lengths would leave single precision.
constexpr double kLargestReach = 1e18;
}  // namespace

DescentFrame make_descent_frame(const Bvh& a, const Bvh& b, const Placement& b_in_a) {
  DescentFrame frame;
  double size = static_cast<double>(a.size);
  const Vec3 place = b_in_a.scale * (b_in_a.rotation * b.middle) + b_in_a.translation, translation = place - a.middle;
  double lost = 0;  // by the difference of two places far from A's origin
  const Vec3 back = (-1 / b_in_a.scale) * transpose_times(b_in_a.rotation, translation);
  frame.back_scale = static_cast<float>((1 + 0x1p-20) / b_in_a.scale);
  for (int i = 0; i < 3; ++i) {
    double coordinate = std::abs(translation[i]);
    frame.back.translation[i] = static_cast<float>(back[i]);
    for (int j = 0; j < 3; ++j) {
      const double m = b_in_a.scale * b_in_a.rotation[i][j];
      frame.linear[i][j] = static_cast<float>(m);
      frame.absolute[i][j] = std::abs(frame.linear[i][j]);
      frame.back.linear[j][i] = static_cast<float>(b_in_a.rotation[i][j] / b_in_a.scale);
      frame.back.absolute[j][i] = std::abs(frame.back.linear[j][i]);
      coordinate += std::abs(m) * static_cast<double>(b.size);
    }
    frame.translation[i] = static_cast<float>(translation[i]);
    size = std::max(size, coordinate);
    lost = std::max({lost, std::abs(b_in_a.translation[i]), std::abs(a.middle[i]), b_in_a.scale * length(b.middle)});
  }
  frame.allowance = static_cast<float>(kAllowanceRoundoffs * (0x1p-24 * size + 0x1p-53 * lost));
  return frame;
}

float filter_reach(const DescentFrame& frame, double reach) {
  return static_cast<float>(std::min(reach, kLargestReach) * (1 + 0x1p-20)) + frame.allowance;
}

SubtreePair root_pair(const Bvh& a, DescentScratch& scratch) {
  const BvhNode& root = a.nodes[0];
  for (int c = 0; c < 3; ++c) {
    scratch.root_lower[c][0] = *std::min_element(root.lower[c], root.lower[c] + root.count);
    scratch.root_upper[c][0] = *std::max_element(root.upper[c], root.upper[c] + root.count);
  }
  return {0, 0, -1, 0, 0};  // its children get a reach
}

bool collect_candidates(const Bvh& a, const Bvh& b, const DescentFrame& frame, const DescentReach& reach, DescentScratch& scratch,
                        std::size_t limit) {
  scratch.pairs.assign(1, root_pair(a, scratch));
  return HWY_DYNAMIC_DISPATCH(open_all)(a, b, frame, reach, scratch, limit);
}

bool collect_more_candidates(const Bvh& a, const Bvh& b, const DescentFrame& frame, float reach, DescentScratch& scratch,
                             std::size_t limit) {
  std::erase_if(scratch.pairs, [&](const SubtreePair& pair) { return pair.gap2 > reach * reach; });
  for (SubtreePair& pair : scratch.pairs) pair.reach = std::min(pair.reach, reach);
  return HWY_DYNAMIC_DISPATCH(open_all)(a, b, frame, reach, scratch, limit);
}

void open_subtrees(const Bvh& a, const Bvh& b, const DescentFrame& frame, const SubtreePair& pair, const DescentReach& reach,
                   DescentScratch& scratch) {
  HWY_DYNAMIC_DISPATCH(open_one)(a, b, frame, pair, reach, scratch);
}

void offer_children(const Bvh& a, const Bvh& b, const DescentFrame& frame, const SubtreePair& pair, DescentScratch& scratch,
                    NearestSubtrees& nearest) {
  HWY_DYNAMIC_DISPATCH(offer_pair)(a, b, frame, pair, scratch, nearest);
}

float nearest_corners(const Bvh& a, const Bvh& b, const DescentFrame& frame, const SubtreePair& leaves, DescentScratch& scratch) {
  return HWY_DYNAMIC_DISPATCH(nearest_corners_of)(a, b, frame, leaves, scratch);
}

}  // namespace scree
#endif
