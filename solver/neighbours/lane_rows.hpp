// What lanes read and write in fours lies in the same order in the structures that keep it: it is copied as it is.
#pragma once

#include <cstddef>
#include <cstring>
#include <type_traits>

#include "solver/lanes/ball_rows.hpp"
#include "solver/laws/ball.hpp"
#include "solver/neighbours/body_pair.hpp"

namespace scree {

inline constexpr std::size_t kFour = 4 * sizeof(double), kOfSpring = offsetof(FrictionSpring, force),
                             kNumbers = offsetof(PairResult, force_a), kFoursOfResult = 6;
static_assert(offsetof(FrictionSpring, stiffness) == kOfSpring + 3 * sizeof(double));
static_assert(offsetof(PairResult, torque_a) == kNumbers + kFour && offsetof(PairResult, torque_b) == kNumbers + 2 * kFour &&
              offsetof(PairResult, dissipative_force_a) == kNumbers + 3 * kFour &&
              offsetof(PairResult, dissipative_torque_a) == kNumbers + 4 * kFour &&
              offsetof(PairResult, dissipative_torque_b) == kNumbers + 5 * kFour &&
              sizeof(PairResult) == kNumbers + kFoursOfResult * kFour && std::is_trivially_copyable_v<PairResult>);

inline void store(const FrictionSpring& s, double* four) { std::memcpy(four, reinterpret_cast<const char*>(&s) + kOfSpring, kFour); }
inline void load(const double* four, FrictionSpring& s) { std::memcpy(reinterpret_cast<char*>(&s) + kOfSpring, four, kFour); }

/// The normal of a spring; the fourth place is left as it is.
inline void store(const Vec3& v, double* four) { std::memcpy(four, &v, sizeof v); }
inline void load(const double* four, Vec3& v) { v = {four[0], four[1], four[2]}; }

/// The numbers of a pair's result.   in   fours   as MeshForces::fours     in  n  place of the pair in each
template <class Fours>
[[gnu::always_inline]] inline void load(const Fours& fours, std::size_t n, PairResult& result) {
  char* const numbers = reinterpret_cast<char*>(&result) + kNumbers;
  for (std::size_t which = 0; which < kFoursOfResult; ++which) std::memcpy(numbers + which * kFour, &fours[which][4 * n], kFour);
}

/// The result of a pair of balls, or of a ball and a wall without what it does to the wall.
/// in   moment   null where the scene has none
inline void load(const BallSlot& slot, const PaddedVec3* moment, double radius_a, double radius_b, PairResult& result) {
  result.force_a = slot.force;
  result.elastic = slot.elastic;
  result.torque_a = ball_torque(slot.across, radius_a, slot.half);
  result.torque_b = ball_torque(slot.across, radius_b, slot.half);
  if (moment != nullptr) {
    result.torque_a += moment->v;
    result.torque_b -= moment->v;
  }
  result.dissipative_force_a = slot.lost;
  result.dissipative_torque_a = result.torque_a;
  result.dissipative_torque_b = result.torque_b;
  result.overlap_ratio = slot.ratio;
  result.surface_power = 0;
}

}  // namespace scree
