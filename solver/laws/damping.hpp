// Damping laws: the factor 1 - chi v_n on a feature's elastic force, v_n its separation speed, never below 0.
//
// Damping and the step. A force that depends on velocity is evaluated with the velocity half a step before, and a contact
// starts somewhere inside a step: with viscous damping both are errors of first order in the step, of 2.5e-2 and 5e-3 in the
// restitution at 20 and 100 steps a contact in the worst case. Two corrections make them of second order (1.4e-3, 4e-5):
// - lag: with damping rate r = c / m*, m* a = -c v(t - dt/2) acts as mass m* (1 - r dt / 2) and damping c. Dividing the rate
//   by 1 + r dt / 4 keeps the damping ratio.
// - onset: a feature at depth d that closes at speed v has been in touch for d / v. When that is less than a step, the
//   impulse of this force evaluation stands for d / v + dt / 2 instead of dt.
// Hunt-Crossley damping starts at zero force and its lag cancels to second order by itself: it needs neither.
#pragma once

#include <algorithm>
#include <cmath>

#include "solver/laws/pair_law.hpp"

namespace scree {

/// chi of a pair in this step, and how much of it a new feature may feel.
struct Damping {
  double chi = 0;          ///< [s/m]
  double most_onset = 1;   ///< largest weight of damping in the step of touch
};

/// Restitution independent of speed: chi = 2 zeta sqrt(m* / 2U), a linear oscillator in pseudo-time for every U.
struct ViscousDamping {
  static bool acts(const PairLaw& law) { return law.damping_ratio > 0; }
  /// in   elastic  U [J]    in  normal_sum  of the features' elastic forces [N]    in  mobility  1/m* [1/kg], > 0
  static Damping of(const PairLaw& law, double elastic, double normal_sum, double mobility, double dt) {
    constexpr double kMostOnset = 1.5;  // a whole step in touch, and the half step after it
    Damping d;
    d.chi = 2 * law.damping_ratio / std::sqrt(2 * elastic * mobility);
    const double rate = d.chi * normal_sum * mobility * dt;
    d.chi /= 1 + 0.25 * rate;
    // weighted damping must not turn the motion round within one step
    if (rate > 0) d.most_onset = std::clamp((1 + 0.25 * rate) / rate, 1.0, kMostOnset);
    return d;
  }
};

/// Force without a jump at touch: chi is a constant, restitution falls with speed and is as asked at the speed given for it.
struct HuntCrossleyDamping {
  static bool acts(const PairLaw& law) { return law.damping_slope > 0; }
  static Damping of(const PairLaw& law, double, double, double, double) { return {law.damping_slope, 1}; }
};

/// Share of a step that the force on a feature stands for.
inline double onset_weight(double depth, double vn, double dt) { return depth < -vn * dt ? depth / (-vn * dt) + 0.5 : 1.0; }

}  // namespace scree
