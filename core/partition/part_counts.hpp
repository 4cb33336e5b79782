// What the parts of a cut hold and would exchange in each step: counted, not run.
#pragma once

#include <span>
#include <vector>

#include "core/geometry/vec3.hpp"

namespace scree {

/// What the solver sends of a ghost in a step [bytes]: position, velocity, angular velocity and orientation.
inline constexpr double kBytesPerGhost = 13 * sizeof(double);

/// One number for each part.
struct PartCounts {
  std::vector<double> work, bodies;
  std::vector<double> neighbours;  ///< parts from which it receives
  std::vector<double> ghosts;      ///< that it receives
  std::vector<double> sent;        ///< in a step [bytes]
};

/// A body is a ghost of every other part whose box of the balls of its own bodies it reaches into: what the solver sends.
/// in   part    of each body, from 0 to parts - 1
/// in   x       of each body [m]
/// in   reach   radius of the ball about it that holds all that it acts on: bounding radius, margin and half the skin of the lists [m]
/// in   work    of each body
/// Cost: O(bodies) and the ghosts.   Limits: images through periodic sides are not counted.
PartCounts count_parts(std::span<const int> part, std::span<const Vec3> x, std::span<const double> reach, std::span<const double> work,
                       int parts);

}  // namespace scree
