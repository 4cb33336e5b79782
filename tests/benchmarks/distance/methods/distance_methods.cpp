// The three methods over batches, for every SIMD target (see triangle_distance.cpp for the dispatch).
//
// The file must be compiled for the baseline instruction set: never with -march=native.
#include "tests/benchmarks/distance/methods/distance_methods.hpp"

#include <algorithm>
#include <array>

#include "core/base/error.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tests/benchmarks/distance/methods/distance_methods.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/distance/batch-inl.hpp"
#include "tests/benchmarks/distance/methods/penalty-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace scree::HWY_NAMESPACE {

/// Newton steps before the polish. With four, 0.5 to 3 % of the pairs end on the wrong active set; eight leave a tenth of
/// that and cost twice as much.
constexpr int kNewtonSteps = 4;

template <class T>
HWY_INLINE Rows<T, Want::points> rows_of(const AnswerBatch<T>& out) {
  Rows<T, Want::points> rows = {out.distance, out.code};
  for (std::size_t k = 0; k < 6; ++k) rows[2 + k] = out.points + static_cast<std::int64_t>(k) * out.stride;
  return rows;
}

template <class T>
HWY_NOINLINE void run_brute_force(const PairBatch<T>& in, const AnswerBatch<T>& out) {
  solve_batch<T, Want::points>(in.values, in.stride, in.count, rows_of(out));
}

template <class T, bool kStrict>
HWY_NOINLINE void run_penalty(const PairBatch<T>& in, const AnswerBatch<T>& out) {
  const Rows<T, Want::points> rows = rows_of(out);
  for (std::int64_t i = 0; i < in.count; i += lane_count<T>()) {
    const PairRows<T> pair{in.values + i, in.stride};
    const TrianglePack<T> a = pair.triangle(0), b = pair.triangle(1);
    Mask<T> unusual;
    Solution<T> s = penalty<T, kStrict>(a, b, kNewtonSteps, unusual);
    if (HWY_UNLIKELY(any(unusual))) penalty_scaled<T, kStrict>(a, b, kNewtonSteps, unusual, s);
    store_solution<T, Want::points>(s, rows, i);
  }
}

/// Pairs without certificate, gathered until a full batch of them is there, then solved by brute force.
template <class T>
HWY_NOINLINE void run_hybrid(const PairBatch<T>& in, const AnswerBatch<T>& out) {
  constexpr std::int64_t kBatch = 64;
  alignas(64) T values[18 * kBatch], distance[kBatch], points[6 * kBatch], code[kBatch];
  std::int64_t which[kBatch], waiting = 0;
  const auto flush = [&] {
    run_brute_force<T>({values, kBatch, waiting}, {distance, points, code, kBatch});
    for (std::int64_t k = 0; k < waiting; ++k) {
      out.distance[which[k]] = distance[k];
      out.code[which[k]] = code[k] + static_cast<T>(kCodeFellBack);
      for (std::int64_t c = 0; c < 6; ++c) out.points[c * out.stride + which[k]] = points[c * kBatch + k];
    }
    waiting = 0;
  };
  constexpr std::int64_t kBlock = 256;
  for (std::int64_t begin = 0; begin < in.count; begin += kBlock) {
    const std::int64_t end = std::min(begin + kBlock, in.count);
    run_penalty<T, true>({in.values + begin, in.stride, end - begin},
                         {out.distance + begin, out.points + begin, out.code + begin, out.stride});
    for (std::int64_t i = begin; i < end; ++i) {
      if (((static_cast<int>(out.code[i])) & kCodeUncertified) == 0) continue;
      for (std::int64_t c = 0; c < 18; ++c) values[c * kBatch + waiting] = in.values[c * in.stride + i];
      which[waiting++] = i;
      if (waiting == kBatch) flush();
    }
  }
  if (waiting > 0) flush();
}

template <class T>
HWY_INLINE void run(DistanceMethod method, const PairBatch<T>& in, const AnswerBatch<T>& out) {
  switch (method) {
    case DistanceMethod::brute_force:
      return run_brute_force<T>(in, out);
    case DistanceMethod::penalty:
      return run_penalty<T, false>(in, out);
    case DistanceMethod::hybrid:
      return run_hybrid<T>(in, out);
  }
}
void run_double(DistanceMethod method, const PairBatch<double>& in, const AnswerBatch<double>& out) { run(method, in, out); }
void run_single(DistanceMethod method, const PairBatch<float>& in, const AnswerBatch<float>& out) { run(method, in, out); }

}  // namespace scree::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace scree {
namespace {
HWY_EXPORT(run_double);
HWY_EXPORT(run_single);

constexpr int kUncertified = 512, kFellBack = 1024, kWeights = 2048;
int bits_of(double code) { return static_cast<int>(code); }
}  // namespace

DistanceMethod distance_method_of(const std::string& name) {
  if (name == "brute-force") return DistanceMethod::brute_force;
  if (name == "penalty") return DistanceMethod::penalty;
  if (name == "hybrid") return DistanceMethod::hybrid;
  throw UsageError("distance method '{}' is not known; expected brute-force, penalty or hybrid", name);
}

std::pair<Feature, Feature> features_of(double code) {
  const int bits = bits_of(code);
  if ((bits & kWeights) == 0) return decode_features(bits % kUncertified);
  // by which of the weights of the vertices 0, 1, 2 are zero (1, 2, 4)
  using enum Feature;
  static constexpr std::array<Feature, 8> by_zeros = {face, edge1, edge2, vertex2, edge0, vertex1, vertex0, vertex0};
  return {by_zeros[static_cast<std::size_t>(bits & 7)], by_zeros[static_cast<std::size_t>(bits >> 3 & 7)]};
}
bool is_uncertified(double code) { return (bits_of(code) & kUncertified) != 0; }
bool fell_back(double code) { return (bits_of(code) & kFellBack) != 0; }

void triangle_distances(DistanceMethod method, const PairBatch<double>& pairs, const AnswerBatch<double>& answers) {
  HWY_DYNAMIC_DISPATCH(run_double)(method, pairs, answers);
}
void triangle_distances(DistanceMethod method, const PairBatch<float>& pairs, const AnswerBatch<float>& answers) {
  HWY_DYNAMIC_DISPATCH(run_single)(method, pairs, answers);
}

}  // namespace scree
#endif
