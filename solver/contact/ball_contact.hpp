// The force of a contact of a ball with a ball, a plane or a cylinder, one pair at a time: what lanes compute for many
// (lanes/ball_forces.hpp), with the same bits, and what they leave out: damping that is limited (laws/damping.hpp), a law beyond its
// maximum overlap (contact/overlap_limit.hpp), records of a contact. Of pairs of which is_ball_contact() says so; others go by
// pair_force.hpp.
//
// Springs are in world axes: one of friction, where the scene rolls one of rolling after it, and no turn.
// Source of the law: docs/reference/contact-law.md sections 3.2 to 3.4.
#pragma once

#include <vector>

#include "solver/contact/pair_force.hpp"
#include "solver/features/pair_view.hpp"
#include "solver/laws/laws.hpp"

namespace scree {

struct BallContact {
  const PairView& view;
  const PairVelocities& velocities;
  const ContactFeature& feature;
  const PairLaw& law;
  double radius;                          ///< R* [m], where the law needs it
  double inverse_mass_a, inverse_mass_b;  ///< [1/kg]; of a wall 0
};

/// World axes. `force` as PairForce with A not turned; torques about the centres of both, of a wall none: who needs it has a point of its
/// own.
struct BallForce {
  PairForce force;
  Vec3 torque_b;
};

/// in, out as PairForceFunction; outputs: one, where not null.
using BallForceFunction = BallForce (*)(const BallContact& contact, double dt, double friction_dt, std::vector<FrictionSpring>& springs,
                                        std::vector<ContactOutput>* outputs);

/// Of a scene that has lane laws.
BallForceFunction ball_force_function(const LawChoice& choice);

/// Springs of checkpoints before version 6 are in the frame of A, with a turn; and those of a run that another begins with may be of the
/// other kind of pair. Makes them those of the pair.   in   q   of A, when they were set
void set_axes_of_springs(bool ball_contact, const Quat& q, std::vector<FrictionSpring>& springs);

}  // namespace scree
