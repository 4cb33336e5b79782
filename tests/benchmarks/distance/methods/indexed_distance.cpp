// Rows of triangles into batches, for every SIMD target. Compiled for the baseline instruction set only.
#include "tests/benchmarks/distance/methods/indexed_distance.hpp"

#include <algorithm>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tests/benchmarks/distance/methods/indexed_distance.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/distance/simd-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace scree::HWY_NAMESPACE {

constexpr std::int64_t kRowLength = 12, kCoordinates = 9;

#if HWY_TARGET == HWY_SCALAR
constexpr std::int64_t kTogether = 4;
#elif HWY_CAP_GE256
constexpr std::int64_t kTogether = 8;
#else
constexpr std::int64_t kTogether = 4;
#endif

/// Nine coordinates of kTogether rows, transposed: coordinate c of row k to out[c * stride + k].
HWY_INLINE void transpose_rows(const float* const row[kTogether], float* out, std::int64_t stride) {
#if HWY_TARGET == HWY_SCALAR
  for (std::int64_t c = 0; c < kCoordinates; ++c)
    for (int k = 0; k < kTogether; ++k) out[c * stride + k] = row[k][c];
#else
  const hn::FixedTag<float, 4> four;
  const hn::FixedTag<float, kTogether> all;
  const hn::FixedTag<double, kTogether / 2> wide;
  // interleaving works within each four, so a vector holds row k and row k + 4
  const auto load = [&](int k, std::int64_t c) {
#if HWY_CAP_GE256
    return hn::Combine(all, hn::LoadU(four, row[k + 4] + c), hn::LoadU(four, row[k] + c));
#else
    return hn::LoadU(four, row[k] + c);
#endif
  };
  for (std::int64_t c = 0; c < kRowLength; c += 4) {
    const auto r0 = load(0, c), r1 = load(1, c), r2 = load(2, c), r3 = load(3, c);
    const auto low01 = hn::BitCast(wide, hn::InterleaveLower(all, r0, r1)), low23 = hn::BitCast(wide, hn::InterleaveLower(all, r2, r3));
    hn::StoreU(hn::BitCast(all, hn::InterleaveLower(wide, low01, low23)), all, out + c * stride);
    if (c + 1 == kCoordinates) break;
    hn::StoreU(hn::BitCast(all, hn::InterleaveUpper(wide, low01, low23)), all, out + (c + 1) * stride);
    const auto high01 = hn::BitCast(wide, hn::InterleaveUpper(all, r0, r1)), high23 = hn::BitCast(wide, hn::InterleaveUpper(all, r2, r3));
    hn::StoreU(hn::BitCast(all, hn::InterleaveLower(wide, high01, high23)), all, out + (c + 2) * stride);
    hn::StoreU(hn::BitCast(all, hn::InterleaveUpper(wide, high01, high23)), all, out + (c + 3) * stride);
  }
#endif
}

/// Eighteen rows of coordinates for `count` pairs and, up to the next multiple of kBatchPadding, the last pair again.
/// linear, translation: B's placement.
void gather_pairs(const float* a, const float* b, const float linear[9], const float translation[3], const TrianglePair* pairs,
                  std::int64_t count, float* values, std::int64_t stride) {
  const std::int64_t padded = (count + kBatchPadding - 1) / kBatchPadding * kBatchPadding;
  for (std::int64_t i = 0; i < padded; i += kTogether) {
    const float *of_a[kTogether], *of_b[kTogether];
    for (std::int64_t k = 0; k < kTogether; ++k) {
      const TrianglePair& pair = pairs[std::min(i + k, count - 1)];
      of_a[k] = a + kRowLength * pair.a;
      of_b[k] = b + kRowLength * pair.b;
    }
    transpose_rows(of_a, values + i, stride);
    transpose_rows(of_b, values + kCoordinates * stride + i, stride);
  }
  using V = Pack<float>;
  for (std::int64_t i = 0; i < padded; i += lane_count<float>())
    for (std::int64_t corner = 3; corner < 6; ++corner) {
      float* at = values + 3 * corner * stride + i;
      const V x = V::load(at), y = V::load(at + stride), z = V::load(at + 2 * stride);
      for (std::int64_t c = 0; c < 3; ++c)
        mul_add(V(linear[3 * c]), x, mul_add(V(linear[3 * c + 1]), y, mul_add(V(linear[3 * c + 2]), z, V(translation[c]))))
            .store(at + c * stride);
    }
}

}  // namespace scree::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace scree {
namespace {
HWY_EXPORT(gather_pairs);
}  // namespace

TriangleRows::TriangleRows(const TriangleMesh& mesh) : values_(static_cast<std::size_t>(12 * mesh.triangle_count())) {
  for (std::int32_t t = 0; t < mesh.triangle_count(); ++t)
    for (int k = 0; k < 9; ++k) values_[static_cast<std::size_t>(12 * t + k)] = static_cast<float>(mesh.corner(t, k / 3)[k % 3]);
}

void triangle_distances(const TriangleRows& a, const TriangleRows& b, const Placement& b_in_a, std::span<const TrianglePair> pairs,
                        const AnswerBatch<float>& answers) {
  constexpr std::int64_t kBlock = 128;
  static_assert(kBlock % kBatchPadding == 0);
  alignas(64) float values[18 * kBlock];
  float linear[9], translation[3];
  for (int i = 0; i < 3; ++i) {
    translation[i] = static_cast<float>(b_in_a.translation[i]);
    for (int j = 0; j < 3; ++j) linear[3 * i + j] = static_cast<float>(b_in_a.scale * b_in_a.rotation[i][j]);
  }
  const auto total = static_cast<std::int64_t>(pairs.size());
  for (std::int64_t begin = 0; begin < total; begin += kBlock) {
    const std::int64_t count = std::min(kBlock, total - begin);
    HWY_DYNAMIC_DISPATCH(gather_pairs)(a.data(), b.data(), linear, translation, pairs.data() + begin, count, values, kBlock);
    triangle_distances(DistanceMethod::brute_force, PairBatch<float>{values, kBlock, count},
                       AnswerBatch<float>{answers.distance + begin, answers.points + begin, answers.code + begin, answers.stride});
  }
}

}  // namespace scree
#endif
