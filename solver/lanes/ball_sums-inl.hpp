// The sum over the pairs of a ball, four numbers at a time. A pair is met twice, by each of its bodies, and lies where the cache has it or
// not: so the three vectors of a pair are next to each other, each with a fourth number that is added up and dropped. Included by
// ball_sums.cpp and ball_motion.cpp once for every instruction set.
#if defined(SCREE_SOLVER_LANES_BALL_SUMS_INL_HPP_) == defined(HWY_TARGET_TOGGLE)
#ifdef SCREE_SOLVER_LANES_BALL_SUMS_INL_HPP_
#undef SCREE_SOLVER_LANES_BALL_SUMS_INL_HPP_
#else
#define SCREE_SOLVER_LANES_BALL_SUMS_INL_HPP_
#endif

#include <hwy/highway.h>

#include <cstddef>
#include <cstdint>

#include "solver/lanes/ball_sums.hpp"

HWY_BEFORE_NAMESPACE();
namespace scree::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Four = hn::CappedTag<double, 4>;
constexpr std::size_t kWidth = hn::MaxLanes(Four());
static_assert(4 % kWidth == 0);

/// Four numbers, in one register or several.
struct Numbers {
  hn::Vec<Four> part[4 / kWidth];
  static HWY_INLINE Numbers zero() {
    Numbers n;
    for (auto& p : n.part) p = hn::Zero(Four());
    return n;
  }
  HWY_INLINE void add_signed(const double* from, hn::Vec<Four> sign) {
    for (std::size_t j = 0; j < 4 / kWidth; ++j) part[j] = hn::Add(part[j], hn::Xor(hn::Load(Four(), from + kWidth * j), sign));
  }
  HWY_INLINE void add_scaled(const double* from, hn::Vec<Four> scale) {
    for (std::size_t j = 0; j < 4 / kWidth; ++j) part[j] = hn::Add(part[j], hn::Mul(scale, hn::Load(Four(), from + kWidth * j)));
  }
  HWY_INLINE void add_scaled_and_signed(const double* scaled, hn::Vec<Four> scale, const double* other, hn::Vec<Four> sign) {
    for (std::size_t j = 0; j < 4 / kWidth; ++j) {
      const auto first = hn::Mul(scale, hn::Load(Four(), scaled + kWidth * j));
      part[j] = hn::Add(part[j], hn::Add(first, hn::Xor(hn::Load(Four(), other + kWidth * j), sign)));
    }
  }
  HWY_INLINE void add_scaled_vector(const Numbers& v, double scale) {
    for (std::size_t j = 0; j < 4 / kWidth; ++j) part[j] = hn::Add(part[j], hn::Mul(hn::Set(Four(), scale), v.part[j]));
  }
  HWY_INLINE void store(double* to) const {
    for (std::size_t j = 0; j < 4 / kWidth; ++j) hn::Store(part[j], Four(), to + kWidth * j);
  }
  HWY_INLINE Vec3 vector() const {
    alignas(32) double numbers[4];
    store(numbers);
    return {numbers[0], numbers[1], numbers[2]};
  }
};

/// What pairs do to a body.
struct OnBall {
  Numbers force, torque, lost;  ///< see ParticleSet; torque is all dissipative
};

template <bool kRolls>
HWY_INLINE OnBall sum_on_ball(const BallSums& sums, std::size_t i, double radius) {
  const std::int32_t* const entry = sums.entries + sums.start[i];
  OnBall on{Numbers::zero(), Numbers::zero(), Numbers::zero()};
  for (std::int32_t n = 0; n < sums.count[i]; ++n) {
    const std::int32_t place = entry[n] / 2;
    const BallSlot& slot = sums.slots[place];
    const auto sign = hn::Set(Four(), entry[n] % 2 == 0 ? 0.0 : -0.0);
    const auto reach = hn::Set(Four(), slot.half - radius);  // ball_torque()
    on.force.add_signed(&slot.force.x, sign);
    if constexpr (kRolls)
      on.torque.add_scaled_and_signed(&slot.across.x, reach, &sums.moments[place].v.x, sign);
    else
      on.torque.add_scaled(&slot.across.x, reach);
    on.lost.add_signed(&slot.lost.x, sign);
  }
  return on;
}

/// Asks for the slots of a body that is to come.
HWY_INLINE void ask_for_slots(const BallSums& sums, std::size_t i) {
  const std::int32_t* const later = sums.entries + sums.start[i];
  for (std::int32_t n = 0; n < sums.count[i]; ++n) {
    const char* const slot = reinterpret_cast<const char*>(&sums.slots[later[n] / 2]);
    __builtin_prefetch(slot);
    __builtin_prefetch(slot + sizeof(BallSlot) - 1);
  }
}
inline constexpr std::size_t kBodiesAhead = 4;

/// Whether asking takes less time than waiting: not of what the last cache holds a good part of (measured: 4 % slower with 8 MB).
HWY_INLINE bool asks_for_slots(const BallSums& sums) {
  constexpr std::size_t kNear = std::size_t{1} << 24;
  return sums.slot_count * sizeof(BallSlot) > kNear;
}

// NOLINTNEXTLINE(google-readability-namespace-comments)
}  // namespace scree::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
