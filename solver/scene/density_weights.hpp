// Weights of vertices by density: what makes stiffness tend to a limit as the mesh of a curved surface is refined.
//
// The overlap of a pair is D = (sum a_j d_j^8)^(1/8) over its features. With a_j = 1 it grows without limit as a curved surface is refined,
// since ever more features carry. Each vertex therefore has a weight, made once, in the frame of its shape:
//
//   w_i = 1 / sum_j K(|X_i - X_j| / r),   K(y) = (1 - y^2)^2 for y < 1, else 0 (j = i included),   r = c sqrt(R eps)
//
// over the vertices where the surface is not flat; R is the radius of the ball of the body's volume, eps the margin of one body. A cluster
// within r counts as one vertex, an isolated one keeps 1 exactly. In a contact the radius follows D (contact/cluster_weights.hpp): the
// tables hold the weights at D = eps. An edge pair has the mean of the weights of its four ends.
// Source: docs/reference/contact-law.md section 6, with what was measured there.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <vector>

#include "solver/scene/solver_shape.hpp"

namespace scree {

/// c above, sqrt(2/3): with it D is the overlap of smooth bodies of any two radii (contact/cluster_weights.hpp).
inline constexpr double kDensityRadius = 0.816496580927726;

/// Weights of all corners of a shape for a radius in its own frame [m], in the order of its feature table. Empty where all are 1.
/// Cost: O(n + pairs within r), in parallel.   Fails: never.
std::vector<double> density_weights(const SolverShape& shape, double radius);

/// The weights of a scene's shapes, made when a body first needs them: one table for each shape and half octave of scale. The radius
/// follows sqrt(scale), D its fourth root, so that within half an octave D errs by at most 2.2 %; and the table of a body never changes,
/// so that its energy is exact.
class DensityWeights {
 public:
  /// Whether all tables hold weights for one D, or each for the margin of its shape: one table then serves all scales.
  enum class Depth { one, of_shape };
  /// in   depth   the D that the tables hold weights for [m]: the margin of one body, or what stands for it in an attraction; of walls
  ///              where bodies have margins of their own
  DensityWeights(double depth, Depth of) : depth_(depth), of_(of) {}
  /// null where all are 1.   Threads: safe.   The pointer holds as long as this object.
  const double* of_body(const SolverShape& shape, std::int32_t index, double scale);
  /// Of a wall, whose surface has no radius of its own: R is that of the largest body.
  const double* of_wall(const SolverShape& shape, std::int32_t index, double scale, double body_radius);
  /// The same of a wall as it is worn, which is kept by the caller; empty where all are 1.
  std::vector<double> of_worn_wall(const SolverShape& shape, double scale, double body_radius) const;
  struct Summary {
    std::size_t tables = 0, bytes = 0;  ///< of shapes where some vertices are a cluster
    double least = 1;                   ///< smallest weight
  };
  Summary summary() const;

 private:
  const double* find(const SolverShape& shape, std::int32_t index, double radius);

  double depth_;
  Depth of_;
  mutable std::mutex mutex_;
  std::map<std::pair<std::int32_t, double>, std::vector<double>> tables_;  ///< by shape and radius in its frame [m]
};

/// Scale that stands for all within its half octave: a power of the square root of 2, 1 for those from 2^(-1/4) to 2^(1/4).
double half_octave(double scale);

}  // namespace scree
