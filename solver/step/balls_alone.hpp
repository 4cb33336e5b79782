// Which runs are of balls alone, so that their steps may go without a break (step/ball_steps.hpp): one rank, no effects that act, no sleep,
// fluid or inlets, a cell that does not deform, planes and cylinders without surfaces that move or answer to force, a law that lanes have
// for all pairs of materials that are given, fixed steps.
#pragma once

#include "solver/state/run_state.hpp"

namespace scree {

/// Whether nothing but pairs of balls and gravity acts in a run, but for effects.   Cost: in a run that may be one, a look at each body.
bool are_balls_alone(const RunState& s);
/// Whether effects leave the steps to come alone, too.
bool are_effects_idle(const RunState& s);

}  // namespace scree
