// The contact law of one body pair: one smooth p-norm potential over its unique features, with the exact force,
// damping from restitution, and Coulomb friction with history per feature. Source: CONTACT.md sections 3.2 to 3.4.
#pragma once

#include <cstdint>
#include <vector>

#include "solver/pair_features.hpp"

namespace scree {

/// Friction memory of one feature: spring force on A (A frame) and the stiffness it was built with.
struct FrictionSpring {
  std::int64_t key;
  Vec3 force;       ///< [N]
  double stiffness; ///< kappa [N/m]
};

/// Velocities and inverse masses of both sides, A frame (its principal axes, origin at its centre).
struct PairMotion {
  Vec3 v_a, w_a, v_b, w_b;
  Vec3 centre_b;                         ///< of B [m]
  double inverse_mass_a, inverse_mass_b;
  Vec3 inverse_inertia_a;                ///< principal
  Vec3 inverse_inertia_b;                ///< principal of B
  Mat3 b_to_a;
};

/// What a pair does to its bodies, A frame; torque about A's centre.
struct PairForce {
  Vec3 force, torque;                    ///< on A, everything
  Vec3 lossy_force, lossy_torque;        ///< on A, from damping and friction alone
  double elastic = 0;                    ///< U [J]
  double tangential_elastic = 0;         ///< stored in friction springs [J]
  double deepest = 0;                    ///< largest depth [m]
};

/// One contact as it is written to frames.
struct ContactOutput {
  double normal_force;                   ///< on A along n [N], damping included
  Vec3 tangential_force;                 ///< on A, A frame [N]
};

/// Norm of the potential: larger values make stiffness depend less on the number of features, but sharpen forces.
inline constexpr int kNorm = 8;

// Damping and the step. A force that depends on velocity is evaluated with the velocity half a step before, and a contact
// starts somewhere inside a step: both are errors of first order in the step, of 2.5e-2 and 5e-3 in the restitution at 20
// and 100 steps a contact in the worst case. Two corrections make them of second order (1.4e-3, 4e-5):
// - lag: with damping rate r = c / m*, m* a = -c v(t - dt/2) acts as mass m* (1 - r dt / 2) and damping c. Dividing the rate
//   by 1 + r dt / 4 keeps the damping ratio.
// - onset: a feature at depth d that closes at speed v has been in touch for d / v. When that is less than a step, the
//   impulse of this force evaluation stands for d / v + dt / 2 instead of dt.

/// in   features   ascending keys, depth > 0
/// in   dt         step of the run [s], for damping (see above); 0: none is made
/// in   friction_dt  step of the friction update [s]: dt, or 0 to leave the springs as they are
/// inout springs   sorted by key; replaced by those of the present features (left empty when friction is 0)
/// out  outputs    one per feature when not null
PairForce pair_force(const std::vector<ContactFeature>& features, const PairLaw& law, const PairMotion& motion,
                     double dt, double friction_dt, std::vector<FrictionSpring>& springs,
                     std::vector<ContactOutput>* outputs);

}  // namespace scree
