// The example of docs/develop/extending.md, "A law": a linear spring that also attracts, by a constant force from a gap beyond the margins.
#pragma once

#include "solver/laws/normal.hpp"

namespace scree {

struct ConstantPull : LinearLaw {
  using InLayer = void;                   ///< does not go with gather = "area"
  static constexpr double kForce = 0.1;   ///< F0 [N]
  static constexpr double kReach = 1e-4;  ///< delta [m]
  static void prepare(const LawInput& in, PairLaw& law) {
    LinearLaw::prepare(in, law);
    law.reach = kReach;
  }
  using LinearLaw::LinearLaw;
  double pull(double /*D*/) const { return kForce; }
  double pull_energy(double D) const { return kForce * (D + kReach); }
  double pull_stiffness(double /*D*/) const { return 0; }
};

}  // namespace scree
