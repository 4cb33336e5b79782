// How two materials meet, turned into what the force loop needs. Made once per material pair by SolverScene.
#pragma once

namespace scree {

struct MaterialPair;

/// Ratio of tangential to normal stiffness: equal periods for a ball (docs/reference/contact-law.md section 3.4, rho = 2/7).
inline constexpr double kTangentialStiffnessRatio = 2.0 / 7.0;

struct PairLaw {
  double stiffness = 0;                                 ///< linear: k of one contact [N/m]; Hertz: E* [Pa]; layer: kappa [N/m^3]
  double size_stiffness = 0;                            ///< linear: what k has for each metre of R* beside it [N/m^2]
  double damping_ratio = 0;                             ///< viscous: zeta from restitution by the exact map
  double damping_slope = 0;                             ///< Hunt-Crossley: chi [s/m], from restitution at the user's speed
  double friction = 0;                                  ///< mu, static
  double friction_sliding = 0;                          ///< mu, sliding
  double tangential_ratio = kTangentialStiffnessRatio;  ///< rho: a feature's tangential stiffness is rho f / D
  double tangential_damping = 1;                        ///< factor on the damping of sliding
  double rolling_friction = 0;                          ///< mu_r: rolling moment at most mu_r R* N
  double torsional_friction = 0;                        ///< mu_t: moment about the normal at most mu_t R* N
  bool rolling_spring = true;                           ///< moments of type C (elastic, then plastic); false: type A (constant)
  double radius = 0;                                    ///< R* [m] as given by the user; 0: that of the bodies' equivalent spheres
  double barrier = 0;                                   ///< k_b of laws/barrier.hpp [N/m]; 0: none
  double margin = 0;                                    ///< margin sum, of a barrier [m]
  double limit = 0;                                     ///< overlap from which the push goes on along its tangent [m]; 0: none
  double layer_modulus = 0;                             ///< of an elastic layer [Pa]
  double reach = 0;          ///< gap beyond the margins at which the law or an attraction begins to act [m]; 0 where nothing pulls
  double neck_adhesion = 0;  ///< w of laws/neck.hpp [J/m^2]; 0: these materials do not stick so
  const MaterialPair* bridge = nullptr;  ///< whose liquid bridge the attraction is; null: none
  double pull_modulus = 0;               ///< of the traction of an attraction by area, p / s [N/m^3]; 0: another, or none
  double pull_off = 0;                   ///< F_c of laws/attraction.hpp [N] ...
  double pull_off_per_radius = 0;        ///< ... and what goes with R* of it [N/m]
  double unloading_ratio = 1;            ///< k2 / k1 of laws/plastic.hpp; 1: contacts are elastic
  double adhesive_ratio = 0;             ///< k_adh / k1 of it
  double least_dent = 0, most_dent = 1;  ///< dent over overlap at the limits of it
  double step_stiffness = 0;             ///< stiffest tangent expected [N/m], of a layer per area [N/m^3]: the step is derived from it
  double step_damping = 0;               ///< damping ratio of restitution, of every law: the step is derived from it
};

}  // namespace scree
