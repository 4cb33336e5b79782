// From the restitution that a user asks for to the damping of a law. Both maps are exact for every energy U(D).
#pragma once

namespace scree {

/// The least restitution that is computed; less, 0 included, is computed as this. A rebound of a hundredth of the arrival speed has 1e-4 of
/// its energy. Less would need a damping ratio that grows without end (1 / (2 sqrt(e)), 4.8 here): steps far shorter than the contact
/// asks for, and contacts that take hundreds of contact times to part.
inline constexpr double kMinRestitution = 0.01;

/// Damping ratio zeta that gives restitution e in [0, 1] for an impact without tension.
///
/// How: bisection on e = exp(-zeta/s (pi - atan2(2 zeta s, 1 - 2 zeta^2))), s = sqrt(1 - zeta^2), and its continuation
/// for zeta > 1. Holds for every potential U(d) with the energy-scaled damping used here: in the pseudo-time
/// d sigma = F / sqrt(2U) dt every such impact is the linear damped oscillator.
/// Source: Schwager & Poeschel, Granul. Matter 9 (2007) 465; docs/reference/contact-law.md section 3.3.
double damping_ratio_of_restitution(double restitution);
/// The forward map.
double restitution_of_damping_ratio(double zeta);

/// alpha = chi v of Hunt-Crossley damping, f (1 + chi * approach speed), that gives restitution e in [0, 1] at approach
/// speed v: alpha (1 + e) = ln((1 + alpha) / (1 - alpha e)).
///
/// How: bisection; alpha lies in (0, 1/e). The energy integral of m v dv / (1 + chi v) = -F dd does not contain F, so the
/// map holds for every U(d) and every mass.   Source: docs/reference/validation-plan.md C2.
double hunt_crossley_number_of_restitution(double restitution);

}  // namespace scree
