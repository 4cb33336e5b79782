// Pairs of convex edges of many pairs of meshes at once, one in each lane of a vector.
//
// Of the edges that a step looks at, 97 in 100 are features, two thirds of them faded, since those that are none wait for what they lack
// (candidate_slack.hpp). So lanes have the formula of a feature alone: what comes out as none, or as one that is faded to nothing, is left
// to examine_edges(), which says why. The bits are those of examine_edges() on every instruction set: the same operations in the same
// order, none fused, only those that IEEE 754 rounds exactly.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "solver/features/edge_features.hpp"

namespace scree {

/// Edges and pairs of bodies that are taken at once. Edges: a multiple of the lanes of every vector.
inline constexpr std::size_t kEdgesAtOnce = 64, kPosesAtOnce = 32;

/// A pair of bodies as lanes read it, in the place of RelativePose: sixteen numbers, so that a row is found by its index alone.
struct alignas(128) EdgePose {
  std::array<double, 9> rotation;  ///< B to A, row by row
  Vec3 centre;                     ///< of B, A frame [m]
  double scale_a, scale_b;
  double margin;  ///< [m]
  double unused = 0;

  EdgePose() = default;
  EdgePose(const RelativePose& pose, const PairBody& a, const PairBody& b, double up_to)
      : centre(pose.centre), scale_a(a.scale), scale_b(b.scale), margin(up_to) {
    for (std::size_t row = 0; row < 3; ++row) {
      rotation[3 * row] = pose.rotation[row].x;
      rotation[3 * row + 1] = pose.rotation[row].y;
      rotation[3 * row + 2] = pose.rotation[row].z;
    }
  }
};

/// Candidates. Both shapes have rows of their edges.
struct EdgeQueue {
  std::size_t count = 0;
  std::array<EdgePose, kPosesAtOnce> poses;
  alignas(64) std::array<std::int64_t, kEdgesAtOnce> pose;  ///< row of `poses`
  std::array<const EdgeRow*, kEdgesAtOnce> a, b;
  bool has_walls = false;  ///< edges of B may be folds of walls, which are touched from both sides

  void add(std::size_t of_pose, const EdgeRow& of_a, const EdgeRow& of_b) {
    pose[count] = static_cast<std::int64_t>(of_pose);
    a[count] = &of_a;
    b[count] = &of_b;
    ++count;
  }
};

/// What they are, as in ContactFeature, four numbers of each edge next to each other.
struct EdgeAnswers {
  using Fours = std::array<double, 4 * kEdgesAtOnce>;
  alignas(64) Fours place;      ///< x, overlap
  alignas(64) Fours direction;  ///< n, weight
  alignas(64) Fours force;      ///< of the weight's gradient, 0 where it has none; 1: a feature; 0: examine_edges() is to be asked
  alignas(64) Fours couple;     ///< of the same; 1: the weight depends on the pose

  bool found(std::size_t k) const { return force[4 * k + 3] > 0; }
  /// Without key and cluster, which do not depend on the pose.
  ContactFeature feature(std::size_t k) const {
    const auto at = [k](const Fours& fours) { return Vec3{fours[4 * k], fours[4 * k + 1], fours[4 * k + 2]}; };
    return {at(place), place[4 * k + 3], at(direction), direction[4 * k + 3], {at(force), at(couple)}, 0, 0, couple[4 * k + 3] > 0};
  }
};

/// Fills up to the lanes of a vector what is beyond queue.count.
void examine_edges_at_once(EdgeQueue& queue, EdgeAnswers& answers);

}  // namespace scree
