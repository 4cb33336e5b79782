// Loading pairs of a batch into lanes, and solving them by brute force.
#if defined(SCREE_CORE_DISTANCE_BATCH_INL_HPP_) == defined(HWY_TARGET_TOGGLE)
#ifdef SCREE_CORE_DISTANCE_BATCH_INL_HPP_
#undef SCREE_CORE_DISTANCE_BATCH_INL_HPP_
#else
#define SCREE_CORE_DISTANCE_BATCH_INL_HPP_
#endif

#include "core/distance/brute_force-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace scree::HWY_NAMESPACE {

/// The triangle in nine rows of a batch, from the pair that values points at.
template <class T>
HWY_INLINE TrianglePack<T> load_triangle(const T* values, std::int64_t stride) {
  TrianglePack<T> t;
  SCREE_UNROLL_3
  for (int k = 0; k < 3; ++k)
    t.p[k] = {Pack<T>::load(values + (3 * k) * stride), Pack<T>::load(values + (3 * k + 1) * stride),
              Pack<T>::load(values + (3 * k + 2) * stride)};
  return t;
}

/// Solves the pairs of the lanes from `values` on and calls store(solution): twice when there are rare lanes.
template <class T, Want kWant, class Store>
HWY_INLINE void solve_lanes(const T* values, std::int64_t stride, const Store& store) {
  RareLanes<T> rare;
  {
    Orientation<T> o;
    store(brute_force<T, kWant>(load_triangle(values, stride), load_triangle(values + 9 * stride, stride), o, rare));
  }
  if (HWY_UNLIKELY(any(rare.contact | rare.unusual))) {
    Solution<T> settled;
    solve_rare<T, kWant>(load_triangle(values, stride), load_triangle(values + 9 * stride, stride), settled);
    store(settled);
  }
}

}  // namespace scree::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
