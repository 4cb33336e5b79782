// Damping laws: the factor 1 - chi v_n on a feature's push, v_n its separation speed, never below 0. A damping law has prepare(input,
// law), which fills what it reads of PairLaw, and throws UsageError for what the user must give.
//
// Damping and the step. A force that depends on velocity is evaluated with the velocity half a step before, and a contact
// starts somewhere inside a step: with viscous damping both are errors of first order in the step, of 2.5e-2 and 5e-3 in the
// restitution at 20 and 100 steps a contact in the worst case. Two corrections make them of second order (1.4e-3, 4e-5):
// - lag: with damping rate r = c / m*, m* a = -c v(t - dt/2) acts as mass m* (1 - r dt / 2) and damping c. Dividing the rate
//   by 1 + r dt / 4 keeps the damping ratio.
// - onset: a feature at overlap d that closes at speed v has been in touch for d / v. When that is less than a step, the
//   impulse of this force evaluation stands for d / v + dt / 2 instead of dt.
// Hunt-Crossley damping starts at zero force and its lag cancels to second order by itself: it needs neither.
// What stays is the step of the turning point: the velocity of half a step before still closes while the pair parts already, and
// the damping force gives back up to m chi a dt (a dt)^2 / 16, third order in the step: of the energy of arrival 3e-4 at 12 steps a
// contact, 6e-7 at 100 (Hunt-Crossley, e = .9). A velocity predicted from the pair's own force would cure it for two bodies, and
// change the overlap of every contact at rest.
//
// What damping takes in a step. Damping alone changes a pair's speed by the share y = r dt, or r dt / (1 + r dt / 4) where the lag is
// corrected. Beyond 1 it would turn the motion round, beyond 2 create energy. Both laws therefore let y go on to 1 and not past it
// once r dt passes their kFreeRate. The elastic force stays whole: a contact at rest carries the same load at the same overlap.
// A step that the solver derives keeps r dt below kFreeRate (step_size.hpp); it is passed by impacts faster or stiffer than the
// step was made for, and by Hunt-Crossley impacts above the speed of their restitution.
#pragma once

#include <algorithm>
#include <cmath>

#include "solver/laws/law_input.hpp"
#include "solver/laws/pair_law.hpp"
#include "solver/laws/real.hpp"
#include "solver/laws/restitution.hpp"

namespace scree {

#define SCREE_LAW inline
#include "solver/laws/damping-inl.hpp"
#undef SCREE_LAW

/// chi of a pair in this step, and how much of it a new feature may feel.
struct Damping {
  double chi = 0;         ///< [s/m]
  double most_onset = 1;  ///< largest weight of damping in the step of touch
};

/// Share of a pair's speed that damping takes in a step, beyond the rate at which it is free: from `share` on with its `slope`, to 1.
inline double share_in_step(double beyond, double share, double slope) {
  return share - (1 - share) * std::expm1(-beyond * slope / (1 - share));
}

/// Restitution independent of speed: chi = 2 zeta sqrt(m* / 2U), a linear oscillator in pseudo-time for every U.
struct ViscousDamping {
  static constexpr bool kLagCorrected = true;
  /// The rate of the least restitution at 30 steps a contact: up to it the correction of the lag is right.
  static constexpr double kFreeRate = 1.05;
  static constexpr double kMaxOnset = 1.5;  ///< a whole step in touch, and the half step after it
  static void prepare(const LawInput&, PairLaw& law) { law.damping_ratio = law.step_damping; }
  static bool acts(const PairLaw& law) { return law.damping_ratio > 0; }
  /// in   elastic  U of the push [J], > 0    in  mobility  1/m* [1/kg], > 0
  static double chi(const PairLaw& law, double elastic, double mobility) { return viscous_chi(2 * law.damping_ratio, elastic, mobility); }
  /// in   rate       chi times the sum of the elastic forces that it damps, times mobility and step [1]
  /// in   pair_rate  the same of the whole pair: more than `rate` where features damp on their own (gather = "pairs")
  static Damping in_step(double chi, double rate, double pair_rate) {
    if (pair_rate > kFreeRate) {
      const double share = share_in_step(pair_rate - kFreeRate, kFreeShare, kFreeSlope);
      return {chi * (share / pair_rate), std::clamp(1 / share, 1.0, kMaxOnset)};
    }
    const double lagged = lag_of(rate);
    return {chi / lagged, most_onset_of(rate, lagged, kMaxOnset)};
  }

 private:
  static constexpr double kDivisor = 1 + 0.25 * kFreeRate, kFreeShare = kFreeRate / kDivisor, kFreeSlope = 1 / (kDivisor * kDivisor);
};

/// Force without a jump at touch: chi is a constant, restitution falls with speed and is as asked at the speed given for it.
struct HuntCrossleyDamping {
  static constexpr bool kLagCorrected = false;
  /// Up to here restitution has no error of the lag that can be seen (1e-4).
  static constexpr double kFreeRate = 0.75;
  static void prepare(const LawInput& in, PairLaw& law) {
    if (!(in.pair.restitution < 1)) return;
    if (!(in.pair.restitution_speed > 0)) {
      throw UsageError(
          "pairs: '{}' and '{}': restitution_speed is missing; with Hunt-Crossley damping restitution depends on the "
          "speed of the impact, so give the speed at which it is {:g}",
          in.a.name, in.b.name, in.pair.restitution);
    }
    law.damping_slope = hunt_crossley_number_of_restitution(in.pair.restitution) / in.pair.restitution_speed;
  }
  static bool acts(const PairLaw& law) { return law.damping_slope > 0; }
  static double chi(const PairLaw& law, double, double) { return law.damping_slope; }
  static Damping in_step(double chi, double, double pair_rate) {
    if (pair_rate > kFreeRate) chi *= share_in_step(pair_rate - kFreeRate, kFreeRate, 1) / pair_rate;
    return {chi, 1};
  }
};

}  // namespace scree
