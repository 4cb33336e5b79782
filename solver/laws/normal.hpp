// Normal laws. A normal law is an energy U(D) of a pair's effective overlap D [m], its slope and its curvature; the damping, the sharing
// among features, the friction and the critical step follow from them, whatever the law (contact/pair_force.cpp).
#pragma once

#include <cmath>
#include <numbers>

#include "solver/laws/pair_law.hpp"

namespace scree {

/// Elastic layer (gather = "area"): pressure kappa d; a smooth cap has F = kappa pi R* D^2, U = F D / 3. Meshes bring their own energy.
struct LayerLaw {
  static constexpr double kExponent = 2;
  double kappa, c;  ///< [N/m^3], and kappa pi R* [N/m^2]
  LayerLaw(const PairLaw& law, double radius) : kappa(law.stiffness), c(law.stiffness * std::numbers::pi * radius) {}
  double energy(double D) const { return c * D * D * D / 3; }
  double force(double D) const { return c * D * D; }
  double stiffness(double D) const { return 2 * c * D; }
};

/// U = k D^2 / 2.
struct LinearLaw {
  using InLayer = LayerLaw;               ///< what it is with gather = "area"
  static constexpr double kExponent = 1;  ///< of D in the force, of a law that has one
  double k;                               ///< [N/m]
  LinearLaw(const PairLaw& law, double /*radius*/) : k(law.stiffness) {}
  double energy(double D) const { return 0.5 * k * D * D; }
  double force(double D) const { return k * D; }
  double stiffness(double /*D*/) const { return k; }  ///< dF/dD
};

/// Elastic spheres: F = 4/3 E* sqrt(R*) D^(3/2), U = 2/5 F D.   Source: Hertz; Johnson, Contact Mechanics (1985), section 4.2.
struct HertzLaw {
  using InLayer = void;  ///< does not go with it
  static constexpr double kExponent = 1.5;
  double c;  ///< 4/3 E* sqrt(R*) [N/m^(3/2)]
  /// in   radius   R* of the contact [m], > 0
  HertzLaw(const PairLaw& law, double radius) : c(law.stiffness * std::sqrt(radius)) {}
  double energy(double D) const { return 0.4 * c * D * D * std::sqrt(D); }
  double force(double D) const { return c * D * std::sqrt(D); }
  double stiffness(double D) const { return 1.5 * c * std::sqrt(D); }
};

/// A force that goes with one power of the overlap.
template <class Law>
concept PowerLaw = requires {
  Law::kExponent;
};

/// Tangent stiffness over secant stiffness, dF/dD over F/D: a tangential stiffness of rho F/D is rho over this of the tangent.
template <class Law>
double tangent_over_secant(const Law& law, double D) {
  if constexpr (PowerLaw<Law>) {
    return Law::kExponent;
  } else {
    return law.stiffness(D) * D / law.force(D);
  }
}

}  // namespace scree
