// From the forces of one step to the places of the next, in one pass over balls: what pairs did to a ball is added up, the ball gets its
// second kick, what damping and friction took from it is counted, and the next step kicks and moves it. The bits are those of the passes
// that do one of these each (ball_sums.hpp, bodies/motion.hpp, bodies/body_passes.hpp), but each number of a body is read and written once:
// forces do not leave the registers.
//
// While balls go so, what moves of them lies in groups of eight, each number of all eight together: vectors are loaded as they lie, and a
// large bed goes through memory in few streams. The columns of the particle set are out of date until they are written back.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "solver/bodies/particle_set.hpp"
#include "solver/lanes/ball_rows.hpp"
#include "solver/lanes/ball_sums.hpp"

namespace scree {

/// Eight balls, or fewer and some that nothing moves.
struct alignas(64) BallGroup {
  static constexpr std::size_t kBalls = 8;
  using Eight = std::array<double, kBalls>;
  std::array<Eight, 3> x, x_remainder, v, L;  ///< as in ParticleSet
  std::array<Eight, 4> q, q_remainder;        ///< w, x, y, z
  Eight dissipated;
  Eight mass, inverse_mass, inverse_inertia, radius;  ///< these stay
};
inline std::size_t group_count(const ParticleSet& p) { return (p.owned + BallGroup::kBalls - 1) / BallGroup::kBalls; }

/// Groups [begin, end) of the owned rows of p, all of them balls.   out   rows   of whole groups
void group_balls(const ParticleSet& p, std::size_t begin, std::size_t end, BallGroup* groups, BallRow* rows);
/// The other way round.   in   rows   of the present places
void ungroup_balls(const BallGroup* groups, const BallRow* rows, std::size_t begin, std::size_t end, ParticleSet& p);

struct BallMotion {
  BallSums sums;
  const std::uint8_t* summed;  ///< of each body 1: its forces are in the columns of `p` already
  ParticleSet& p;              ///< in a periodic cell, that is no sheared one, a body that leaves it has its image and listed place changed
  Vec3 gravity;                ///< [m/s^2]
  double dt;                   ///< of both steps [s]
  double share;                ///< of its radius that a ball may go in a step
  BallGroup* groups;           ///< become those of the new places
  BallRow* rows;               ///< the same, of whole groups
};

struct BallsMoved {
  double squared_speed = 0;  ///< the largest with which they went [m^2/s^2]; those that are no numbers are left out
  bool go_far = false;       ///< some may have gone farther than the share of their radius, or to no place (not a number)
};

/// Moves groups [begin, end), all of them balls that nothing but pairs and gravity acts on.
/// Threads: local, each thread takes groups of its own. Cost: with AVX-512, of a ball with five contacts, some 40 cycles.
BallsMoved move_balls(const BallMotion& motion, std::size_t begin, std::size_t end);

}  // namespace scree
