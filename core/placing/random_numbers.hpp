// Random numbers that are a function of (seed, particle id, attempt, which) and of nothing else: no order of
// calls, no number of threads and no other particle can change them.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

#include "core/geometry/vec3.hpp"

namespace scree {

class RandomNumbers {
 public:
  RandomNumbers(std::uint64_t seed, std::int64_t particle_id, std::uint64_t attempt)
      : state_(mix(mix(mix(seed) + static_cast<std::uint64_t>(particle_id)) + attempt)) {}

  /// Uniform in [0, 1): number `which` of this attempt.
  double uniform(std::uint64_t which) const { return static_cast<double>(mix(state_ + which * 0x9E3779B97F4A7C15ull) >> 11) * 0x1p-53; }

  /// Uniform over all orientations; uses numbers which .. which + 2.
  /// Source: K. Shoemake, Uniform random rotations, Graphics Gems III (1992) 124.
  Quat orientation(std::uint64_t which) const {
    constexpr double kTwoPi = 2 * std::numbers::pi;
    const double u = uniform(which), a = kTwoPi * uniform(which + 1), b = kTwoPi * uniform(which + 2);
    const double r = std::sqrt(1 - u), s = std::sqrt(u);
    return normalised(Quat{s * std::cos(b), r * std::sin(a), r * std::cos(a), s * std::sin(b)});
  }

 private:
  /// Finaliser of SplitMix64. Source: G. Steele, D. Lea, C. Flood, OOPSLA 2014, 453.
  static std::uint64_t mix(std::uint64_t z) {
    z += 0x9E3779B97F4A7C15ull;
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ull;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBull;
    return z ^ (z >> 31);
  }
  std::uint64_t state_;
};

}  // namespace scree
