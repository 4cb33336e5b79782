// The kernel of brute_force-inl.hpp over batches, for every SIMD target, and the choice of the target.
//
// Highway compiles this file once per target (foreach_target) and picks the best one that the processor has
// at run time. The file must be compiled for the baseline instruction set: never with -march=native.
#include "core/distance/triangle_distance.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "core/base/error.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/distance/triangle_distance.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/distance/batch-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace scree::HWY_NAMESPACE {

HWY_NOINLINE void solve_double(const double* values, std::int64_t stride, std::int64_t count, double* distance) {
  solve_batch<double, Want::distance>(values, stride, count, {distance});
}
HWY_NOINLINE void solve_float(const float* values, std::int64_t stride, std::int64_t count, float* distance) {
  solve_batch<float, Want::distance>(values, stride, count, {distance});
}
/// The eleven rows of batch-inl.hpp, row_stride apart.
HWY_NOINLINE void solve_double_in_detail(const double* values, std::int64_t stride, std::int64_t count, double* rows,
                                         std::int64_t row_stride) {
  Rows<double, Want::points_and_difference> out;
  for (std::size_t r = 0; r < out.size(); ++r) out[r] = rows + static_cast<std::int64_t>(r) * row_stride;
  solve_batch<double, Want::points_and_difference>(values, stride, count, out);
}
const char* target_name() { return hwy::TargetName(HWY_TARGET); }

}  // namespace scree::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace scree {
namespace {

HWY_EXPORT(solve_double);
HWY_EXPORT(solve_float);
HWY_EXPORT(solve_double_in_detail);
HWY_EXPORT(target_name);

/// Below this ratio of distance to longest edge the difference of the closest points has lost so many digits
/// that the feature's own normal is the better one (difference: error roundoff * L / d; feature: roundoff).
constexpr double kFeatureNormalRatio = 0x1p-24;

Vec3 vertex(const double* values, std::int64_t stride, int k) {
  return {values[(3 * k) * stride], values[(3 * k + 1) * stride], values[(3 * k + 2) * stride]};
}

bool is_edge(Feature f) { return f >= Feature::edge0 && f <= Feature::edge2; }
int index_of(Feature f) { return is_edge(f) ? static_cast<int>(f) - 1 : static_cast<int>(f) - 4; }

/// Unit vector; zero for zero.
Vec3 direction_of(const Vec3& v) {
  const double size = std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
  return size > 0 ? normalised((1.0 / size) * v) : Vec3{};
}

/// Unit normal of the closest features from b to a; a zero vector when they define none (a vertex against a
/// vertex or an edge, a degenerate face), and the difference of the points has to serve.
Vec3 feature_normal(const double* values, std::int64_t stride, Feature fa, Feature fb) {
  Vec3 p[3], q[3];
  for (int k = 0; k < 3; ++k) {
    p[k] = vertex(values, stride, k);
    q[k] = vertex(values + 9 * stride, stride, k);
  }
  Vec3 n, from_b_to_a;
  if (is_edge(fa) && is_edge(fb)) {
    const int i = index_of(fa), j = index_of(fb);
    n = cross(p[(i + 1) % 3] - p[i], q[(j + 1) % 3] - q[j]);
    from_b_to_a = p[i] - q[j];
  } else if (fb == Feature::face) {
    n = cross(q[1] - q[0], q[2] - q[0]);
    from_b_to_a = p[index_of(fa)] - q[0];
  } else if (fa == Feature::face) {
    n = cross(p[1] - p[0], p[2] - p[0]);
    from_b_to_a = p[0] - q[index_of(fb)];
  }
  n = direction_of(n);
  return dot(n, from_b_to_a) < 0 ? -n : n;
}

double longest_edge_squared(const double* values, std::int64_t stride) {
  double largest = 0;
  for (int side = 0; side < 2; ++side)
    for (int k = 0; k < 3; ++k) {
      const Vec3 edge = vertex(values + 9 * side * stride, stride, (k + 1) % 3) - vertex(values + 9 * side * stride, stride, k);
      largest = std::max(largest, dot(edge, edge));
    }
  return largest;
}

/// From the middle of b to the middle of a: for pairs so close that rounding leaves no other direction.
Vec3 centre_direction(const double* values, std::int64_t stride) {
  Vec3 d;
  for (int k = 0; k < 3; ++k) d += vertex(values, stride, k) - vertex(values + 9 * stride, stride, k);
  const Vec3 n = direction_of(d);
  return n == Vec3{} ? Vec3{0, 0, 1} : n;
}

/// From the eleven rows of batch-inl.hpp.
TriangleDistance answer_of(const double* values, std::int64_t stride, const double* rows, std::int64_t row_stride) {
  TriangleDistance answer;
  answer.distance = rows[0];
  answer.intersecting = answer.distance == 0;
  answer.point_a = vertex(rows + 2 * row_stride, row_stride, 0);
  answer.point_b = vertex(rows + 2 * row_stride, row_stride, 1);
  std::tie(answer.feature_a, answer.feature_b) = decode_features(static_cast<int>(rows[row_stride]));
  if (answer.intersecting) return answer;
  const double ratio = answer.distance / kFeatureNormalRatio;
  if (ratio * ratio < longest_edge_squared(values, stride))
    answer.normal = feature_normal(values, stride, answer.feature_a, answer.feature_b);
  if (answer.normal == Vec3{}) answer.normal = direction_of(vertex(rows + 2 * row_stride, row_stride, 2));
  if (answer.normal == Vec3{} && answer.distance > 0) answer.normal = centre_direction(values, stride);
  return answer;
}

void choose_target() { hwy::GetChosenTarget().Update(hwy::SupportedTargets()); }

}  // namespace

std::pair<Feature, Feature> decode_features(int code) {
  const int kind = code % 32;
  const auto edge = [](int i) { return static_cast<Feature>(1 + i); };
  const auto corner = [](int i) { return static_cast<Feature>(4 + i % 3); };
  if (kind < 9) {
    const int i = kind / 3, j = kind % 3;
    return {(code & 32) != 0 ? corner(i) : ((code & 64) != 0 ? corner(i + 1) : edge(i)),
            (code & 128) != 0 ? corner(j) : ((code & 256) != 0 ? corner(j + 1) : edge(j))};
  }
  if (kind < 12) return {corner(kind - 9), Feature::face};
  if (kind < 15) return {Feature::face, corner(kind - 12)};
  if (kind < 18) return {edge(kind - 15), Feature::face};
  return {Feature::face, edge(kind - 18)};
}

void triangle_distances(const PairBatch<double>& pairs, double* distance) {
  HWY_DYNAMIC_DISPATCH(solve_double)(pairs.values, pairs.stride, pairs.count, distance);
}

void triangle_distances(const PairBatch<float>& pairs, float* distance) {
  HWY_DYNAMIC_DISPATCH(solve_float)(pairs.values, pairs.stride, pairs.count, distance);
}

void triangle_distances(const PairBatch<double>& pairs, TriangleDistance* answers) {
  constexpr std::int64_t kBlock = 64;
  alignas(64) double rows[11 * kBlock];
  for (std::int64_t begin = 0; begin < pairs.count; begin += kBlock) {
    const std::int64_t count = std::min(kBlock, pairs.count - begin);
    HWY_DYNAMIC_DISPATCH(solve_double_in_detail)(pairs.values + begin, pairs.stride, count, rows, kBlock);
    for (std::int64_t i = 0; i < count; ++i) answers[begin + i] = answer_of(pairs.values + begin + i, pairs.stride, rows + i, kBlock);
  }
}

TriangleDistance triangle_distance(const Vec3 a[3], const Vec3 b[3]) {
  alignas(64) double values[18 * kBatchPadding];
  for (int k = 0; k < 9; ++k) {
    std::fill_n(values + k * kBatchPadding, kBatchPadding, a[k / 3][k % 3]);
    std::fill_n(values + (9 + k) * kBatchPadding, kBatchPadding, b[k / 3][k % 3]);
  }
  TriangleDistance answer;
  triangle_distances(PairBatch<double>{values, kBatchPadding, 1}, &answer);
  return answer;
}

std::string simd_target() { return HWY_DYNAMIC_DISPATCH(target_name)(); }

void limit_simd(const std::string& name) {
#if HWY_ARCH_X86
  constexpr std::int64_t avx512 = HWY_AVX3 | HWY_AVX3_DL, avx2 = HWY_AVX2, sse4 = HWY_SSE4;
#else
  constexpr std::int64_t avx512 = 0, avx2 = 0, sse4 = 0;
#endif
  hwy::DisableTargets(0);
  const std::int64_t supported = hwy::SupportedTargets() & HWY_TARGETS;
  std::int64_t disabled = 0, needed = 0;
  // a smaller bit is a better target
  const auto better_than = [&](std::int64_t targets) { return supported & ((targets & -targets) - 1); };
  if (name == "best") {
    needed = supported;
  } else if (name == "avx512") {
    needed = avx512;
  } else if (name == "avx2") {
    needed = avx2, disabled = better_than(avx2);
  } else if (name == "sse4") {
    needed = sse4, disabled = better_than(sse4);
  } else if (name == "scalar") {
    needed = HWY_STATIC_TARGET, disabled = supported & ~static_cast<std::int64_t>(HWY_STATIC_TARGET);
  } else {
    throw UsageError("--simd: '{}' is not known; expected best, avx512, avx2, sse4 or scalar", name);
  }
  if ((supported & needed) == 0)
    throw UsageError("--simd: this processor or build has no {}; the best target is {}; use best or a lower one", name,
                     hwy::TargetName(supported & -supported));
  hwy::DisableTargets(disabled);
  choose_target();
}

}  // namespace scree
#endif
