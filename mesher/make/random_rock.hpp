// Random particles of given form: rocks with rounded or rough surfaces, and crushed stones with flat faces.
#pragma once

#include <cstdint>

#include "core/geometry/triangle_mesh.hpp"

namespace scree {

/// Targets of a random particle; elongation and flatness are met to kFormTolerance, as descriptors.hpp measures them.
struct RockForm {
  double diameter = 1;           ///< of the ball of equal volume [m]
  double elongation = 0.8;       ///< I / L, in (0, 1]
  double flatness = 0.8;         ///< S / I, in (0, 1]
  double roughness = 0.1;        ///< rock: rms height of the bumps over the mean radius, below 0.4; stone: unused
  std::int32_t triangles = 320;  ///< rock: exactly this many when even (a closed mesh has no odd count); stone: planes - see there
  std::uint64_t seed = 1;
};

inline constexpr double kFormTolerance = 0.01;

/// A rock: bumps of eight octave-spaced wave lengths on a ball, stretched until its principal box has the wanted sides.
///
/// How: an icosphere finer than wanted is displaced along its radii by a sum of random waves whose power falls with the
/// square of the frequency, stretched along its principal axes in a few rounds, and simplified to the triangle count.
/// Star-shaped about its centre, so it never crosses itself before simplification.
/// Fails: UsageError for a form out of range.   Same form, same rock, on every machine with IEEE arithmetic.
TriangleMesh random_rock(const RockForm& form);

/// Planes that cut a stone of so many triangles: an eighth of them, at least six.
int planes_of_stone(std::int32_t triangles);
/// A crushed stone: a ball-like hull cut by planes_of_stone() random planes, so that flat faces meet in sharp edges, and
/// stretched as a rock is. Convex. The number of triangles follows from the faces.
TriangleMesh crushed_stone(const RockForm& form);

}  // namespace scree
