// A pair of bodies, or of a body and a wall zone: what it keeps between steps, and what it did in this one.
#pragma once

#include <cstdint>
#include <memory>

#include "solver/bodies/particle_set.hpp"
#include "solver/contact/pair_force.hpp"

namespace scree {

/// Kept between steps.
struct BodyPair {
  PairKey key;
  std::int32_t a = 0, b = 0;              ///< rows in ParticleSet; b is -1 for a wall zone
  std::unique_ptr<CandidateLists> lists;  ///< none until they are made; balls that go in lanes need none (lanes/ball_forces.hpp)
  PairState state;
};

/// Whether this rank counts a pair in sums over the scene: the owner of A does.
inline bool counts_here(const BodyPair& pair, const ParticleSet& p) { return static_cast<std::size_t>(pair.a) < p.owned; }

/// Written by one thread per pair and step, read by the gather. World axes; force on b is -force_a; torques about each body's centre. Each
/// vector lies with one number: so lanes write them (neighbours/lane_rows.hpp).
struct PairResult {
  bool active = false;
  std::int32_t contact_count = 0;
  Vec3 force_a;
  double overlap_ratio = 0;  ///< largest_overlap over margin sum
  Vec3 torque_a;
  double elastic = 0;
  Vec3 torque_b;
  double tangential_elastic = 0;
  Vec3 dissipative_force_a;
  double surface_power = 0;  ///< of a wall's surface that moves [W]
  Vec3 dissipative_torque_a;
  double none = 0;
  Vec3 dissipative_torque_b;
  double nothing = 0;
};

/// What a step reads of a pair that nothing can happen to: kept apart from all else, 16 bytes.
struct IdlePair {
  std::int32_t a, b;  ///< as in BodyPair
  double way;         ///< of both together: until they have gone it the pair has no features [m]
};
inline constexpr double kNeverIdle = -1;  ///< such a pair is looked at in every step
inline constexpr double kTouching = -2;   ///< and so is one that touched in the last, which most likely still does

}  // namespace scree
