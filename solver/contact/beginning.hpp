// What a contact begins with: the energy that it is about to take up.
#pragma once

#include <array>
#include <cstddef>

#include "solver/contact/pair_force.hpp"

namespace scree {

enum ImpactPart : std::size_t { kNormalImpact, kShearImpact, kImpactParts };

/// What a contact begins with.
struct Beginning {
  double overlaps = 0;  ///< sum of those above 0 [m]; 0: nothing begins
  std::array<double, kImpactParts>
      energy{};  ///< of the motion along the wrench of unit pressures at the features, and along the surfaces [J]
};
/// in   friction_dt   the step that lies behind the pair [s]; 0: none, as at the start
Beginning beginning_of(const PairFeatures& features, const PairMotion& motion, double friction_dt);

}  // namespace scree
