// Forces of pairs of balls (analytic spheres), and of balls on planes and in cylinders of walls, one pair in each lane of a vector.
//
// Such a pair has one contact and one spring. Nothing that meshes need is made for them: no lists of candidates, no features, no frame of
// the pair but what the law asks for. The bits are those of the general path (sphere_pair.cpp, pair_view.cpp, chosen_law.cpp) in every
// lane, on every instruction set: each lane does the same operations in the same order, no product and sum are fused, and only
// operations that IEEE 754 rounds exactly occur. So a pair may go either way in any step, and does: what a lane has no formula for (a
// step in which damping is limited, a spring of another kind, numbers that are none) it leaves to the general path.
//
// Two terms of the general path are not computed since they never change its result; ball_forces.cpp says why.
// Source of the law: docs/reference/contact-law.md sections 3.2 to 3.4.
#pragma once

#include "solver/lanes/ball_rows.hpp"

namespace scree {

/// Gaps between the surfaces of pairs [m].   out  gap   kBallPairs numbers
void find_ball_gaps(const BallScene& scene, BallPairs& pairs, double* gap);

/// The forces of pairs that touch, and their springs after them; those of pairs that do not are left.
/// in   dt   of the run, and of springs [s], > 0
BallSummary find_ball_forces(const BallScene& scene, double dt, BallPairs& pairs, BallSprings& springs, BallForces& forces);

}  // namespace scree
