// Contacts that yield: of two materials with a plasticity, the law of the scene, F1(D) = c D^n, is what a contact follows as it is pressed
// deeper than ever before. Below that it unloads and reloads k2 / k1 times as steeply, from the overlap s that is left when the load is
// gone; s is the dent. Where materials are adhesive it then pulls, by k_adh / k1 of the law at most:
//     F = q (F1(D) - F1(s)), q = k2 / k1 = 1 / (1 - plasticity)
//     F1(s) >= plasticity F1(D)                pressed deeper, the dent grows so that F = F1(D)
//     F1(s) <= (1 + (k_adh / k1) / q) F1(D)    parted further, it shrinks so that F = -(k_adh / k1) F1(D)
// Linear this is the law of Walton and Braun (J. Rheology 30 (1986) 949, e = sqrt(k1 / k2)) and, with adhesion, that of Luding (Granular
// Matter 10 (2008) 235) with one k2; with any n that of Edinburgh (EEPA; Thakur, Morrissey, Sun, Chen, Ooi, Granular Matter 16 (2014) 383).
// Without adhesion a dent does not pull, and stays until the two bodies part (Walton and Braun).
//
// What is stored, U(D, s) = q (E1(D) - E1(s) - F1(s) (D - s)) with E1 the energy of the law, comes back. As the dent moves along either
// limit, D = s / l, contacts take q n |1 / l - 1| |d E1(s)|: what the paths of force and energy differ by, so that both are exact at any
// step.
//
// The push is F and what the contact pulls at most together, as is the limit of friction in EEPA; the pull is (k_adh / k1) F1(D). Two
// bodies remember their dent by a Dent (contact/pair_memory.hpp).
#pragma once

#include <algorithm>
#include <cmath>
#include <concepts>

#include "solver/laws/normal.hpp"

namespace scree {

template <class Base>
struct PlasticLaw : Base {
  using InLayer = void;
  double ratio;        ///< q = k2 / k1
  double adhesive;     ///< k_adh / k1
  double least, most;  ///< dent over overlap, as it is pressed deeper and as it pulls most
  double dent = 0;     ///< s [m], that the pair remembers

  PlasticLaw(const PairLaw& law, double r)
      : Base(law, r), ratio(law.unloading_ratio), adhesive(law.adhesive_ratio), least(law.least_dent), most(law.most_dent) {}

  /// A contact at an overlap, and what it has of its dent.
  struct State {
    double push, push_energy, pull, pull_energy;  ///< [N, J]
    double dent;                                  ///< that it leaves [m]
    double yielded;                               ///< what the change of the dent takes [J]
  };
  State at(double D) const {
    State now{0, 0, adhesive * Base::force(D), adhesive * Base::energy(D), dent, 0};
    if (dent < least * D) {
      now.dent = least * D;
      now.yielded = ratio * Base::kExponent * (1 / least - 1) * (Base::energy(now.dent) - energy_of(dent));
    } else if (adhesive > 0 && dent > most * D) {
      now.dent = most * D;
      now.yielded = ratio * Base::kExponent * (1 - 1 / most) * (Base::energy(dent) - Base::energy(now.dent));
    }
    double force = 0, stored = 0;
    if (D >= now.dent || adhesive > 0) {
      const double of_dent = now.dent > 0 ? Base::force(now.dent) : 0;
      force = ratio * (Base::force(D) - of_dent);
      // the difference of two energies loses its digits where the load has nearly gone: the tangent is steepest at the larger overlap
      const double difference = ratio * (Base::energy(D) - energy_of(now.dent) - of_dent * (D - now.dent));
      stored = std::max(force * force / (2 * ratio * Base::stiffness(std::max(D, now.dent))), difference);
    }
    now.push = std::max(0.0, force + now.pull);
    now.push_energy = stored + now.pull_energy;
    return now;
  }

  /// As it unloads, the steepest.
  double stiffness(double D) const { return ratio * Base::stiffness(D); }
  double pull(double D) const { return adhesive * Base::force(D); }
  double pull_energy(double D) const { return adhesive * Base::energy(D); }
  double pull_stiffness(double) const { return 0; }  ///< it only softens

 private:
  double energy_of(double overlap) const { return overlap > 0 ? Base::energy(overlap) : 0; }
};

/// A law whose contacts remember a dent.
template <class Law>
concept YieldingLaw = requires(Law law) {
  law.dent;
};

/// Fills what PlasticLaw reads.   in   exponent   n of the law
inline void prepare_yielding(double plasticity, double adhesive_ratio, double exponent, PairLaw& law) {
  law.unloading_ratio = 1 / (1 - plasticity);
  law.adhesive_ratio = adhesive_ratio;
  law.least_dent = std::pow(plasticity, 1 / exponent);
  law.most_dent = std::pow(1 + adhesive_ratio * (1 - plasticity), 1 / exponent);
  // the push, which damping and friction go with, has up to 1 + k_adh / k1 times the force of the law
  law.step_stiffness *= std::max(law.unloading_ratio, 1 + adhesive_ratio);
}

}  // namespace scree
