// A pair in contact, linearised: what the critical step is found from.
#pragma once

#include <array>
#include <cstdint>

#include "solver/contact/pair_force.hpp"

namespace scree {

/// Linear stiffness [1/s^2] and damping [1/s] of a pair on the velocities of its bodies scaled by the root of mass and
/// principal moments: linear then angular of A in its principal axes, then those of B in its own; row-major 12 x 12, symmetric.
struct PairStiffness {
  PairKey key;
  std::int32_t a = 0, b = -1;  ///< rows of the particle set; b is -1 for a wall
  std::array<double, 144> stiffness{}, damping{};
  /// Adds stiffness s and damping c along a mode, a mass-normalised wrench.
  void add_mode(double s, double c, const std::array<double, 12>& mode);
};

/// Wrench of a unit force f on A at x (and -f on B), mass-normalised in the principal axes of both.
std::array<double, 12> mode_of(const PairMotion& m, const Vec3& x, const Vec3& f);

/// A pair in contact as a model linearises it. `n` and levers of the features in the frame of A, as everywhere in the pair arithmetic.
struct LinearContact {
  const PairFeatures& features;
  const PairForce& force;
  const PairMotion& motion;
  const PairLaw& law;
  PairStiffness& result;

  /// Adds a point with its tangent stiffness [N/m], its push [N] and the chi of its damping [s/m], and friction of push / overlap along.
  /// in   exponent   tangent stiffness of the push over its secant
  void add_point(const Vec3& x, const Vec3& n, double stiffness, double push, double chi, double overlap, double exponent) const;
};

using LineariseFunction = void (*)(const LinearContact& contact);

}  // namespace scree
