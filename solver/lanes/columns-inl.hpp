// Rows of four numbers, one row for each lane, as four vectors. Included once for every instruction set.
#if defined(SCREE_SOLVER_LANES_COLUMNS_INL_HPP_) == defined(HWY_TARGET_TOGGLE)
#ifdef SCREE_SOLVER_LANES_COLUMNS_INL_HPP_
#undef SCREE_SOLVER_LANES_COLUMNS_INL_HPP_
#else
#define SCREE_SOLVER_LANES_COLUMNS_INL_HPP_
#endif

#include <hwy/highway.h>

#include <cstddef>
#include <cstdint>
#include <cstring>

#include "solver/bodies/lanes-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace scree::HWY_NAMESPACE {

enum class Of : std::uint8_t { difference, sum, one };

template <Of kOf, class Numbers>
HWY_INLINE Numbers combined(Numbers of_a, Numbers of_b) {
  if constexpr (kOf == Of::difference) return of_a - of_b;
  if constexpr (kOf == Of::sum) return of_a + of_b;
  return of_a;
}

#if HWY_TARGET <= HWY_AVX3
/// Rows 0, 1, 4 and 5 with the rows two further on in their upper halves, as columns.
HWY_INLINE void transpose(__m512d p, __m512d q, __m512d r, __m512d s, Lane* column) {
  const __m512d lower0 = _mm512_unpacklo_pd(p, q), lower1 = _mm512_unpacklo_pd(r, s), upper0 = _mm512_unpackhi_pd(p, q),
                upper1 = _mm512_unpackhi_pd(r, s);
  column[0].v = hn::Vec<Tag<double>>{_mm512_shuffle_f64x2(lower0, lower1, 0x88)};
  column[1].v = hn::Vec<Tag<double>>{_mm512_shuffle_f64x2(upper0, upper1, 0x88)};
  column[2].v = hn::Vec<Tag<double>>{_mm512_shuffle_f64x2(lower0, lower1, 0xdd)};
  column[3].v = hn::Vec<Tag<double>>{_mm512_shuffle_f64x2(upper0, upper1, 0xdd)};
}
#elif HWY_TARGET != HWY_SCALAR
/// Four rows of four numbers as columns; of lanes that are two, the same in two halves of each row.
template <class Half>
HWY_INLINE void transpose(Half&& half, Lane* column) {
  const Tag<double> d;
  if constexpr (kLanes == 2) {
    for (std::size_t j = 0; j < 4; j += 2) {
      const auto p = half(0, j), q = half(1, j);
      column[j].v = hn::InterleaveLower(d, p, q);
      column[j + 1].v = hn::InterleaveUpper(d, p, q);
    }
  } else {
    const auto p = half(0, 0), q = half(1, 0), r = half(2, 0), s = half(3, 0);
    const auto lower0 = hn::InterleaveLower(d, p, q), lower1 = hn::InterleaveLower(d, r, s), upper0 = hn::InterleaveUpper(d, p, q),
               upper1 = hn::InterleaveUpper(d, r, s);
    column[0].v = hn::ConcatLowerLower(d, lower1, lower0);
    column[1].v = hn::ConcatLowerLower(d, upper1, upper0);
    column[2].v = hn::ConcatUpperUpper(d, lower1, lower0);
    column[3].v = hn::ConcatUpperUpper(d, upper1, upper0);
  }
}
#endif

/// Four numbers of A's rows less those of B's, their sums, or A's alone: column[j] has the j-th of each lane.
/// in   at_a, at_b   (lane): the first of its four numbers, aligned or not
/// A gather costs as much as four of these shuffles, or more; sums are made first, so that half of the shuffles suffice.
template <Of kOf, class AtA, class AtB>
HWY_INLINE void load_columns(AtA&& at_a, AtB&& at_b, Lane* column) {
#if HWY_TARGET == HWY_SCALAR
  for (std::size_t j = 0; j < 4; ++j) column[j] = combined<kOf>(Lane(at_a(0)[j]), Lane(at_b(0)[j]));
#elif HWY_TARGET <= HWY_AVX3
  // a half of 256 bits is loaded into its place, which takes no shuffle: two stages are left
  const auto halves_of = [](const auto& at, std::size_t lane) {
    return _mm512_mask_broadcast_f64x4(_mm512_castpd256_pd512(_mm256_loadu_pd(at(lane))), 0xf0, _mm256_loadu_pd(at(lane + 2)));
  };
  const auto halves = [&](std::size_t lane) {
    return combined<kOf>(halves_of(at_a, lane), kOf == Of::one ? _mm512_setzero_pd() : halves_of(at_b, lane));
  };
  transpose(halves(0), halves(1), halves(4), halves(5), column);
#else
  const auto of_both = [&](std::size_t lane, std::size_t j) {
    const Tag<double> d;
    return combined<kOf>(Lane(hn::LoadU(d, at_a(lane) + j)), kOf == Of::one ? Lane(0.0) : Lane(hn::LoadU(d, at_b(lane) + j))).v;
  };
  transpose(of_both, column);
#endif
}

/// The same of one row for each lane.
template <class At>
HWY_INLINE void load_columns(At&& at, Lane* column) {
  load_columns<Of::one>(at, at, column);
}

/// Three numbers of each lane, behind which there may be none.
template <class At>
HWY_INLINE Lane3 load_vectors(At&& at) {
  Lane column[4];
#if HWY_TARGET == HWY_SCALAR
  for (std::size_t j = 0; j < 3; ++j) column[j] = Lane(at(0)[j]);
#elif HWY_TARGET <= HWY_AVX3
  const auto row = [&](std::size_t lane) { return _mm256_maskz_loadu_pd(0x7, at(lane)); };
  const auto halves = [&](std::size_t lane) { return _mm512_insertf64x4(_mm512_castpd256_pd512(row(lane)), row(lane + 2), 1); };
  transpose(halves(0), halves(1), halves(4), halves(5), column);
#else
  const auto half = [&](std::size_t lane, std::size_t j) {
    const Tag<double> d;
    if constexpr (kLanes == 2) return j == 0 ? hn::LoadU(d, at(lane)) : hn::Set(d, at(lane)[2]);
    return hn::MaskedLoad(hn::FirstN(d, 3), d, at(lane));
  };
  transpose(half, column);
#endif
  return {column[0], column[1], column[2]};
}

/// A vector and a number of each lane: what StoreInterleaved4 does, wherever the rows lie.   in   to   (lane): the first of four numbers
template <class To>
HWY_INLINE void store_columns(To&& to, const Lane3& v, Lane last) {
#if HWY_TARGET <= HWY_AVX3
  const __m512d x = v.x.v.raw, y = v.y.v.raw, z = v.z.v.raw, w = last.v.raw;
  const __m512d even01 = _mm512_unpacklo_pd(x, y), odd01 = _mm512_unpackhi_pd(x, y), even23 = _mm512_unpacklo_pd(z, w),
                odd23 = _mm512_unpackhi_pd(z, w);
  const __m512i first = _mm512_setr_epi64(0, 1, 8, 9, 2, 3, 10, 11), second = _mm512_setr_epi64(4, 5, 12, 13, 6, 7, 14, 15);
  const __m512d rows02 = _mm512_permutex2var_pd(even01, first, even23), rows46 = _mm512_permutex2var_pd(even01, second, even23),
                rows13 = _mm512_permutex2var_pd(odd01, first, odd23), rows57 = _mm512_permutex2var_pd(odd01, second, odd23);
  const auto store = [&to](std::size_t row, __m512d two) {
    _mm256_storeu_pd(to(row), _mm512_castpd512_pd256(two));
    _mm256_storeu_pd(to(row + 2), _mm512_extractf64x4_pd(two, 1));
  };
  store(0, rows02);
  store(1, rows13);
  store(4, rows46);
  store(5, rows57);
#else
  alignas(64) double rows[4 * kLanes];
  hn::StoreInterleaved4(v.x.v, v.y.v, v.z.v, last.v, Tag<double>(), rows);
  for (std::size_t lane = 0; lane < kLanes; ++lane) std::memcpy(to(lane), rows + 4 * lane, 4 * sizeof(double));
#endif
}

// NOLINTNEXTLINE(google-readability-namespace-comments)
}  // namespace scree::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
