// What lanes read and write in fours lies in the same order in the structures that keep it: it is copied as it is.
#pragma once

#include <cstddef>
#include <cstring>
#include <type_traits>

#include "solver/neighbours/pair_list.hpp"

namespace scree {

inline constexpr std::size_t kFour = 4 * sizeof(double), kOfSpring = offsetof(FrictionSpring, force),
                             kNumbers = offsetof(PairResult, overlap_ratio);
static_assert(offsetof(FrictionSpring, stiffness) == kOfSpring + 3 * sizeof(double));
static_assert(offsetof(PairResult, surface_power) == kNumbers + 3 * sizeof(double) && offsetof(PairResult, force_a) == kNumbers + kFour &&
              offsetof(PairResult, torque_b) == kNumbers + 10 * sizeof(double) &&
              offsetof(PairResult, dissipative_torque_b) == kNumbers + 19 * sizeof(double) &&
              sizeof(PairResult) == kNumbers + 22 * sizeof(double) && std::is_trivially_copyable_v<PairResult>);

inline void store(const FrictionSpring& s, double* four) { std::memcpy(four, reinterpret_cast<const char*>(&s) + kOfSpring, kFour); }
inline void load(const double* four, FrictionSpring& s) { std::memcpy(reinterpret_cast<char*>(&s) + kOfSpring, four, kFour); }

/// The normal of a spring; the fourth place is left as it is.
inline void store(const Vec3& v, double* four) { std::memcpy(four, &v, sizeof v); }
inline void load(const double* four, Vec3& v) { v = {four[0], four[1], four[2]}; }

/// The numbers of a pair's result.   in   fours   as BallForces::fours     in  n  place of the pair in each
template <class Fours>
[[gnu::always_inline]] inline void load(const Fours& fours, std::size_t n, PairResult& result) {
  char* const numbers = reinterpret_cast<char*>(&result) + kNumbers;
  const auto four = [&](std::size_t which) { return &fours[which][4 * n]; };
  std::memcpy(numbers, four(0), kFour);
  std::memcpy(numbers + kFour, four(1), kFour);
  std::memcpy(numbers + 2 * kFour, four(2), kFour);
  std::memcpy(numbers + 3 * kFour, four(3), kFour);
  std::memcpy(numbers + 4 * kFour, four(4), kFour);
  std::memcpy(numbers + 5 * kFour, four(5), kFour / 2);
}

}  // namespace scree
