// Normal laws. A normal law is an energy U(D) of a pair's effective overlap D [m] and its slope; the damping, the sharing among
// features and the friction follow from both, whatever the law (potential.cpp).
#pragma once

#include <cmath>
#include <numbers>

#include "solver/laws/pair_law.hpp"

namespace scree {

/// U = k D^2 / 2.
struct LinearLaw {
  static constexpr double kExponent = 1;  ///< of D in the force
  double k;                               ///< [N/m]
  LinearLaw(const PairLaw& law, double /*radius*/) : k(law.stiffness) {}
  double energy(double D) const { return 0.5 * k * D * D; }
  double force(double D) const { return k * D; }
};

/// Elastic spheres: F = 4/3 E* sqrt(R*) D^(3/2), U = 2/5 F D.   Source: Hertz; Johnson, Contact Mechanics (1985), section 4.2.
struct HertzLaw {
  static constexpr double kExponent = 1.5;
  double c;  ///< 4/3 E* sqrt(R*) [N/m^(3/2)]
  /// in   radius   R* of the contact [m], > 0
  HertzLaw(const PairLaw& law, double radius) : c(law.stiffness * std::sqrt(radius)) {}
  double energy(double D) const { return 0.4 * c * D * D * std::sqrt(D); }
  double force(double D) const { return c * D * std::sqrt(D); }
};

/// Elastic layer (gather = "area"): pressure kappa d; a smooth cap has F = kappa pi R* D^2, U = F D / 3. Meshes bring their own energy.
struct LayerLaw {
  static constexpr double kExponent = 2;
  double kappa, c;  ///< [N/m^3], and kappa pi R* [N/m^2]
  LayerLaw(const PairLaw& law, double radius) : kappa(law.stiffness), c(law.stiffness * std::numbers::pi * radius) {}
  double energy(double D) const { return c * D * D * D / 3; }
  double force(double D) const { return c * D * D; }
};

}  // namespace scree
