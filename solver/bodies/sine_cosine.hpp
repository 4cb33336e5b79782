// Sine and cosine of the angles by which bodies turn in a step: the same bits on every processor, which those of the library are not.
#pragma once

#include <cmath>

namespace scree {

/// Up to here five terms of the series are exact to rounding: the terms left out are below 3e-19. Half the turn of a body in a step is at
/// most 0.05 (kTurnPerStep).
inline constexpr double kSmallAngle = 1.0 / 16;

/// Larger angles, for whoever asks: the nearest multiple of a right angle is taken off exactly (IEEE 754 defines its bits), and eight terms
/// and one of the series are exact to rounding for the rest. Infinite angles and numbers that are none give NaN.
/// Errors: 1.5 units in the last place of 1, and for each right angle 6e-17, by which pi / 2 is rounded.
inline void sine_and_cosine_of_any(double a, double& sine, double& cosine) {
  constexpr double kRightAngle = 1.57079632679489662;
  int turns = 0;
  const double r = std::remquo(a, kRightAngle, &turns), rr = r * r;
  const double s =
      r - r * rr *
              (1.0 / 6 -
               rr * (1.0 / 120 - rr * (1.0 / 5040 - rr * (1.0 / 362880 -
                                                          rr * (1.0 / 39916800 - rr * (1.0 / 6227020800 - rr * (1.0 / 1307674368000)))))));
  const double c =
      1 - rr * (0.5 - rr * (1.0 / 24 -
                            rr * (1.0 / 720 - rr * (1.0 / 40320 -
                                                    rr * (1.0 / 3628800 - rr * (1.0 / 479001600 - rr * (1.0 / 87178291200 -
                                                                                                        rr * (1.0 / 20922789888000))))))));
  switch (turns & 3) {
    case 0:
      sine = s, cosine = c;
      break;
    case 1:
      sine = c, cosine = -s;
      break;
    case 2:
      sine = -s, cosine = -c;
      break;
    default:
      sine = -c, cosine = s;
      break;
  }
}

/// Cost: a tenth of the library's time where the angle is small.
inline void sine_and_cosine(double a, double& sine, double& cosine) {
  if (!(std::abs(a) <= kSmallAngle)) return sine_and_cosine_of_any(a, sine, cosine);
  const double aa = a * a;
  sine = a - a * aa * (1.0 / 6 - aa * (1.0 / 120 - aa * (1.0 / 5040 - aa * (1.0 / 362880))));
  cosine = 1 - aa * (0.5 - aa * (1.0 / 24 - aa * (1.0 / 720 - aa * (1.0 / 40320))));
}

/// Of an angle a, from its square: sin(a) / a and cos(a) - 1. A turn by a vector needs no more, and no root of it where it is small.
inline void sine_ratio_and_less_one(double aa, double& ratio, double& less_one) {
  if (!(aa <= kSmallAngle * kSmallAngle)) {
    const double a = std::sqrt(aa);
    double sine, cosine;
    sine_and_cosine_of_any(a, sine, cosine);
    ratio = sine / a;
    less_one = cosine - 1;
    return;
  }
  ratio = 1 - aa * (1.0 / 6 - aa * (1.0 / 120 - aa * (1.0 / 5040 - aa * (1.0 / 362880))));
  less_one = -aa * (0.5 - aa * (1.0 / 24 - aa * (1.0 / 720 - aa * (1.0 / 40320))));
}

}  // namespace scree
