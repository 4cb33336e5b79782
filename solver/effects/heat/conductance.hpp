// What a contact conducts. Source: G. K. Batchelor, R. W. O'Brien, Thermal or electrical conduction through a granular material, Proc. R.
// Soc. A 355 (1977) 313: two half spaces that touch over a circle of radius a conduct H = 2 k_s a, with k_s = 2 k_a k_b / (k_a + k_b).
#pragma once

#include <cstddef>
#include <vector>

#include "core/storage/scene.hpp"
#include "solver/pairs/pair_observer.hpp"

namespace scree {

/// H of contacts [W/K], of a scene with heat.
///
/// How: the radius a of the contact is
///   area         sqrt(A / pi), A the area of the layer where surfaces are within both margins, with gather = "area" of pairs with a mesh
///   real_young   (3 F R* / (4 E*))^(1/3) with 1/E* = sum of (1 - poisson^2) / real_young, where both materials have it; F is the force
///                with which the contact presses, without damping, friction and attraction. Hertz's contact of the real materials under
///                that load (K. L. Johnson, Contact Mechanics, 1985, eq. 4.22), whatever the law and its stiffness
///   overlap      sqrt(R* d) of the deepest feature, otherwise: Hertz's contact as it is simulated
/// and at most the radius of the ball of the volume of the smaller body. What lies between both surfaces, and an exchange coefficient of a
/// wall, are in series: 1/H = 1/(2 k_s a) + (1/h_pair + 1/h_wall) / (pi a^2). A wall material without conductivity is an isothermal
/// surface: k_s = 2 k_a. Limits: one circle for each pair, however many features it has: a box that lies on its face with gather =
/// "potential" conducts through the circle of a ball of its volume. Contacts of impacts last longer than real ones, which no radius
/// corrects.
class ContactConductance {
 public:
  explicit ContactConductance(const Scene& scene);

  /// 0 for a wall through which no heat passes.   Threads: safe.
  double of(const PairContact& contact, const ParticleSet& p) const;
  /// How the radius of the contacts of two materials is found, for `--plan`.
  bool has_real_modulus(std::size_t a, std::size_t b) const { return of_pair(a, b).real_modulus > 0; }

 private:
  struct Materials {
    double conductivity = 0;  ///< k_s [W/(m K)]
    double real_modulus = 0;  ///< E* of the real materials [Pa]; 0: not known
    double resistance = 0;    ///< of what lies between [m^2 K/W]
  };
  const Materials& of_pair(std::size_t a, std::size_t b) const { return of_pair_[a * materials_ + b]; }

  const Scene& scene_;
  std::size_t materials_;
  std::vector<Materials> of_pair_;
};

/// H of the gas in the gap between two surfaces [W/K].
///
/// How: H = 2 pi k_f R* ln(1 + R_m^2 / (2 R* (g + g0))), the flow along straight lines between two surfaces whose distance grows as
/// g + s^2 / (2 R*), out to the radius R_m of the smaller body; g is the gap, 0 where they touch. g0 is such that touching balls conduct
/// 2 pi k_f R* (2 ln(alpha) - 3.9), alpha = k_s / k_f: there the temperature of the solid is no longer even (Batchelor and O'Brien 1977
/// for equal balls, R = 2 R*). R* as for contacts, by balls of equal volume.
/// Source: the leading terms are those of the same paper; the form of g0 is our own: it joins both limits without a jump.
/// Limits: one gap for each pair, the smallest; two faces that lie parallel conduct more than this. Gas that fills pores does not flow, has
/// no temperature of its own and does not radiate.
class GapConductance {
 public:
  explicit GapConductance(const Scene& scene);

  /// 0 for a wall through which no heat passes, and beyond the range.   in   gap   [m]   Threads: safe.
  double of(const PairView& view, double gap, std::int32_t material_a, std::int32_t material_b, double radius_a, double radius_b) const;

 private:
  const Scene& scene_;
  double conductivity_, range_;
  std::vector<double> offset_;  // g0 R* 2 / R_m^2 of two materials
};

}  // namespace scree
