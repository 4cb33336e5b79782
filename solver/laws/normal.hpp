// Normal laws. Each is a structure in a file of its own or here, and a line of core/storage/contact_laws.inc; the damping, the sharing
// among features, the friction, the critical step and the derived step follow from it, whatever the law. A law has
//   kNeedsRadius         whether R* of the two bodies enters
//   InLayer              what it is with gather = "area"; void: it does not go with that
//   kExponent            of the overlap in the force, of a law that goes with one power of it: bodies with cells need one
//   prepare(input, law)  fills what it reads of PairLaw, and step_stiffness. Throws UsageError for what the user must give
//   Law(law, radius)     made for a pair in every step; radius is R* [m] where needed
//   energy(D) force(D) stiffness(D)   of its push at the overlap D > 0: U [J], dU/dD [N], d2U/dD2 [N/m], all >= 0
// A law that is not linear and may go on along its tangent (contact/overlap_limit.hpp) has
//   limit   overlap beyond which its push grows by the stiffness that it has there; infinite as it is made
// A law that pulls as well begins to act at an overlap of -PairLaw::reach, which its prepare fills, and has
//   pull(D) pull_energy(D) pull_stiffness(D)   for D > -reach: attraction [N] >= 0, its integral from -reach to D [J], and its largest
//                        slope there [N/m]
// Where several features share an effective overlap D, they share push and pull alike. Damping, friction and rolling resistance go with
// the push alone.
#pragma once

#include <algorithm>
#include <cmath>
#include <concepts>
#include <limits>
#include <numbers>

#include "solver/laws/law_input.hpp"
#include "solver/laws/pair_law.hpp"

namespace scree {

/// Elastic layer (gather = "area"): pressure kappa d; a smooth cap has F = kappa pi R* D^2, U = F D / 3. Meshes bring their own energy.
struct LayerLaw {
  static constexpr bool kNeedsRadius = true;
  static constexpr double kExponent = 2;
  double kappa, c;  ///< [N/m^3], and kappa pi R* [N/m^2]
  static void prepare(const LawInput& in, PairLaw& law) {
    if (!(in.pair.layer_modulus > 0)) {
      throw UsageError("pairs: '{}' and '{}': layer_modulus is missing; contact.gather = \"area\" needs it", in.a.name, in.b.name);
    }
    law.layer_modulus = in.pair.layer_modulus;
    law.stiffness = law.step_stiffness = in.pair.layer_modulus / in.smallest_max_overlap;
  }
  LayerLaw(const PairLaw& law, double radius) : kappa(law.stiffness), c(law.stiffness * std::numbers::pi * radius) {}
  double energy(double D) const { return c * D * D * D / 3; }
  double force(double D) const { return c * D * D; }
  double stiffness(double D) const { return 2 * c * D; }
};

/// U = k D^2 / 2, where k may go with R* (MaterialPair::spring).
struct LinearLaw {
  static constexpr bool kNeedsRadius = false;
  using InLayer = LayerLaw;
  static constexpr double kExponent = 1;
  double k;  ///< [N/m]
  static void prepare(const LawInput& in, PairLaw& law) {
    law.stiffness = in.pair.stiffness;
    law.size_stiffness = 2 * in.pair.modulus;
    // by size: that of the largest bodies; which pair sets the step is found where steps are derived
    const double radius = !(in.pair.modulus > 0) ? 0 : in.pair.contact_radius > 0 ? in.pair.contact_radius : in.largest_impact().radius;
    law.step_stiffness = LinearLaw(law, radius).stiffness(0);
  }
  LinearLaw(const PairLaw& law, double radius) : k(law.stiffness + law.size_stiffness * radius) {}
  double energy(double D) const { return 0.5 * k * D * D; }
  double force(double D) const { return k * D; }
  double stiffness(double /*D*/) const { return k; }
};

/// Elastic spheres: F = 4/3 E* sqrt(R*) D^(3/2), U = 2/5 F D.   Source: Hertz; Johnson, Contact Mechanics (1985), section 4.2.
struct HertzLaw {
  static constexpr bool kNeedsRadius = true;
  using InLayer = void;
  static constexpr double kExponent = 1.5;
  double modulus, radius;                                  ///< E* [Pa], R* [m]
  double c;                                                ///< 4/3 E* sqrt(R*) [N/m^(3/2)]
  double limit = std::numeric_limits<double>::infinity();  ///< overlap beyond which it goes along its tangent [m]
  static void prepare(const LawInput& in, PairLaw& law);
  HertzLaw(const PairLaw& law, double r) : modulus(law.stiffness), radius(r), c(4.0 / 3 * modulus * std::sqrt(radius)) {}
  double energy(double D) const {
    if (D > limit) return energy(limit) + (D - limit) * (force(limit) + 0.5 * (D - limit) * stiffness(limit));
    return 0.4 * c * D * D * std::sqrt(D);
  }
  double force(double D) const { return D > limit ? force(limit) + (D - limit) * stiffness(limit) : c * D * std::sqrt(D); }
  double stiffness(double D) const { return 2 * modulus * std::sqrt(radius * std::min(D, limit)); }
};

/// The step follows from the stiffest tangent: that at the overlap of the severest impact, and of the whole margin at most.
inline void HertzLaw::prepare(const LawInput& in, PairLaw& law) {
  if (!(in.a.young > 0 && in.b.young > 0)) {
    throw UsageError("materials: '{}' and '{}' need young (Young's modulus) for contact.law = \"hertz-mindlin\"", in.a.name, in.b.name);
  }
  law.stiffness = effective_modulus(in.a, in.b);
  if (in.pair.tangential_ratio < 0) law.tangential_ratio = 6 * effective_shear_modulus(in.a, in.b) / law.stiffness;
  const LargestImpact impact = in.largest_impact();
  double overlap = hertz_impact_overlap(law.stiffness, impact.radius, impact.mass, impact.speed);
  if (in.max_overlap > 0)
    overlap = impact.speed > 0 && !in.continues ? std::min(overlap, in.max_overlap) : in.max_overlap;
  else if (in.continues)
    overlap = impact.radius;  // of balls: their maximum overlap
  if (!(overlap > 0) && in.limits_step && impact.mass > 0) {
    throw UsageError(
        "contact.impact_speed is missing: the step follows from the stiffness of a Hertz contact, which grows with its overlap; "
        "give the speed of the fastest impact, or time.step");
  }
  law.step_stiffness = HertzLaw(law, impact.radius).stiffness(overlap);
}

/// A force that goes with one power of the overlap.
template <class Law>
concept PowerLaw = requires {
  Law::kExponent;
};

/// A law that is not linear and can go on along its tangent.
template <class Law>
concept LimitedLaw = requires(Law law) {
  law.limit;
};

/// A law with attraction.
template <class Law>
concept PullingLaw = requires(const Law& law) {
  { law.pull(0.0) } -> std::same_as<double>;
  { law.pull_energy(0.0) } -> std::same_as<double>;
  { law.pull_stiffness(0.0) } -> std::same_as<double>;
};

/// Tangent stiffness of the push over its secant stiffness, dF/dD over F/D: a tangential stiffness of rho F/D is rho over this of the
/// tangent.
template <class Law>
double tangent_over_secant(const Law& law, double D) {
  if constexpr (PowerLaw<Law>) {
    return Law::kExponent;
  } else {
    return D > 0 ? law.stiffness(D) * D / law.force(D) : 1;
  }
}

/// The least of it at any overlap, for the derived step: a push that stiffens has more than 1.
template <class Law>
constexpr double least_tangent_over_secant() {
  if constexpr (PowerLaw<Law>) {
    return Law::kExponent;
  } else {
    return 1;
  }
}

}  // namespace scree
