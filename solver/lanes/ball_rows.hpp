// Rows of pairs of balls as lanes take them (ball_forces.hpp).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "solver/bodies/particle_set.hpp"
#include "solver/scene/lane_laws.hpp"

namespace scree {

/// Pairs that are taken at once. A multiple of the lanes of every vector.
inline constexpr std::size_t kBallPairs = 64;

/// A plane or cylinder of a wall as a ball meets it. Aligned so that a row is found by its index alone.
struct alignas(256) BallWall {
  Vec3 x;  ///< of the wall frame's origin [m]
  Quat q;
  Vec3 v, w;            ///< half a step before
  Vec3 pivot, pivot_v;  ///< see PairVelocities
  Vec3 point, direction;
  double radius = 0;  ///< of a cylinder [m]; 0: a plane
};

/// What pairs read of a body, in one place: two lines of the cache instead of seven.
struct alignas(128) BallRow {
  Vec3 x;
  double radius;  ///< of the ball
  Vec3 v;
  double inverse_mass;
  Vec3 w;
  double equivalent_radius;
  Quat q;
};

/// What pairs are of: A always a ball, B a ball or a wall.
struct BallScene {
  const ParticleSet& p;
  const Periodicity& periodicity;
  const LaneLaws& laws;
  std::vector<BallWall> walls{};  ///< one for each of laws.zones
  const BallRow* rows = nullptr;  ///< of all bodies of `p` as they are now; null: what pairs read is collected from the columns
};

/// Some pairs, A and B as in BodyPair; all with balls or all with walls.
struct BallPairs {
  std::size_t count = 0;
  bool with_walls = false;
  alignas(64) std::array<std::int64_t, kBallPairs> a, b;  ///< rows of the particle set; b of `walls` where they are with walls
};

/// Four numbers of each pair, next to each other.
using BallFours = std::array<double, 4 * kBallPairs>;

/// What pairs that touch have kept from the step before, and keep for the next: their springs as in FrictionSpring (x, y, z, stiffness),
/// and how B was turned against A when they were set (x, y, z, w).
struct BallSprings {
  alignas(64) std::array<std::int64_t, kBallPairs> law;  ///< row of LaneLaws
  alignas(64) std::array<double, kBallPairs> kept;       ///< 1: has them from the step before; 0: touches since
  alignas(64) BallFours spring, turn, rolling;
  alignas(64) BallFours normal;  ///< x, y, z, and a place that is left
};

/// What pairs do to their bodies, world axes; as in PairResult.
struct BallForces {
  /// In fours, a vector and a number: force and overlap over maximum overlap, torque on A and elastic energy, torque on B and energy of
  /// springs; then the same three vectors of what is dissipative, and nothing.
  static constexpr std::size_t kFours = 6;
  alignas(64) std::array<BallFours, kFours> fours;
  alignas(64) std::array<double, kBallPairs> left;  ///< 1: the pair does not touch, or the general path is to compute it; what is here is
                                                    ///< nothing, and its springs are as they were
  alignas(64) std::array<double, kBallPairs> gap;   ///< of the surfaces, as find_ball_gaps() [m]
};

/// What some pairs have in common.
struct BallSummary {
  bool some_left = false;  ///< see BallForces::left
  double largest = 0;      ///< overlap over maximum overlap, of those that are not left
};

}  // namespace scree
