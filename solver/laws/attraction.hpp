// Attraction of any two bodies, beside the law of their contact: a second potential of the same features, of how far x they are within the
// range s of the attraction, margins included:
//     U(x) = -F_c x^2 / (2 s) for 0 < x <= s, -F_c (x - s / 2) beyond
// The force grows from 0 at the end of the range to F_c at touch and stays F_c from there on. It has no jump and no memory.
// One feature parts at F_c; n equal ones, which share x as they share the overlap of their push, at F_c n^(1/8).
#pragma once

#include <algorithm>
#include <concepts>

#include "solver/laws/pair_law.hpp"

namespace scree {

struct Attraction {
  double force;  ///< F_c [N]; 0: these two materials do not attract each other
  double range;  ///< s [m]
  /// in   radius   R* [m]
  Attraction(const PairLaw& law, double radius) : force(law.pull_off + law.pull_off_per_radius * radius), range(law.reach) {}
  bool acts() const { return force > 0; }
  /// -U [J]
  double energy(double x) const { return x > range ? force * (x - 0.5 * range) : 0.5 * force * x * x / range; }
  double pull(double x) const { return x > range ? force : force * x / range; }
  /// The largest slope of the pull: a spring of as much would be as quick.
  double stiffness() const { return force / range; }
};

/// A law in a scene some of whose materials attract each other. It is the law as it stands for overlaps above 0, and the attraction.
template <class Law>
struct WithAttraction : Law {
  Attraction attraction;
  WithAttraction(const PairLaw& law, double r) : Law(law, r), attraction(law, r) {}
};

template <class Law>
concept AttractingLaw = requires(const Law& law) {
  { law.attraction } -> std::convertible_to<Attraction>;
};

}  // namespace scree
