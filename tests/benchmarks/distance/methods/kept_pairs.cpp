// The list, and its loops in SIMD for every target (see mesh_descent.cpp).
//
// The file must be compiled for the baseline instruction set: never with -march=native.
#include "tests/benchmarks/distance/methods/kept_pairs.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <type_traits>

#include "core/distance/mesh_descent.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tests/benchmarks/distance/methods/kept_pairs.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace scree::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// Indices of the values that are at most `way`; returns how many. `found` has room for count.
/// Bit by bit: few are, and storing compressed vectors takes longer, on Zen 4 by far.
HWY_NOINLINE std::size_t find_expired(const float* expiry, std::size_t count, float way, std::int32_t* found) {
  const hn::ScalableTag<float> tag;
  const std::size_t lanes = hn::Lanes(tag);
  const auto limit = hn::Set(tag, way);
  std::size_t size = 0, k = 0;
  for (; k + lanes <= count; k += lanes) {
    std::uint8_t bytes[8] = {};
    hn::StoreMaskBits(tag, hn::Le(hn::LoadU(tag, expiry + k), limit), bytes);
    std::uint64_t bits;
    std::memcpy(&bits, bytes, sizeof(bits));
    for (; bits != 0; bits &= bits - 1) found[size++] = static_cast<std::int32_t>(k) + std::countr_zero(bits);
  }
  for (; k < count; ++k)
    if (expiry[k] <= way) found[size++] = static_cast<std::int32_t>(k);
  return size;
}

/// Moves the corners of B (rows 9 to 17 of a batch) into A's frame; in double precision rounded like linear * corner +
/// translation is elsewhere, so that a pair at the margin is judged alike.
template <class Real>
HWY_INLINE void place_corners(Real* rows, std::int64_t stride, std::int64_t count, const Real linear[3][3], const Real translation[3]) {
  const hn::ScalableTag<Real> tag;
  for (std::int64_t i = 0; i < count; i += static_cast<std::int64_t>(hn::Lanes(tag))) {
    for (int corner = 0; corner < 3; ++corner) {
      Real* at = rows + (9 + 3 * corner) * stride + i;
      const auto x = hn::LoadU(tag, at), y = hn::LoadU(tag, at + stride), z = hn::LoadU(tag, at + 2 * stride);
      for (int c = 0; c < 3; ++c) {
        const auto l0 = hn::Set(tag, linear[c][0]), l1 = hn::Set(tag, linear[c][1]), l2 = hn::Set(tag, linear[c][2]),
                   first = hn::Mul(l0, x);
        const auto turned =
            sizeof(Real) == 4 ? hn::MulAdd(l2, z, hn::MulAdd(l1, y, first)) : hn::Add(hn::Add(first, hn::Mul(l1, y)), hn::Mul(l2, z));
        hn::StoreU(hn::Add(turned, hn::Set(tag, translation[c])), tag, at + c * stride);
      }
    }
  }
}
/// Pairs that one vector of the exact kernel holds; twice as many of the filter.
std::size_t exact_lanes() { return hn::Lanes(hn::ScalableTag<double>()); }

HWY_NOINLINE void place_float(float* rows, std::int64_t stride, std::int64_t count, const float linear[3][3], const float translation[3]) {
  place_corners(rows, stride, count, linear, translation);
}
HWY_NOINLINE void place_double(double* rows, std::int64_t stride, std::int64_t count, const double linear[3][3],
                               const double translation[3]) {
  place_corners(rows, stride, count, linear, translation);
}

/// Widens the boxes of both sides (lower, upper) by the corners in the columns of a batch that are chosen, those above 0. The
/// columns are read up to a whole number of vectors.
HWY_NOINLINE void add_corners(const float* rows, std::int64_t stride, std::int64_t count, const float* chosen, float box[2][6]) {
  const hn::ScalableTag<float> tag;
  const auto far = hn::Set(tag, 3e38f);
  for (int side = 0; side < 2; ++side)
    for (int c = 0; c < 3; ++c) {
      auto lower = far, upper = hn::Neg(far);
      for (std::int64_t i = 0; i < count; i += static_cast<std::int64_t>(hn::Lanes(tag))) {
        const auto mask = hn::Gt(hn::LoadU(tag, chosen + i), hn::Zero(tag));
        for (int corner = 0; corner < 3; ++corner) {
          const auto x = hn::LoadU(tag, rows + (9 * side + 3 * corner + c) * stride + i);
          lower = hn::Min(lower, hn::IfThenElse(mask, x, far));
          upper = hn::Max(upper, hn::IfThenElse(mask, x, hn::Neg(far)));
        }
      }
      box[side][c] = std::min(box[side][c], hn::GetLane(hn::MinOfLanes(tag, lower)));
      box[side][3 + c] = std::max(box[side][3 + c], hn::GetLane(hn::MaxOfLanes(tag, upper)));
    }
}

}  // namespace scree::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace scree {

namespace {

HWY_EXPORT(find_expired);
HWY_EXPORT(place_float);
HWY_EXPORT(place_double);
HWY_EXPORT(exact_lanes);
HWY_EXPORT(add_corners);

/// Shapes with more triangles than this need the wide pairs.
constexpr std::int32_t kNarrowTriangles = 65536;

// Relative costs of the model in the header, in units of one scanned pair (about 1 ns): measured with scree-bench-candidates
// on an AVX-512 core. Twice or half of any of them moves the skin by 1.26 and the cost by a few percent.
constexpr double kDescentCost = 6000, kListingCost = 55, kScanCost = 1;

/// The skin stays between these parts of the smaller body's radius; the first one is the square root of their product.
constexpr double kThinnestSkin = 1e-4, kWidestSkin = 0.25, kFirstSkin = 0.02;
/// The skin is twice as wide at this part of the smaller body's radius, at least, from where bodies touch.
constexpr double kShortestLever = 0.1;
/// The skin changes by at most this factor from one list to the next: one odd step must not spoil it.
constexpr double kSkinChange = 4;

/// Bounds are raised by this part, and by this part of the placement's size, so that rounding cannot make them too small.
constexpr double kBoundRounding = 1e-6, kPlaceRounding = 1e-15;

/// Chord of the turn between two placements: 2 sin(half the angle).
double chord_of(const Placement& from, const Placement& to) {
  double turn = 0;
  for (int i = 0; i < 3; ++i) turn += squared_length(to.rotation[i] - from.rotation[i]);
  return std::sqrt(0.5 * turn);
}

/// Shift of a point of B in A's frame.
double shift_of(const Placement& from, const Placement& to, const Vec3& point) {
  return length(to.scale * (to.rotation * point) + to.translation - (from.scale * (from.rotation * point) + from.translation));
}

/// A bound, made safe against the rounding of what it was computed from.
double raised(double bound, const Placement& p, const Vec3& on_a, const Vec3& on_b) {
  const double size =
      std::abs(p.translation.x) + std::abs(p.translation.y) + std::abs(p.translation.z) + length(on_a) + p.scale * length(on_b);
  return bound * (1 + kBoundRounding) + kPlaceRounding * size;
}

/// Bound on the motion of A's patch and B's patch against each other from one placement of B in A's frame to another: the
/// points of B in A's frame, or those of A in B's frame, whichever is the smaller bound [units of A's shape].
double motion_bound(const Placement& from, const Placement& to, const SurfacePatch& a, const SurfacePatch& b) {
  const double chord = chord_of(from, to);
  const Vec3 a_before = transpose_times(from.rotation, a.centre - from.translation),
             a_after = transpose_times(to.rotation, a.centre - to.translation);
  return raised(std::min(shift_of(from, to, b.centre) + chord * to.scale * b.radius, length(a_after - a_before) + chord * a.radius), to,
                a.centre, b.centre);
}

/// Floats on the safe side: an expiry too early, a way too long.
constexpr double kFloatRounding = 0x1p-23, kSmallestFloat = 0x1p-149;
float round_down(double x) { return static_cast<float>(x - kFloatRounding * std::abs(x) - kSmallestFloat); }
float round_up(double x) { return static_cast<float>(x + kFloatRounding * std::abs(x) + kSmallestFloat); }

}  // namespace

struct KeptPairsScratch {
  static constexpr std::int64_t kBatchPairs = DescentScratch::kBlock, kStride = DescentScratch::kStride;
  DescentScratch descent;
  std::vector<std::int32_t> expired;
  std::vector<std::int32_t> decide_entry;
  struct Listed {
    TrianglePair pair;
    float expiry;
  };
  std::vector<Listed> listed;
  std::vector<float> chosen;  // by candidate: 1 where it is listed, 0 elsewhere, in whole blocks
  KeptPairsScratch() { descent.keep_corners = true; }
  alignas(64) std::array<float, 18 * kStride> single;
  alignas(64) std::array<double, 18 * kStride> exact;
  alignas(64) std::array<float, kBatchPairs> single_distance;
  alignas(64) std::array<double, kBatchPairs> distance;
};

void KeptPairsScratchDeleter::operator()(KeptPairsScratch* scratch) const { delete scratch; }
KeptPairsScratchPtr make_kept_pairs_scratch() { return KeptPairsScratchPtr(new KeptPairsScratch()); }

namespace {

constexpr std::int64_t kBatchPairs = KeptPairsScratch::kBatchPairs, kStride = KeptPairsScratch::kStride;

template <class Real>
void load_corners(const TriangleMesh& mesh, const Vec3& origin, std::int32_t triangle, Real* column) {
  for (int k = 0; k < 3; ++k) {
    const Vec3 corner = mesh.corner(triangle, k) - origin;
    column[(3 * k) * kStride] = static_cast<Real>(corner.x);
    column[(3 * k + 1) * kStride] = static_cast<Real>(corner.y);
    column[(3 * k + 2) * kStride] = static_cast<Real>(corner.z);
  }
}

/// Single-precision distances of many pairs in A's frame, a batch at a time: found(k, distance) for pair_of(k).
template <class PairOf, class Found>
void filter_pairs(const MeshView& a, const MeshView& b, const DescentFrame& frame, std::size_t count, const PairOf& pair_of,
                  KeptPairsScratch& s, const Found& found) {
  for (std::size_t begin = 0; begin < count; begin += static_cast<std::size_t>(kBatchPairs)) {
    const auto size = static_cast<std::int64_t>(std::min(count - begin, static_cast<std::size_t>(kBatchPairs)));
    for (std::int64_t i = 0; i < size; ++i) {
      const TrianglePair pair = pair_of(begin + static_cast<std::size_t>(i));
      load_corners(*a.mesh, a.bvh->middle, pair.a, s.single.data() + i);
      load_corners(*b.mesh, b.bvh->middle, pair.b, s.single.data() + 9 * kStride + i);
    }
    HWY_DYNAMIC_DISPATCH(place_float)(s.single.data(), kStride, size, frame.linear, frame.translation);
    triangle_distances(PairBatch<float>{s.single.data(), kStride, size}, s.single_distance.data());
    for (std::int64_t i = 0; i < size; ++i) found(begin + static_cast<std::size_t>(i), s.single_distance[static_cast<std::size_t>(i)]);
  }
}

}  // namespace

void KeptPairs::fix_skin(double skin) {
  fixed_skin_ = skin;
  forget();
}

void KeptPairs::choose_skin(double smallest_radius, double margin) {
  if (fixed_skin_ > 0) {
    skin_ = fixed_skin_;
  } else if (steps_listed_ == 0) {
    if (skin_ <= 0) skin_ = std::max(kFirstSkin * smallest_radius, margin);
  } else {
    const double more = static_cast<double>(expiry_.size() - close_count_) / (skin_ * skin_),
                 way = moved_ / static_cast<double>(steps_listed_);
    const double per_pair = kScanCost + 0.5 * kListingCost * way / skin_;
    const double best = more > 0 ? std::cbrt(0.5 * kDescentCost * way / (per_pair * more)) : kSkinChange * skin_;
    skin_ = std::clamp(best, skin_ / kSkinChange, skin_ * kSkinChange);
  }
  if (fixed_skin_ <= 0) skin_ = std::clamp(skin_, kThinnestSkin * smallest_radius, kWidestSkin * smallest_radius);
}

void KeptPairs::find_patches(const Placement& b_in_a, const Vec3& middle, double allowance, KeptPairsScratch& s) {
  patch_a_ = patch_b_ = {};
  if (expiry_.empty()) return;
  float box[2][6];
  for (auto& side : box)
    for (int c = 0; c < 3; ++c) side[c] = 3e38f, side[3 + c] = -3e38f;
  const auto count = static_cast<std::int64_t>(s.descent.candidates.size());
  for (std::int64_t begin = 0; begin < count; begin += kBatchPairs) HWY_DYNAMIC_DISPATCH(add_corners)
  (s.descent.corners.data() + begin / kBatchPairs * DescentScratch::kBlockSize, kStride, std::min(count - begin, kBatchPairs),
   s.chosen.data() + begin, box);
  // a ball is a ball in either frame
  const auto ball = [&](const float side[6]) {
    const Vec3 lower{side[0], side[1], side[2]}, upper{side[3], side[4], side[5]};
    return SurfacePatch{middle + 0.5 * (lower + upper), 0.5 * length(upper - lower) * (1 + kBoundRounding) + allowance};
  };
  patch_a_ = ball(box[0]);
  const SurfacePatch b = ball(box[1]);
  patch_b_ = {(1 / b_in_a.scale) * transpose_times(b_in_a.rotation, b.centre - b_in_a.translation), b.radius / b_in_a.scale};
}

void KeptPairs::make_list(const MeshView& a, const MeshView& b, const Placement& b_in_a, double margin, KeptPairsScratch& s) {
  const Bvh &tree_a = *a.bvh, &tree_b = *b.bvh;
  const double smallest_radius = std::min(static_cast<double>(tree_a.radius), b_in_a.scale * static_cast<double>(tree_b.radius));
  choose_skin(smallest_radius, margin);
  // where the bodies touched last; nothing is known of bodies that have not
  centre_ = patch_b_.centre;
  lever_ = expiry_.empty() ? 0 : std::max(b_in_a.scale * patch_b_.radius, kShortestLever * smallest_radius);
  const DescentFrame frame = make_descent_frame(tree_a, tree_b, b_in_a);
  const double allowance = static_cast<double>(frame.allowance), reach = margin + skin_;
  s.descent.forget_placed();
  s.descent.candidates.clear();
  s.listed.clear();
  const double growth = lever_ > 0 ? skin_ / lever_ : 0;
  const Vec3 centre_in_a = b_in_a.scale * (b_in_a.rotation * centre_) + b_in_a.translation - tree_a.middle;
  collect_candidates(tree_a, tree_b, frame, DescentReach(filter_reach(frame, reach), growth, centre_in_a, frame), s.descent);
  const std::size_t candidates = s.descent.candidates.size();
  s.chosen.assign((candidates + static_cast<std::size_t>(kBatchPairs) - 1) / static_cast<std::size_t>(kBatchPairs) *
                      static_cast<std::size_t>(kBatchPairs),
                  0.0f);
  close_count_ = 0;
  std::size_t candidate = 0;
  for_each_single_distance(s.descent, [&](const TrianglePair& pair, float distance) {
    const std::size_t here = candidate++;
    const double least = static_cast<double>(distance) - allowance;
    double reach_here = reach;
    if (growth > 0 && least > reach) {
      double farthest = 0;
      for (int c = 0; c < 3; ++c) farthest = std::max(farthest, squared_length(b.mesh->corner(pair.b, c) - centre_));
      reach_here += growth * b_in_a.scale * std::sqrt(farthest);
    }
    if (least > reach_here) return;
    if (least <= margin) ++close_count_;
    s.chosen[here] = 1;
    s.listed.push_back({pair, round_down(least - margin)});
  });

  const std::size_t count = s.listed.size();
  const bool narrow = a.mesh->triangle_count() <= kNarrowTriangles && b.mesh->triangle_count() <= kNarrowTriangles;
  // exact capacities: a new vector unless the old one fits
  const auto fit = [](auto& v, std::size_t size) {
    if (v.capacity() != size) v = std::remove_reference_t<decltype(v)>(size);
    v.resize(size);
  };
  fit(expiry_, count);
  fit(narrow_, narrow ? count : 0);
  fit(wide_, narrow ? 0 : count);
  for (std::size_t k = 0; k < count; ++k) {
    const auto& [pair, expiry] = s.listed[k];
    expiry_[k] = expiry;
    if (narrow) {
      narrow_[k] = {static_cast<std::uint16_t>(pair.a), static_cast<std::uint16_t>(pair.b)};
    } else {
      wide_[k] = pair;
    }
  }
  find_patches(b_in_a, tree_a.middle, allowance, s);
  listed_at_ = last_ = b_in_a;
  margin_ = margin;
  way_ = 0;
  steps_listed_ = 0;
  has_list_ = true;
  ++counts_.lists;
  counts_.listed += static_cast<std::int64_t>(count);
}

bool KeptPairs::update(const MeshView& a, const MeshView& b, const Placement& b_in_a, double margin, KeptPairsScratch& s,
                       std::vector<ClosePair>& close) {
  close.clear();
  const Bvh &tree_a = *a.bvh, &tree_b = *b.bvh;
  if (tree_a.nodes.empty() || tree_b.nodes.empty()) return false;
  ++counts_.steps;
  if (has_list_) {
    ++steps_listed_;
    moved_ = lever_ > 0
                 ? raised(std::max(shift_of(listed_at_, b_in_a, centre_), lever_ * chord_of(listed_at_, b_in_a)), b_in_a, {}, centre_)
                 : motion_bound(listed_at_, b_in_a, {{}, static_cast<double>(tree_a.radius)}, {{}, static_cast<double>(tree_b.radius)});
    way_ += motion_bound(last_, b_in_a, patch_a_, patch_b_);
    last_ = b_in_a;
  }
  if (!has_list_ || moved_ > skin_ || margin != margin_ || b_in_a.scale != listed_at_.scale) make_list(a, b, b_in_a, margin, s);
  counts_.scanned += static_cast<std::int64_t>(expiry_.size());
  if (expiry_.empty()) return false;

  // those whose time has come
  s.expired.resize(expiry_.size());
  const float way = round_up(way_);
  const std::size_t expired = HWY_DYNAMIC_DISPATCH(find_expired)(expiry_.data(), expiry_.size(), way, s.expired.data());
  const DescentFrame frame = make_descent_frame(tree_a, tree_b, b_in_a);
  const double allowance = static_cast<double>(frame.allowance);
  // pairs that were within the margin at the last step have an expiry below 0: they need no filter
  s.decide_entry.clear();
  std::size_t to_filter = 0;
  for (std::size_t k = 0; k < expired; ++k) {
    const std::int32_t entry = s.expired[k];
    if (expiry_[static_cast<std::size_t>(entry)] < 0) {
      s.decide_entry.push_back(entry);
    } else {
      s.expired[to_filter++] = entry;
    }
  }
  // A vector costs the same in both, whatever is in its lanes: few pairs are decided at once, in the lanes left over.
  const std::size_t lanes = HWY_DYNAMIC_DISPATCH(exact_lanes)(), decided = s.decide_entry.size();
  const auto vectors = [](std::size_t pairs, std::size_t in_one) { return (pairs + in_one - 1) / in_one; };
  if (vectors(decided + to_filter, lanes) <= vectors(decided, lanes) + vectors(to_filter, 2 * lanes)) {
    s.decide_entry.insert(s.decide_entry.end(), s.expired.begin(), s.expired.begin() + static_cast<std::ptrdiff_t>(to_filter));
    to_filter = 0;
  }
  counts_.filtered += static_cast<std::int64_t>(to_filter);
  filter_pairs(
      a, b, frame, to_filter, [&](std::size_t k) { return pair_at(static_cast<std::size_t>(s.expired[k])); }, s,
      [&](std::size_t k, float distance) {
        const double least = static_cast<double>(distance) - allowance - margin;
        if (least > 0) {
          expiry_[static_cast<std::size_t>(s.expired[k])] = round_down(way_ + least);
        } else {
          s.decide_entry.push_back(s.expired[k]);
        }
      });

  // the decision
  double linear[3][3];
  const double translation[3] = {b_in_a.translation.x, b_in_a.translation.y, b_in_a.translation.z};
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) linear[i][j] = b_in_a.scale * b_in_a.rotation[i][j];
  bool intersecting = false;
  counts_.decided += static_cast<std::int64_t>(s.decide_entry.size());
  for (std::size_t begin = 0; begin < s.decide_entry.size(); begin += static_cast<std::size_t>(kBatchPairs)) {
    const auto size = static_cast<std::int64_t>(std::min(s.decide_entry.size() - begin, static_cast<std::size_t>(kBatchPairs)));
    for (std::int64_t i = 0; i < size; ++i) {
      const TrianglePair pair = pair_at(static_cast<std::size_t>(s.decide_entry[begin + static_cast<std::size_t>(i)]));
      load_corners(*a.mesh, Vec3{}, pair.a, s.exact.data() + i);
      load_corners(*b.mesh, Vec3{}, pair.b, s.exact.data() + 9 * kStride + i);
    }
    HWY_DYNAMIC_DISPATCH(place_double)(s.exact.data(), kStride, size, linear, translation);
    triangle_distances(PairBatch<double>{s.exact.data(), kStride, size}, s.distance.data());
    for (std::int64_t i = 0; i < size; ++i) {
      const auto entry = static_cast<std::size_t>(s.decide_entry[begin + static_cast<std::size_t>(i)]);
      const double distance = s.distance[static_cast<std::size_t>(i)];
      if (distance < margin || distance == 0) {
        close.push_back({pair_at(entry), distance});
        intersecting = intersecting || distance == 0;
        expiry_[entry] = -1;
      } else {
        expiry_[entry] = std::max(0.0f, round_down(way_ + (distance - margin)));
      }
    }
  }
  return intersecting;
}

}  // namespace scree
#endif
