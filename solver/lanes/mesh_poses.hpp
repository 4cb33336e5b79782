// Poses of some pairs of meshes at once, one pair in each lane of a vector: what a step asks of every pair that is not idle before it looks
// at any candidate. The bits are those of RelativePose and follow_motion() on every instruction set: the same operations in the same order,
// none fused, only those that IEEE 754 rounds exactly.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "solver/bodies/particle_set.hpp"
#include "solver/features/pair_features.hpp"

namespace scree {

/// Pairs of two bodies with lists of candidates.
struct MeshPoses {
  static constexpr std::size_t kPairs = 8;  ///< that are taken at once: as many as the widest vector has lanes

  std::size_t count = 0;
  alignas(64) std::array<std::int64_t, kPairs> a, b;  ///< rows of the particle set
  std::array<std::int32_t, kPairs> index;             ///< in the list of pairs
  std::array<CandidateLists*, kPairs> lists;

  // found
  alignas(64) std::array<RelativePose, kPairs> pose;
  alignas(64) std::array<double, kPairs> moved;          ///< what follow_motion() returns [m]
  alignas(64) std::array<double, kPairs> squared_speed;  ///< no point of the smaller body is faster against the larger one [m^2/s^2]
};

/// Finds them for the bodies of p, with the velocities of half a step before; adds to the ways of the lists.
void find_mesh_poses(const ParticleSet& p, MeshPoses& pairs);

}  // namespace scree
