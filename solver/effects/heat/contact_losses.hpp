// What contacts take from the motion, contact by contact: what heats bodies where [heat] friction_heat is on.
#pragma once

#include <cstddef>
#include <vector>

#include "solver/state/run_state.hpp"

namespace scree {

/// What damping, friction and rolling resistance of a pair take from both sides in a time at the present velocities [J], what their springs
/// store included. The sum over all pairs is that of contact_dissipation() and add_wall_effects().
/// Ghosts must have the velocities of their owners.
double contact_loss(const RunState& s, std::size_t pair, double dt);

/// What the springs of a pair store [J]: PairResult::tangential_elastic after its force has been computed.
double stored_in_springs(const BodyPair& pair);

}  // namespace scree
