// Eight boxes or eight triangles against one, in single precision, for every SIMD target (see mesh_descent.hpp).
//
// The file must be compiled for the baseline instruction set: never with -march=native.
#include "core/distance/mesh_descent.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "core/distance/mesh_distance.hpp"

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

/// Squared distances of eight boxes (component by component) from one.
HWY_INLINE Vec8 gaps_squared(const float lower[3][kBvhWidth], const float upper[3][kBvhWidth], std::size_t part,
                             const float box[6]) {
  Vec8 sum = hn::Zero(Tag8());
  for (int c = 0; c < 3; ++c) {
    const Vec8 below = hn::Sub(load(lower[c] + part), all(box[3 + c])), above = hn::Sub(all(box[c]), load(upper[c] + part));
    const Vec8 gap = hn::Max(hn::Max(below, above), hn::Zero(Tag8()));
    sum = hn::MulAdd(gap, gap, sum);
  }
  return sum;
}

/// Which of the eight boxes lie within reach of the one, the same for all or each its own; their squared distances.
template <class ReachOf>
HWY_INLINE std::uint32_t boxes_within(const float lower[3][kBvhWidth], const float upper[3][kBvhWidth], const float box[6],
                                      const ReachOf& reach_of, float gap2[kBvhWidth]) {
  std::uint32_t bits = 0;
  for (std::size_t part = 0; part < kBvhWidth; part += kLanes) {
    const Vec8 gap = gaps_squared(lower, upper, part, box), reach = reach_of(part);
    hn::StoreU(gap, Tag8(), gap2 + part);
    bits |= bits_of(hn::Le(gap, hn::Mul(reach, reach))) << part;
  }
  return bits;
}
HWY_INLINE std::uint32_t near_boxes(const float lower[3][kBvhWidth], const float upper[3][kBvhWidth], const float box[6],
                                    float reach, float gap2[kBvhWidth]) {
  return boxes_within(lower, upper, box, [reach](std::size_t) { return all(reach); }, gap2);
}
HWY_INLINE std::uint32_t near_boxes(const float lower[3][kBvhWidth], const float upper[3][kBvhWidth], const float box[6],
                                    const float reach[kBvhWidth], float gap2[kBvhWidth]) {
  return boxes_within(lower, upper, box, [reach](std::size_t part) { return load(reach + part); }, gap2);
}

/// The largest reach in each of eight boxes of B.
HWY_INLINE void reaches(const float lower[3][kBvhWidth], const float upper[3][kBvhWidth], const DescentReach& reach, float out[kBvhWidth]) {
  for (std::size_t part = 0; part < kBvhWidth; part += kLanes) {
    Vec8 result = all(reach.base);
    if (reach.slope > 0) {
      // to the farthest corner
      Vec8 sum = hn::Zero(Tag8());
      for (int c = 0; c < 3; ++c) {
        const Vec8 far = hn::Max(hn::Sub(load(upper[c] + part), all(reach.centre[c])), hn::Sub(all(reach.centre[c]), load(lower[c] + part)));
        sum = hn::MulAdd(far, far, sum);
      }
      result = hn::MulAdd(all(reach.slope), hn::Sqrt(sum), result);
    }
    hn::StoreU(result, Tag8(), out + part);
  }
}

void place_boxes(const BvhNode& node, const DescentFrame& frame, const DescentReach& reach, PlacedNode& out) {
  const Vec8 half_of = all(0.5f);
  for (std::size_t part = 0; part < kBvhWidth; part += kLanes) {
    Vec8 centre[3], half[3];
    for (int c = 0; c < 3; ++c) {
      const Vec8 l = load(node.lower[c] + part), u = load(node.upper[c] + part);
      centre[c] = hn::Mul(half_of, hn::Add(l, u));
      half[c] = hn::Mul(half_of, hn::Sub(u, l));
    }
    for (int c = 0; c < 3; ++c) {
      const Vec8 x = hn::Add(all(frame.translation[c]), dot(all(frame.linear[c][0]), all(frame.linear[c][1]), all(frame.linear[c][2]), centre[0], centre[1], centre[2]));
      const Vec8 e = dot(all(frame.absolute[c][0]), all(frame.absolute[c][1]), all(frame.absolute[c][2]), half[0], half[1], half[2]);
      hn::StoreU(hn::Sub(x, e), Tag8(), out.lower[c] + part);
      hn::StoreU(hn::Add(x, e), Tag8(), out.upper[c] + part);
    }
  }
  reaches(out.lower, out.upper, reach, out.reach);
}

/// Normals of eight triangles and the slabs n . x in low..high that hold each one and its surroundings up to reach.
/// Any direction separates soundly, so the rounding of n itself does not matter; one too short to trust gets an
/// endless slab.
template <class ReachOf>
HWY_INLINE void make_slabs(const float corner[9][kBvhWidth], const ReachOf& reach_of, float normal[3][kBvhWidth], float* low, float* high) {
  constexpr float kShortestNormal2 = 1e-30f, kEndless = 3e38f;
  for (std::size_t part = 0; part < kBvhWidth; part += kLanes) {
    const auto at = [&](int k) { return load(corner[k] + part); };
    const Vec8 e1x = hn::Sub(at(3), at(0)), e1y = hn::Sub(at(4), at(1)), e1z = hn::Sub(at(5), at(2));
    const Vec8 e2x = hn::Sub(at(6), at(0)), e2y = hn::Sub(at(7), at(1)), e2z = hn::Sub(at(8), at(2));
    const Vec8 n0 = hn::MulSub(e1y, e2z, hn::Mul(e1z, e2y));
    const Vec8 n1 = hn::MulSub(e1z, e2x, hn::Mul(e1x, e2z));
    const Vec8 n2 = hn::MulSub(e1x, e2y, hn::Mul(e1y, e2x));
    const Vec8 h0 = dot(n0, n1, n2, at(0), at(1), at(2)), h1 = dot(n0, n1, n2, at(3), at(4), at(5)),
               h2 = dot(n0, n1, n2, at(6), at(7), at(8));
    const Vec8 nn = dot(n0, n1, n2, n0, n1, n2), width = hn::Mul(reach_of(part), hn::Sqrt(nn));
    const hn::Mask<Tag8> trusted = hn::Gt(nn, all(kShortestNormal2));
    hn::StoreU(n0, Tag8(), normal[0] + part);
    hn::StoreU(n1, Tag8(), normal[1] + part);
    hn::StoreU(n2, Tag8(), normal[2] + part);
    hn::StoreU(hn::IfThenElse(trusted, hn::Sub(hn::Min(hn::Min(h0, h1), h2), width), all(-kEndless)), Tag8(), low + part);
    hn::StoreU(hn::IfThenElse(trusted, hn::Add(hn::Max(hn::Max(h0, h1), h2), width), all(kEndless)), Tag8(), high + part);
  }
}

void place_leaf(const BvhLeaf& leaf, const DescentFrame& frame, const DescentReach& reach, PlacedLeaf& out) {
  for (std::size_t part = 0; part < kBvhWidth; part += kLanes) {
    for (int v = 0; v < 3; ++v)
      for (int c = 0; c < 3; ++c) {
        const Vec8 x = dot(all(frame.linear[c][0]), all(frame.linear[c][1]), all(frame.linear[c][2]), load(leaf.corner[3 * v] + part),
                           load(leaf.corner[3 * v + 1] + part), load(leaf.corner[3 * v + 2] + part));
        hn::StoreU(hn::Add(all(frame.translation[c]), x), Tag8(), out.corner[3 * v + c] + part);
      }
    for (int c = 0; c < 3; ++c) {
      const Vec8 x0 = load(out.corner[c] + part), x1 = load(out.corner[3 + c] + part), x2 = load(out.corner[6 + c] + part);
      hn::StoreU(hn::Min(hn::Min(x0, x1), x2), Tag8(), out.lower[c] + part);
      hn::StoreU(hn::Max(hn::Max(x0, x1), x2), Tag8(), out.upper[c] + part);
    }
  }
  reaches(out.lower, out.upper, reach, out.reach);
  out.largest_reach = out.reach[0];
  for (const float r : out.reach) out.largest_reach = std::max(out.largest_reach, r);
  make_slabs(out.corner, [&](std::size_t part) { return load(out.reach + part); }, out.normal, out.low, out.high);
}

/// Three corners of eight triangles against eight slabs: bits of those that lie on one side.
HWY_INLINE std::uint32_t outside_slabs(const Vec8 h[3], Vec8 low, Vec8 high) {
  const Vec8 least = hn::Min(hn::Min(h[0], h[1]), h[2]), most = hn::Max(hn::Max(h[0], h[1]), h[2]);
  return bits_of(hn::Or(hn::Gt(least, high), hn::Lt(most, low)));
}

/// The corners of the next candidate.
HWY_INLINE void keep_corners(const BvhLeaf& a, std::size_t i, const PlacedLeaf& b, std::size_t j, DescentScratch& scratch) {
  const auto k = static_cast<std::int64_t>(scratch.candidates.size());
  const std::int64_t block = k / DescentScratch::kBlock * DescentScratch::kBlockSize;
  if (static_cast<std::int64_t>(scratch.corners.size()) < block + DescentScratch::kBlockSize)
    scratch.corners.resize(static_cast<std::size_t>(block + DescentScratch::kBlockSize));
  float* column = scratch.corners.data() + block + k % DescentScratch::kBlock;
  for (int c = 0; c < 9; ++c) {
    column[c * DescentScratch::kStride] = a.corner[c][i];
    column[(9 + c) * DescentScratch::kStride] = b.corner[c][j];
  }
}

HWY_INLINE std::uint32_t first_bits(std::int32_t count) { return (1u << count) - 1u; }

void meet_leaves(const Bvh& a, const Bvh& b, const DescentFrame& frame, std::int32_t leaf_a, std::int32_t leaf_b,
                 const float box_a[6], const DescentReach& reach, DescentScratch& scratch) {
  const BvhLeaf& la = a.leaves[static_cast<std::size_t>(leaf_a)];
  const BvhLeaf& lb = b.leaves[static_cast<std::size_t>(leaf_b)];
  const auto slot = static_cast<std::size_t>(leaf_b % DescentScratch::kCacheSize);
  PlacedLeaf& placed = scratch.cache[slot];
  if (scratch.cached[slot] != leaf_b) {
    place_leaf(lb, frame, reach, placed);
    scratch.cached[slot] = leaf_b;
  }
  float gap2[kBvhWidth];
  std::uint32_t rows = near_boxes(placed.lower, placed.upper, box_a, placed.reach, gap2) & first_bits(lb.count);
  if (rows == 0) return;

  float lower[3][kBvhWidth], upper[3][kBvhWidth];
  for (std::size_t part = 0; part < kBvhWidth; part += kLanes)
    for (int c = 0; c < 3; ++c) {
      const Vec8 x0 = load(la.corner[c] + part), x1 = load(la.corner[3 + c] + part), x2 = load(la.corner[6 + c] + part);
      hn::StoreU(hn::Min(hn::Min(x0, x1), x2), Tag8(), lower[c] + part);
      hn::StoreU(hn::Max(hn::Max(x0, x1), x2), Tag8(), upper[c] + part);
    }
  alignas(32) float normal[3][kBvhWidth], low[kBvhWidth], high[kBvhWidth];
  bool has_slabs = false;
  for (; rows != 0; rows &= rows - 1) {
    const auto j = static_cast<std::size_t>(std::countr_zero(rows));
    const float box[6] = {placed.lower[0][j], placed.lower[1][j], placed.lower[2][j],
                          placed.upper[0][j], placed.upper[1][j], placed.upper[2][j]};
    std::uint32_t hits = near_boxes(lower, upper, box, placed.reach[j], gap2) & first_bits(la.count);
    if (hits == 0) continue;
    if (!has_slabs) {
      make_slabs(la.corner, [&](std::size_t) { return all(placed.largest_reach); }, normal, low, high);
      has_slabs = true;
    }
    // separated by the plane of one or of the other
    std::uint32_t apart = 0;
    for (std::size_t part = 0; part < kBvhWidth; part += kLanes) {
      Vec8 h[3];
      for (std::size_t v = 0; v < 3; ++v)
        h[v] = dot(load(normal[0] + part), load(normal[1] + part), load(normal[2] + part), all(placed.corner[3 * v][j]), all(placed.corner[3 * v + 1][j]), all(placed.corner[3 * v + 2][j]));
      std::uint32_t bits = outside_slabs(h, load(low + part), load(high + part));
      for (std::size_t v = 0; v < 3; ++v)
        h[v] = dot(all(placed.normal[0][j]), all(placed.normal[1][j]), all(placed.normal[2][j]), load(la.corner[3 * v] + part),
                   load(la.corner[3 * v + 1] + part), load(la.corner[3 * v + 2] + part));
      bits |= outside_slabs(h, all(placed.low[j]), all(placed.high[j]));
      apart |= bits << part;
    }
    for (hits &= ~apart; hits != 0; hits &= hits - 1) {
      const auto i = static_cast<std::size_t>(std::countr_zero(hits));
      if (scratch.keep_corners) keep_corners(la, i, placed, j, scratch);
      scratch.candidates.push_back({la.triangle[i], lb.triangle[j]});
    }
  }
}

HWY_INLINE void copy_box(const float lower[3][kBvhWidth], const float upper[3][kBvhWidth], std::size_t k, float box[6]) {
  for (std::size_t c = 0; c < 3; ++c) {
    box[c] = lower[c][k];
    box[3 + c] = upper[c][k];
  }
}

/// Calls visit for each pair of children within reach.
template <class Visit>
HWY_INLINE void open_pair(const Bvh& a, const Bvh& b, const DescentFrame& frame, const SubtreePair& pair, const DescentReach& reach,
                          DescentScratch& scratch, const Visit& visit) {
  float gap2[kBvhWidth];
  SubtreePair next = pair;
  const auto open_a = [&](const SubtreePair& with) {
    const BvhNode& node = a.nodes[static_cast<std::size_t>(pair.a)];
    std::uint32_t hits = near_boxes(node.lower, node.upper, with.box_b, with.reach, gap2) & first_bits(node.count);
    for (; hits != 0; hits &= hits - 1) {
      const auto i = static_cast<std::size_t>(std::countr_zero(hits));
      next.a = node.child[i];
      next.gap2 = gap2[i];
      copy_box(node.lower, node.upper, i, next.box_a);
      visit(next);
    }
  };
  if (pair.b < 0) {
    open_a(pair);
    return;
  }
  const BvhNode& node = b.nodes[static_cast<std::size_t>(pair.b)];
  const auto slot = static_cast<std::size_t>(pair.b % DescentScratch::kCacheSize);
  PlacedNode& placed = scratch.node_cache[slot];
  if (scratch.cached_nodes[slot] != pair.b) {
    place_boxes(node, frame, reach, placed);
    scratch.cached_nodes[slot] = pair.b;
  }
  std::uint32_t rows = near_boxes(placed.lower, placed.upper, pair.box_a, placed.reach, gap2) & first_bits(node.count);
  for (; rows != 0; rows &= rows - 1) {
    const auto j = static_cast<std::size_t>(std::countr_zero(rows));
    next.b = node.child[j];
    next.reach = placed.reach[j];
    copy_box(placed.lower, placed.upper, j, next.box_b);
    if (pair.a >= 0) {
      open_a(next);
    } else {
      next.gap2 = gap2[j];
      visit(next);
    }
  }
}

HWY_NOINLINE void open_one(const Bvh& a, const Bvh& b, const DescentFrame& frame, const SubtreePair& pair, const DescentReach& reach,
                           DescentScratch& scratch) {
  if (pair.a < 0 && pair.b < 0) {
    meet_leaves(a, b, frame, ~pair.a, ~pair.b, pair.box_a, reach, scratch);
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
        meet_leaves(a, b, frame, ~next.a, ~next.b, next.box_a, reach, scratch);
      } else {
        scratch.pairs.push_back(next);
      }
    });
    if (scratch.candidates.size() > limit) return false;
  }
  return true;
}

}  // namespace scree::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace scree {
namespace {
HWY_EXPORT(open_one);
HWY_EXPORT(open_all);

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
  for (int i = 0; i < 3; ++i) {
    double coordinate = std::abs(translation[i]);
    for (int j = 0; j < 3; ++j) {
      const double m = b_in_a.scale * b_in_a.rotation[i][j];
      frame.linear[i][j] = static_cast<float>(m);
      frame.absolute[i][j] = std::abs(frame.linear[i][j]);
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

SubtreePair root_pair(const Bvh& a) {
  // B's box is the whole space: the first step places the boxes of its children
  SubtreePair root{0, 0, 0, 0, {}, {}};  // its children get a reach
  const float far = 1e18f;
  for (int c = 0; c < 3; ++c) {
    root.box_a[c] = a.nodes[0].lower[c][0];
    root.box_a[3 + c] = a.nodes[0].upper[c][0];
    for (std::int32_t k = 1; k < a.nodes[0].count; ++k) {
      root.box_a[c] = std::min(root.box_a[c], a.nodes[0].lower[c][k]);
      root.box_a[3 + c] = std::max(root.box_a[3 + c], a.nodes[0].upper[c][k]);
    }
    root.box_b[c] = -far;
    root.box_b[3 + c] = far;
  }
  return root;
}

bool collect_candidates(const Bvh& a, const Bvh& b, const DescentFrame& frame, const SubtreePair& root,
                        const DescentReach& reach, DescentScratch& scratch, std::size_t limit) {
  scratch.pairs.assign(1, root);
  return HWY_DYNAMIC_DISPATCH(open_all)(a, b, frame, reach, scratch, limit);
}

bool collect_more_candidates(const Bvh& a, const Bvh& b, const DescentFrame& frame, float reach, DescentScratch& scratch,
                             std::size_t limit) {
  scratch.forget_placed();  // with the old reach
  std::erase_if(scratch.pairs, [&](const SubtreePair& pair) { return pair.gap2 > reach * reach; });
  for (SubtreePair& pair : scratch.pairs) pair.reach = std::min(pair.reach, reach);
  return HWY_DYNAMIC_DISPATCH(open_all)(a, b, frame, reach, scratch, limit);
}

void open_subtrees(const Bvh& a, const Bvh& b, const DescentFrame& frame, const SubtreePair& pair, const DescentReach& reach,
                   DescentScratch& scratch) {
  HWY_DYNAMIC_DISPATCH(open_one)(a, b, frame, pair, reach, scratch);
}

}  // namespace scree
#endif
