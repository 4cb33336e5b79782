// Forces of pairs of meshes side by side, one pair in each lane of a vector.
//
// Corners and edges are found pair by pair, since most of a search is branches; the law of what was found is arithmetic alone. Pairs with
// the same number of features go together, so that no lane waits for another: a loop over the features of all of them at once, in
// ascending order of their keys. Sums over the features of a pair stay within its lane and so have the order of the general path; with
// the rules of ball_forces.hpp (the same operations, none fused, only those that IEEE 754 rounds exactly) the bits are those of
// chosen_law.cpp on every instruction set. What lanes have no formula for they leave to it in that step.
// Source of the law: docs/reference/contact-law.md sections 3.2 to 3.4.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "solver/lanes/ball_forces.hpp"

namespace scree {

/// Pairs that are taken at once: as many as the widest vector has lanes.
inline constexpr std::size_t kMeshPairs = 8;

/// A number, and four of them next to each other, of each pair.
using MeshNumbers = std::array<double, kMeshPairs>;
using MeshFours = std::array<double, 4 * kMeshPairs>;

/// One feature of each pair, A frame.
struct MeshFeature {
  /// Of ContactFeature what comes before `faded`, as it lies there; the gradient is zero where the weight does not depend on the pose.
  static constexpr std::size_t kRow = 16;
  alignas(64) std::array<std::array<double, kRow>, kMeshPairs> row;
  alignas(64) MeshNumbers kept;  ///< 1: has a spring from the step before
  alignas(64) MeshFours spring;  ///< in and out, as in FrictionSpring (x, y, z, stiffness)
  alignas(64) MeshFours normal;  ///< of the spring, and a place that is left

  // scratch: the same rows, each number of all pairs together, and the part of the push of each [N]
  alignas(64) std::array<MeshNumbers, 3> x, n, gradient_force, gradient_couple;
  alignas(64) MeshNumbers overlap, weight, push;
};

/// Some pairs of two bodies with as many features each.
struct MeshPairs {
  std::size_t count = 0;
  alignas(64) std::array<std::int64_t, kMeshPairs> a, b;  ///< rows of the particle set
  alignas(64) std::array<std::int64_t, kMeshPairs> law;   ///< row of LaneLaws
  alignas(64) MeshNumbers max_overlap, cluster_share;     ///< see PairView, PairFeatures
  alignas(64) MeshNumbers turned;                         ///< 1: `turn` is how B was turned against A when the springs were set
  alignas(64) MeshFours turn;                             ///< in and out, x y z w
  std::array<std::int32_t, kMeshPairs> index;             ///< in the list of pairs
  std::vector<MeshFeature> features;
};

/// What pairs do to their bodies, as BallForces.
struct MeshForces {
  /// In fours, a vector and a number, as PairResult: force and overlap over maximum overlap, torque on A and elastic energy, torque on B
  /// and energy of springs; then the same three vectors of what is dissipative, and nothing.
  static constexpr std::size_t kFours = 6;
  alignas(64) std::array<MeshFours, kFours> fours;
  alignas(64) MeshNumbers left;  ///< 1: the general path is to compute the pair; its springs are spoilt here, not in the pair
};

/// in   dt   of the run, and of springs [s], > 0
void find_mesh_forces(const BallScene& scene, double dt, MeshPairs& pairs, MeshForces& forces);

}  // namespace scree
