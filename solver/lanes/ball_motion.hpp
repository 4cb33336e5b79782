// From the forces of one step to the places of the next, in one pass over balls: what pairs did to a ball is added up, the ball gets its
// second kick, what damping and friction took from it is counted, and the next step kicks and moves it. The bits are those of the passes
// that do one of these each (ball_sums.hpp, bodies/motion.hpp, bodies/body_passes.hpp), but each number of a body is read and written once:
// forces do not leave the registers.
#pragma once

#include <cstddef>
#include <cstdint>

#include "solver/bodies/particle_set.hpp"
#include "solver/lanes/ball_rows.hpp"
#include "solver/lanes/ball_sums.hpp"

namespace scree {

struct BallMotion {
  BallSums sums;
  const std::uint8_t* summed;  ///< of each body 1: its forces are in the columns already
  Vec3 gravity;                ///< [m/s^2]
  double dt;                   ///< of both steps [s]
  BallRow* rows;               ///< become those of the new places
};

/// Moves rows [begin, end) of p, all of them balls that nothing but pairs and gravity acts on. Forces, torques and what of them is
/// dissipative are left as they were.
/// Returns the largest squared speed with which they went [m^2/s^2]; speeds that are no numbers are left out.
/// Threads: local, each thread takes rows of its own. Cost: with AVX-512, of a ball with five contacts, some 55 cycles.
double move_balls(const BallMotion& motion, std::size_t begin, std::size_t end, ParticleSet& p);

}  // namespace scree
