// The kernel of ball_sums.hpp, compiled once for every instruction set (Highway's foreach_target).
#include "solver/lanes/ball_sums.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "solver/lanes/ball_sums.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "solver/lanes/ball_sums-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace scree::HWY_NAMESPACE {
template <bool kRolls, bool kAsks>
void sum_bodies(const BallSums& sums, const Vec3& gravity, std::size_t begin, std::size_t end, ParticleSet& p) {
  for (std::size_t i = begin; i < end; ++i) {
    if (kAsks && i + kBodiesAhead < end) ask_for_slots(sums, i + kBodiesAhead);
    const OnBall on = sum_on_ball<kRolls>(sums, i, p.ball_radius[i]);
    p.force[i] = on.force.vector() + p.mass[i] * gravity;
    p.torque[i] = p.dissipative_torque[i] = on.torque.vector();
    p.dissipative_force[i] = on.lost.vector();
  }
}

HWY_NOINLINE void sum_range(const BallSums& sums, const Vec3& gravity, std::size_t begin, std::size_t end, ParticleSet& p) {
  const bool asks = asks_for_slots(sums);
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
