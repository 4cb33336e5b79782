// What pairs of balls in blocks do, added up for each body.
#pragma once

#include <cstddef>
#include <cstdint>

#include "solver/bodies/particle_set.hpp"
#include "solver/lanes/ball_rows.hpp"

namespace scree {

/// The pairs of each body.
struct BallSums {
  const BallSlot* slots;
  const PaddedVec3* moments;    ///< null where the scene has none
  std::size_t slot_count;       ///< of all pairs
  const std::int32_t* start;    ///< of each body, in `entries`
  const std::int32_t* count;    ///< of each body
  const std::int32_t* entries;  ///< twice the slot, plus 1 for the body that is B
};

/// Force and torque on bodies [begin, end) and what of them is dissipative: the sums over their pairs in the order of the entries, and
/// gravity.
void sum_onto_balls(const BallSums& sums, const Vec3& gravity, std::size_t begin, std::size_t end, ParticleSet& p);

}  // namespace scree
