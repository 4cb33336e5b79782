// Attraction of any two bodies, beside the law of their contact: a second potential of the same features, of how far x they are within its
// range s, margins included. Of three kinds (core/storage/attraction.hpp):
//     range     U(x) = -F_c x^2 / (2 s) for 0 < x <= s, -F_c (x - s / 2) beyond: no jump and no memory
//     bridge    U(x) = -(the work from the gap s - x on until it ruptures) for x <= s, as steep as at touch beyond. Only bodies that have
//               touched have one, until it ruptures: a pair remembers it by a Link (contact/pair_memory.hpp)
//     traction  of a smooth cap with gather = "area" (contact/area_model.hpp): U(x) = -(p / s) pi R* (x^3 - (x - s)^3) / 3, the second term
//               from touch on; at touch its force is 2 pi w R*
// The first two stay at F_c from touch on. One feature parts at F_c; n equal ones, which share x as they share the overlap of their push,
// at F_c n^(1/8).
#pragma once

#include <algorithm>
#include <cmath>
#include <concepts>
#include <numbers>
#include <optional>

#include "core/storage/attraction.hpp"
#include "solver/laws/pair_law.hpp"

namespace scree {

struct Attraction {
  double force;    ///< F_c [N]; 0: these two materials do not attract each other
  double range;    ///< s [m]
  double modulus;  ///< p / s of a traction [N/m^3]; 0: none
  /// in   radius   R* [m]
  Attraction(const PairLaw& law, double radius)
      : force(law.pull_off + law.pull_off_per_radius * radius), range(law.reach), modulus(law.pull_modulus), radius_(radius) {
    if (law.bridge != nullptr) bridge_.emplace(*law.bridge, radius);
  }
  bool acts() const { return force > 0 || modulus > 0; }
  /// -U [J]
  double energy(double x) const {
    if (bridge_) return x > range ? bridge_->energy_at(0) + force * (x - range) : bridge_->energy_at(range - x);
    if (modulus > 0) return cap() / 3 * (x * x * x - std::pow(std::max(0.0, x - range), 3));
    return x > range ? force * (x - 0.5 * range) : 0.5 * force * x * x / range;
  }
  double pull(double x) const {
    if (modulus > 0) return cap() * (x * x - std::pow(std::max(0.0, x - range), 2));
    if (x > range) return force;
    return bridge_ ? bridge_->force_at(range - x) : force * x / range;
  }
  /// The largest slope of the pull: a spring of as much would be as quick.
  double stiffness() const {
    if (modulus > 0) return 2 * cap() * range;
    return bridge_ ? bridge_->steepest() : force / range;
  }
  /// Whether two bodies that have a bridge still have it.
  bool holds(double x) const { return !bridge_ || range - x < bridge_->rupture; }

 private:
  double cap() const { return modulus * std::numbers::pi * radius_; }
  double radius_;
  std::optional<LiquidBridge> bridge_;
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
