// The kernel of ball_sums.hpp, compiled once for every instruction set (Highway's foreach_target). A pair is met twice, by each of its
// bodies, and lies where the cache has it or not: so the three vectors of a pair are next to each other, each with a fourth number that is
// added up and dropped.
#include "solver/lanes/ball_sums.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "solver/lanes/ball_sums.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

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
  HWY_INLINE Vec3 vector() const {
    alignas(32) double numbers[4];
    for (std::size_t j = 0; j < 4 / kWidth; ++j) hn::Store(part[j], Four(), numbers + kWidth * j);
    return {numbers[0], numbers[1], numbers[2]};
  }
};

template <bool kRolls, bool kAsks>
void sum_bodies(const BallSums& sums, const Vec3& gravity, std::size_t begin, std::size_t end, ParticleSet& p) {
  constexpr std::size_t kBodiesAhead = 4;
  for (std::size_t i = begin; i < end; ++i) {
    if (kAsks && i + kBodiesAhead < end) {
      const std::int32_t* const later = sums.entries + sums.start[i + kBodiesAhead];
      for (std::int32_t n = 0; n < sums.count[i + kBodiesAhead]; ++n) {
        const char* const slot = reinterpret_cast<const char*>(&sums.slots[later[n] / 2]);
        __builtin_prefetch(slot);
        __builtin_prefetch(slot + sizeof(BallSlot) - 1);
      }
    }
    const std::int32_t* const entry = sums.entries + sums.start[i];
    const double radius = p.ball_radius[i];
    Numbers force = Numbers::zero(), torque = Numbers::zero(), lost = Numbers::zero();
    for (std::int32_t n = 0; n < sums.count[i]; ++n) {
      const std::int32_t place = entry[n] / 2;
      const BallSlot& slot = sums.slots[place];
      const auto sign = hn::Set(Four(), entry[n] % 2 == 0 ? 0.0 : -0.0);
      const auto reach = hn::Set(Four(), slot.half - radius);  // ball_torque()
      force.add_signed(&slot.force.x, sign);
      if constexpr (kRolls)
        torque.add_scaled_and_signed(&slot.across.x, reach, &sums.moments[place].v.x, sign);
      else
        torque.add_scaled(&slot.across.x, reach);
      lost.add_signed(&slot.lost.x, sign);
    }
    p.force[i] = force.vector() + p.mass[i] * gravity;
    p.torque[i] = p.dissipative_torque[i] = torque.vector();
    p.dissipative_force[i] = lost.vector();
  }
}

HWY_NOINLINE void sum_range(const BallSums& sums, const Vec3& gravity, std::size_t begin, std::size_t end, ParticleSet& p) {
  // of what the second cache holds, asking takes longer than waiting
  constexpr std::size_t kNear = std::size_t{1} << 19;
  const bool asks = sums.slot_count * sizeof(BallSlot) > kNear;
  if (sums.moments != nullptr)
    asks ? sum_bodies<true, true>(sums, gravity, begin, end, p) : sum_bodies<true, false>(sums, gravity, begin, end, p);
  else
    asks ? sum_bodies<false, true>(sums, gravity, begin, end, p) : sum_bodies<false, false>(sums, gravity, begin, end, p);
}

}  // namespace scree::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace scree {
namespace {
HWY_EXPORT(sum_range);
}

void sum_onto_balls(const BallSums& sums, const Vec3& gravity, std::size_t begin, std::size_t end, ParticleSet& p) {
  HWY_DYNAMIC_DISPATCH(sum_range)(sums, gravity, begin, end, p);
}

}  // namespace scree
#endif
