// Forces of pairs of balls (analytic spheres), and of balls on planes and in cylinders of walls, one pair in each lane of a vector.
//
// Such a pair has one contact and one spring. Nothing that meshes need is made for them: no lists of candidates, no features, no frame of
// the pair. The bits are those of single pairs (contact/ball_contact.hpp) in every lane, on every instruction set: each lane does the same
// operations in the same order, no product and sum are fused, and only operations that IEEE 754 rounds exactly occur. So what a lane has no
// formula for (a step in which damping is limited, springs of another number, numbers that are none) it leaves to the loop over single
// pairs.
// Source of the law: docs/reference/contact-law.md sections 3.2 to 3.4.
#pragma once

#include "solver/lanes/ball_rows.hpp"

namespace scree {

/// Gaps between the surfaces of pairs [m].   out  gap   kBallPairs numbers
void find_ball_gaps(const BallScene& scene, BallPairs& pairs, double* gap);

/// Makes the lanes beyond the last pair repeat it: all functions below ask for that.
void repeat_last_pair(BallPairs& pairs, BallSprings& springs);

/// in   springs   the laws of the pairs
void find_ball_constants(const BallScene& scene, const BallPairs& pairs, const BallSprings& springs, BallConstants& constants);

/// The forces of pairs that touch, and their springs after them; those of pairs that do not are left.
/// in   dt   of the run, and of springs [s], > 0
/// in   constants   where not null, of these pairs; bodies are read from scene.rows then, and pairs with walls are all with the same one
BallSummary find_ball_forces(const BallScene& scene, double dt, const BallPairs& pairs, const BallConstants* constants,
                             BallSprings& springs, BallForces& forces);

}  // namespace scree
