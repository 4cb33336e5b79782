// Solving the pairs of a batch by brute force: full vectors, and rare lanes gathered into full vectors of their own.
#if defined(SCREE_CORE_DISTANCE_BATCH_INL_HPP_) == defined(HWY_TARGET_TOGGLE)
#ifdef SCREE_CORE_DISTANCE_BATCH_INL_HPP_
#undef SCREE_CORE_DISTANCE_BATCH_INL_HPP_
#else
#define SCREE_CORE_DISTANCE_BATCH_INL_HPP_
#endif

#include <algorithm>
#include <array>
#include <limits>

#include "core/distance/brute_force-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace scree::HWY_NAMESPACE {

/// Rows of an answer: 0 distance, 1 code, 2-4 point_a, 5-7 point_b, 8-10 difference, as many as are wanted.
template <Want kWant>
constexpr std::size_t row_count() {
  return kWant == Want::distance ? 1 : (kWant == Want::points ? 8 : 11);
}
template <class T, Want kWant>
using Rows = std::array<T*, row_count<kWant>()>;

template <class T, Want kWant>
HWY_INLINE void store_solution(const Solution<T>& s, const Rows<T, kWant>& rows, std::int64_t i) {
  s.distance.store(rows[0] + i);
  if constexpr (kWant != Want::distance) {
    s.code.store(rows[1] + i);
    s.point_a.x.store(rows[2] + i), s.point_a.y.store(rows[3] + i), s.point_a.z.store(rows[4] + i);
    s.point_b.x.store(rows[5] + i), s.point_b.y.store(rows[6] + i), s.point_b.z.store(rows[7] + i);
  }
  if constexpr (kWant == Want::points_and_difference)
    s.difference.x.store(rows[8] + i), s.difference.y.store(rows[9] + i), s.difference.z.store(rows[10] + i);
}

/// Lanes that the common case cannot settle, gathered from many vectors: a vector with one rare lane does not hold up
/// the others.
template <class T, Want kWant>
class RareQueue {
 public:
  explicit RareQueue(const Rows<T, kWant>& out) : out_(out) {}

  /// Takes the rare lanes of the vector that begins with pair `begin`; lanes past `end` are padding.
  HWY_NOINLINE void push(const T* values, std::int64_t stride, std::int64_t begin, std::int64_t end, Mask<T> rare) {
    alignas(64) T flag[kWidestLanes] = {};
    select(rare, Pack<T>(T(1)), Pack<T>(T(0))).store(flag);
    for (std::int64_t lane = 0; lane < std::min(lane_count<T>(), end - begin); ++lane) {
      if (flag[lane] == 0) continue;
      for (std::int64_t c = 0; c < 18; ++c) values_[c * kSize + count_] = values[c * stride + begin + lane];
      pair_[count_++] = begin + lane;
      if (count_ == kSize) flush();
    }
  }

  HWY_NOINLINE void flush() {
    alignas(64) T answers[row_count<kWant>()][kSize];
    alignas(64) T unsettled[kSize];
    solve(values_, count_, answers, unsettled);
    if constexpr (sizeof(T) == 4) settle_in_double(answers, unsettled);
    for (std::int64_t i = 0; i < count_; ++i)
      for (std::size_t r = 0; r < out_.size(); ++r) out_[r][pair_[i]] = answers[r][i];
    count_ = 0;
  }
  bool empty() const { return count_ == 0; }

 private:
  static constexpr std::int64_t kSize = 2 * kWidestLanes;

  template <class Real>
  static HWY_INLINE void solve(Real* values, std::int64_t count, Real (*answers)[kSize], Real* unsettled) {
    Rows<Real, kWant> rows;
    for (std::size_t r = 0; r < rows.size(); ++r) rows[r] = answers[r];
    for (std::int64_t i = 0; i < count; i += lane_count<Real>()) {
      // past the end: the last pair again
      for (std::int64_t k = count; k < i + lane_count<Real>(); ++k)
        for (std::int64_t c = 0; c < 18; ++c) values[c * kSize + k] = values[c * kSize + count - 1];
      Solution<Real> s;
      Mask<Real> rest;
      solve_rare<Real, kWant>({values + i, kSize}, s, rest);
      store_solution<Real, kWant>(s, rows, i);
      select(rest, Pack<Real>(Real(1)), Pack<Real>(Real(0))).store(unsettled + i);
    }
  }

  /// Pairs of single precision that all but touch, in double precision.
  HWY_INLINE void settle_in_double(T (*answers)[kSize], const T* unsettled) {
    alignas(64) double values[18 * kSize], settled[row_count<kWant>()][kSize], none[kSize];
    std::int64_t which[kSize], count = 0;
    for (std::int64_t i = 0; i < count_; ++i) {
      if (unsettled[i] == 0) continue;
      for (std::int64_t c = 0; c < 18; ++c) values[c * kSize + count] = static_cast<double>(values_[c * kSize + i]);
      which[count++] = i;
    }
    if (count == 0) return;
    solve(values, count, settled, none);
    for (std::int64_t k = 0; k < count; ++k) {
      for (std::size_t r = 0; r < out_.size(); ++r) answers[r][which[k]] = static_cast<T>(settled[r][k]);
      // apart stays apart, whatever the range of the type
      if (settled[0][k] > 0) answers[0][which[k]] = std::max(answers[0][which[k]], std::numeric_limits<T>::denorm_min());
    }
  }

  alignas(64) T values_[18 * kSize];
  std::int64_t pair_[kSize], count_ = 0;
  Rows<T, kWant> out_;
};

/// Solves `count` pairs. The rows have room for `count` answers and not more: the last part goes through a buffer.
template <class T, Want kWant>
HWY_INLINE void solve_batch(const T* values, std::int64_t stride, std::int64_t count, const Rows<T, kWant>& out) {
  const std::int64_t lanes = lane_count<T>();
  RareQueue<T, kWant> queue(out);
  alignas(64) T last[row_count<kWant>()][kWidestLanes];
  Rows<T, kWant> last_rows;
  for (std::size_t r = 0; r < last_rows.size(); ++r) last_rows[r] = last[r];
  for (std::int64_t i = 0; i < count; i += lanes) {
    const bool whole = i + lanes <= count;
    Orientation<T> o;
    RareLanes<T> rare;
    const Solution<T> s = brute_force<T, kWant, true>({values + i, stride}, o, rare);
    store_solution<T, kWant>(s, whole ? out : last_rows, whole ? i : 0);
    Mask<T> again = rare.contact | rare.thin | rare.unusual;
    if constexpr (kWant == Want::distance) {
      // where they intersect nothing else is asked for
      if (HWY_UNLIKELY(any(rare.contact))) {
        const Mask<T> meet = surely_meet<T>({values + i, stride}, rare.contact & !rare.unusual);
        T* distance = whole ? out[0] + i : last[0];
        select(meet, Pack<T>(T(0)), Pack<T>::load(distance)).store(distance);
        again = again & !meet;
      }
    }
    if (HWY_UNLIKELY(!whole))
      for (std::size_t r = 0; r < out.size(); ++r) std::copy(last[r], last[r] + (count - i), out[r] + i);
    if (HWY_UNLIKELY(any(again))) queue.push(values, stride, i, count, again);
  }
  if (!queue.empty()) queue.flush();
}

}  // namespace scree::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
