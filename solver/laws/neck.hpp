// hertz-mindlin between balls that stick with the hysteresis of JKR (core/storage/jkr.hpp): from touch on until the neck tears.
// Damping goes with the part of the force that Hertz gives for the same radius of contact, as everywhere with the push: it stays defined
// where the energy is below 0. Friction and rolling are limited by mu |F + 2 F_c| (Thornton, J. Phys. D 24 (1991) 1942), the tangential
// stiffness is 8 G* a with the radius a of JKR. Two bodies remember that they have a neck by a Link (contact/pair_memory.hpp).
#pragma once

#include <algorithm>
#include <optional>

#include "core/storage/jkr.hpp"
#include "solver/laws/normal.hpp"

namespace scree {

struct NeckLaw : HertzLaw {
  std::optional<Jkr> neck;  ///< of two materials that stick
  NeckLaw(const PairLaw& law, double r) : HertzLaw(law, r) {
    if (law.neck_adhesion > 0) neck.emplace(law.neck_adhesion, law.stiffness, r);
  }
  /// All that follows from the radius of the contact at an overlap.
  struct State {
    double push_overlap;       ///< of the Hertz contact that has this radius [m]: what force, energy and stiffness of the push are taken at
    double pull, pull_energy;  ///< [N, J]
    double load = 1;           ///< limit of friction over mu, over the push
    double least_push = 0;     ///< share of the push that damping leaves: bodies that part are held by F_c at most, damped or not
  };
  State at(double D) const {
    if (!neck) return {D, 0, 0};
    const double y = neck->root(D), push = neck->push(y), net = neck->force(y), overlap = neck->push_overlap(y);
    return {overlap, push - net, energy(overlap) - neck->energy(y), (net + 2 * neck->pull_off) / push,
            std::max(0.0, (push - net - neck->pull_off) / push)};
  }
  double push_overlap(double D) const { return at(D).push_overlap; }
  double pull(double D) const { return at(D).pull; }
  double pull_energy(double D) const { return at(D).pull_energy; }
  double pull_stiffness(double) const { return 0; }  ///< it only softens
};

/// A law whose push goes with another overlap than that of the bodies.
template <class Law>
concept NeckedLaw = requires(const Law& law) {
  { law.push_overlap(0.0) } -> std::same_as<double>;
};

/// The overlap that the push of a law is taken at.
template <class Law>
double overlap_of_push(const Law& law, double D) {
  if constexpr (NeckedLaw<Law>) {
    return law.push_overlap(D);
  } else {
    return D;
  }
}

}  // namespace scree
