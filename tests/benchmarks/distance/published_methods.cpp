// The published variants and the measured peak, for every SIMD target. Compiled for the baseline instruction set.
#include "tests/benchmarks/distance/published_methods.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tests/benchmarks/distance/published_methods.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/distance/batch-inl.hpp"
#include "tests/benchmarks/distance/methods/penalty-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace scree::HWY_NAMESPACE {

constexpr std::int64_t kPublishedBatch = 8;

template <class T, bool kPen7>
HWY_INLINE void published_pack(const TrianglePack<T>& A, const TrianglePack<T>& B, Solution<T>& out, Pack<T>& last_step) {
  using V = Pack<T>;
  const V two(T(2)), start(T(0.33));
  const PenaltyProblem<T> problem(A, B);
  const V trace = two * problem.trace(), lambda2 = V(T(0.0125)) * trace;
  const V r = kPen7 ? V(T(1e8)) * lambda2 : V(T(1e5)) * sqrt(lambda2);
  V delta = V(kPen7 ? T(1e-16) : T(1e-2)) * trace, step2(T(0)), size2(T(0));
  V x[4] = {start, start, start, start};
  constexpr int kSteps = kPen7 ? 7 : 4;
  for (int k = 0; k < kSteps; ++k) {
    V dx[4];
    problem.step(x, two, r, delta, dx);
    if (k == kSteps - 1) {
      step2 = mul_add(dx[0], dx[0], mul_add(dx[1], dx[1], mul_add(dx[2], dx[2], dx[3] * dx[3])));
      size2 = mul_add(x[0], x[0], mul_add(x[1], x[1], mul_add(x[2], x[2], x[3] * x[3])));
    }
    for (int c = 0; c < 4; ++c) x[c] = x[c] - dx[c];
    if (!kPen7) delta = delta * V(T(1e4));
    if (kPen7 && k == 3) delta = delta * V(T(2000));
  }
  const Pack3<T> d = problem.difference(x);
  out.distance = sqrt(dot(d, d));
  out.difference = d;
  out.point_a = mul_add(x[0], problem.e1, mul_add(x[1], problem.e2, A.p[0]));
  out.point_b = mul_add(x[2], problem.f1, mul_add(x[3], problem.f2, B.p[0]));
  last_step = kPen7 ? sqrt(step2) : sqrt(step2 / size2);
  const V failed_above(kPen7 ? T(1e-8) : T(0.01 / 8));
  const V zero(T(0));
  out.code = V(T(kCodeWeights)) + zero_weights(x[0], x[1]) + V(T(8)) * zero_weights(x[2], x[3]) +
             select(last_step <= failed_above, zero, V(T(kCodeUncertified)));
}

template <class T, bool kPen7, bool kHybrid>
HWY_NOINLINE void published_run(const PairBatch<T>& in, const AnswerBatch<T>& out) {
  alignas(64) T steps[kBatchPadding];
  for (std::int64_t i = 0; i < in.count; i += kBatchPadding) {
    for (std::int64_t lane = 0; lane < kBatchPadding; lane += lane_count<T>()) {
      const std::int64_t at = i + lane;
      Solution<T> s;
      Pack<T> step;
      const PairRows<T> pair{in.values + at, in.stride};
      published_pack<T, kPen7>(pair.triangle(0), pair.triangle(1), s, step);
      step.store(steps + lane);
      s.distance.store(out.distance + at);
      s.code.store(out.code + at);
      const Pack3<T>* points[2] = {&s.point_a, &s.point_b};
      for (std::int64_t k = 0; k < 2; ++k) {
        points[k]->x.store(out.points + (3 * k) * out.stride + at);
        points[k]->y.store(out.points + (3 * k + 1) * out.stride + at);
        points[k]->z.store(out.points + (3 * k + 2) * out.stride + at);
      }
    }
    if (!kHybrid) continue;
    for (std::int64_t batch = 0; batch < kBatchPadding; batch += kPublishedBatch) {
      T mean = 0;
      for (std::int64_t k = 0; k < kPublishedBatch; ++k) mean += steps[batch + k] / T(kPublishedBatch);
      if (mean <= T(1e-8)) continue;
      alignas(64) T values[18 * kBatchPadding], distance[kBatchPadding], points[6 * kBatchPadding], code[kBatchPadding];
      for (std::int64_t c = 0; c < 18; ++c)
        for (std::int64_t k = 0; k < kBatchPadding; ++k)
          values[c * kBatchPadding + k] = in.values[c * in.stride + i + batch + k % kPublishedBatch];
      triangle_distances(DistanceMethod::brute_force, PairBatch<T>{values, kBatchPadding, kPublishedBatch},
                         AnswerBatch<T>{distance, points, code, kBatchPadding});
      for (std::int64_t k = 0; k < kPublishedBatch; ++k) {
        out.distance[i + batch + k] = distance[k];
        out.code[i + batch + k] = code[k] + T(kCodeFellBack);
        for (std::int64_t c = 0; c < 6; ++c) out.points[c * out.stride + i + batch + k] = points[c * kBatchPadding + k];
      }
    }
  }
}

template <class T>
HWY_INLINE void published_dispatch(PublishedMethod method, const PairBatch<T>& in, const AnswerBatch<T>& out) {
  switch (method) {
    case PublishedMethod::pen4:
      return published_run<T, false, false>(in, out);
    case PublishedMethod::pen7:
      return published_run<T, true, false>(in, out);
    case PublishedMethod::pen4_hybrid:
      return published_run<T, false, true>(in, out);
    case PublishedMethod::pen7_hybrid:
      return published_run<T, true, true>(in, out);
  }
}
void published_double(PublishedMethod method, const PairBatch<double>& in, const AnswerBatch<double>& out) {
  published_dispatch(method, in, out);
}
void published_single(PublishedMethod method, const PairBatch<float>& in, const AnswerBatch<float>& out) {
  published_dispatch(method, in, out);
}

/// Twelve chains of dependent operations keep two units busy at a latency of four or five cycles. Returns the number of
/// floating-point operations; the sum keeps the compiler honest.
template <class T>
HWY_INLINE double fma_chains(std::int64_t repeats, double& sum) {
  using V = Pack<T>;
  V a0(T(1)), a1(T(2)), a2(T(3)), a3(T(4)), a4(T(5)), a5(T(6)), a6(T(7)), a7(T(8)), a8(T(9)), a9(T(10)), a10(T(11)), a11(T(12));
  const V m(T(0.999)), c(T(0.001));
  for (std::int64_t k = 0; k < repeats; ++k) {
    a0 = mul_add(a0, m, c), a1 = mul_add(a1, m, c), a2 = mul_add(a2, m, c), a3 = mul_add(a3, m, c);
    a4 = mul_add(a4, m, c), a5 = mul_add(a5, m, c), a6 = mul_add(a6, m, c), a7 = mul_add(a7, m, c);
    a8 = mul_add(a8, m, c), a9 = mul_add(a9, m, c), a10 = mul_add(a10, m, c), a11 = mul_add(a11, m, c);
  }
  alignas(64) T lanes[kBatchPadding] = {};
  (((a0 + a1) + (a2 + a3)) + ((a4 + a5) + (a6 + a7)) + ((a8 + a9) + (a10 + a11))).store(lanes);
  for (const T x : lanes) sum += static_cast<double>(x);
  return 12.0 * 2.0 * static_cast<double>(lane_count<T>() * repeats);
}
HWY_NOINLINE double fma_run(bool single, std::int64_t repeats, double& sum) {
  return single ? fma_chains<float>(repeats, sum) : fma_chains<double>(repeats, sum);
}

}  // namespace scree::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace scree {
namespace {
HWY_EXPORT(published_double);
HWY_EXPORT(published_single);
HWY_EXPORT(fma_run);
}  // namespace

void published_distances(PublishedMethod method, const PairBatch<double>& pairs, const AnswerBatch<double>& answers) {
  HWY_DYNAMIC_DISPATCH(published_double)(method, pairs, answers);
}
void published_distances(PublishedMethod method, const PairBatch<float>& pairs, const AnswerBatch<float>& answers) {
  HWY_DYNAMIC_DISPATCH(published_single)(method, pairs, answers);
}

double measured_fma_peak(bool single) {
  double best = 0, sum = 0;
  for (int trial = 0; trial < 20; ++trial) {
    const auto start = std::chrono::steady_clock::now();
    const double operations = HWY_DYNAMIC_DISPATCH(fma_run)(single, 100000, sum);
    const std::chrono::duration<double> time = std::chrono::steady_clock::now() - start;
    best = std::max(best, operations / time.count());
  }
  return std::isfinite(sum) ? 1e-9 * best : 0;
}

}  // namespace scree
#endif
