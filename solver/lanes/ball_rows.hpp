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
  Vec3 x;               ///< of the wall frame's origin [m]
  Quat q;               ///< with zeros of the sign that RelativePose gives them
  Vec3 w;               ///< half a step before
  Vec3 pivot, pivot_v;  ///< see PairVelocities
  Vec3 point, direction;
  double radius = 0;  ///< of a cylinder [m]; 0: a plane
};

/// A vector as lanes load it: four numbers, of which the last is not used.
struct alignas(32) PaddedVec3 {
  Vec3 v;
  double unused = 0;
};

/// What pairs read of a body, in one place: a line and a half of the cache.
struct alignas(32) BallRow {
  PaddedVec3 x, v, w;
};

/// Rows of bodies [begin, end) of p, which has at least one, as they are now.
void collect_ball_rows(const ParticleSet& p, std::size_t begin, std::size_t end, BallRow* rows);

/// What pairs are of: A always a ball, B a ball or a wall.
struct BallScene {
  const ParticleSet& p;
  const Periodicity& periodicity;
  const LaneLaws& laws;
  std::vector<BallWall> walls{};  ///< one for each of laws.zones
  const BallRow* rows = nullptr;  ///< of all bodies of `p` as they are now; null: what pairs read of these is collected from the columns
};

/// What a step reads and writes of eight pairs that touch: five lines of the cache, one after another, and those of the next eight after
/// them. A large bed waits for memory: what lies in one stream is there before it is asked for.
struct alignas(64) BallEight {
  static constexpr std::size_t kPairs = 8;
  std::array<std::int32_t, kPairs> a, b;  ///< rows of the particle set; b of `walls` where pairs are with walls
  /// What pairs have kept from the step before, and keep for the next: the spring of friction in world axes, as in FrictionSpring (x, y, z,
  /// stiffness), each number of all eight together. A stiffness of 0: it touches since.
  std::array<std::array<double, kPairs>, 4> spring;
};

/// Some pairs, A and B as in BodyPair; all with balls or all with walls.
struct BallPairs {
  std::size_t count = 0;
  bool with_walls = false;
  BallEight* eights = nullptr;  ///< of kBallPairs pairs

  BallEight& eight(std::size_t n) const { return eights[n / BallEight::kPairs]; }
  std::int32_t& a(std::size_t n) const { return eight(n).a[n % BallEight::kPairs]; }
  std::int32_t& b(std::size_t n) const { return eight(n).b[n % BallEight::kPairs]; }
  double& spring(std::size_t n, std::size_t number) const { return eight(n).spring[number][n % BallEight::kPairs]; }
};

/// Room for kBallPairs pairs.
using BallEights = std::array<BallEight, kBallPairs / BallEight::kPairs>;

/// Four numbers of each pair, next to each other.
using BallFours = std::array<double, 4 * kBallPairs>;

/// What else pairs keep.
struct BallSprings {
  alignas(64) std::array<std::int64_t, kBallPairs> law;  ///< row of LaneLaws
  alignas(64) BallFours rolling;                         ///< the spring of rolling, of each pair together
};

/// What does not change while the two sides of a pair are the same.
struct BallConstants {
  alignas(64) std::array<double, kBallPairs> radius_a, radius_b;  ///< of the balls [m]; of a wall 0
  alignas(64) std::array<double, kBallPairs> radius;              ///< R* [m]
  alignas(64) std::array<double, kBallPairs> stiffness;           ///< Hertz: push over overlap^(3/2) [N/m^(3/2)]; linear: k [N/m]
  alignas(64) std::array<double, kBallPairs> mobility, mass;      ///< 1/m* [1/kg], m* [kg]
  alignas(64) std::array<double, kBallPairs> inverse_limit;       ///< 1 over the maximum overlap [1/m]
  /// Places that count: 0 where all pairs have the same numbers, so that the first of them, in seven lines of the cache, stand for all.
  std::size_t places = ~std::size_t{0};
};

/// What a pair does to its bodies, world axes, next to each other: bodies read pairs in an order of their own. Torques of balls are
/// dissipative.
struct alignas(32) BallSlot {
  Vec3 force;  ///< on A [N]
  double elastic;
  Vec3 across;   ///< n x tangential force [N], see ball_torque()
  double half;   ///< of the overlap without margins [m]
  Vec3 lost;     ///< what of the force is dissipative [N]
  double ratio;  ///< overlap over maximum overlap
};
/// Of some pairs.
struct BallForces {
  BallSlot* slots = nullptr;                        ///< kBallPairs of them, as are moments
  PaddedVec3* moments = nullptr;                    ///< null where the scene has none
  alignas(64) std::array<double, kBallPairs> left;  ///< 1: the pair does not touch, or the general path is to compute it; what is here is
                                                    ///< nothing, and its springs are as they were
  alignas(64) std::array<double, kBallPairs> gap;   ///< of the surfaces, as find_ball_gaps() [m]
};

/// What some pairs have in common.
struct BallSummary {
  /// Bit n: pair n has its `left` and `gap`. Of a block, vectors without a pair that is left do not write them: `left` counts as 0 there.
  std::uint64_t written = 0;
  bool some_left = false;  ///< see BallForces::left
  double largest = 0;      ///< overlap over maximum overlap, of those that are not left
};

}  // namespace scree
