// hertz-mindlin between balls that stick with the hysteresis of JKR (core/storage/jkr.hpp): from touch on until the neck tears.
// Damping goes with the part of the force that Hertz gives for the same radius of contact, as everywhere with the push: it stays defined
// where the energy is below 0. Friction and rolling are limited by mu |F + 2 F_c| (Thornton, J. Phys. D 24 (1991) 1942), the tangential
// stiffness is 8 G* a with the radius a of JKR. Two bodies remember that they have a neck by a row of PairState (kLinkKey).
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
  /// Overlap of the Hertz contact that has the radius of this one [m]: what force, energy and stiffness of the push are taken at.
  double push_overlap(double D) const { return neck ? neck->push_overlap(neck->root(D)) : D; }
  double pull(double D) const {
    if (!neck) return 0;
    const double y = neck->root(D);
    return neck->push(y) - neck->force(y);
  }
  double pull_energy(double D) const {
    if (!neck) return 0;
    const double y = neck->root(D);
    return energy(neck->push_overlap(y)) - neck->energy(y);
  }
  double pull_stiffness(double) const { return 0; }  ///< it only softens
  /// Share of the push at D that damping leaves: bodies that part are not held by more than F_c, damped or not.
  double least_push(double D) const {
    if (!neck) return 0;
    const double y = neck->root(D), push = neck->push(y);
    return std::max(0.0, (push - neck->force(y) - neck->pull_off) / push);
  }
  /// Limit of friction over mu, over the push at D.
  double load_share(double D) const {
    if (!neck) return 1;
    const double y = neck->root(D);
    return (neck->force(y) + 2 * neck->pull_off) / neck->push(y);
  }
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
