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
  // what the energies are made of; about the centre of A, in its axes
  double speed = 0;    ///< sum of overlap times speed along the normal [m^2/s], below 0 where they come closer
  Vec3 force, torque;  ///< of unit pressures on A: sums of overlap times normal [m], and of its moment [m^2]
  Vec3 slip, place;    ///< sums of overlap times sliding velocity of A [m^2/s], and times place [m^2]
};
/// in   friction_dt   the step that lies behind the pair [s]; 0: none, as at the start
Beginning beginning_of(const PairFeatures& features, const PairMotion& motion, double friction_dt);

}  // namespace scree
