// What a fluid at rest, or in a uniform stream, does to every body: buoyancy, drag, and a moment against its spin.
//
// Each body meets the undisturbed fluid: bodies do not shield each other, and the fluid does not answer. With d the diameter of the
// ball of equal volume, s the speed against the fluid, w the spin, Re = density s d / viscosity:
//
//   buoyancy   minus the weight of the displaced fluid
//   drag       3 pi viscosity d s (1 + A Re^B + C/24 Re^2 / (Re + D)), against the motion; A to D follow from the sphericity.
//              Source: Haider & Levenspiel, Powder Technology 58 (1989) 63, eq. 10 and table 2; sphericity 0.67 to 1, Re up to 25 000
//              (balls: 2.6e5). As Re -> 0 it is Stokes' drag of the ball of equal volume, whatever the sphericity.
//   spin       pi viscosity d^3 w max(1, (12.9 Re_w^(1/2) + 128.4) / 64 pi), Re_w = density d^2 w / viscosity.
//              Source: Dennis, Singh & Ingham, J. Fluid Mech. 101 (1980) 257, for balls, Re_w up to 1000; before it Kirchhoff's
//              8 pi viscosity r^3 w. Departure: other shapes count as the ball of equal volume, which is the least they have.
//
// "stokes" leaves out all that grows with Re. Not in it: added mass, history, lift, what walls and neighbours change.
//
// Drag acts in the kicks. There the rate k = force / (mass speed) is frozen and the linear equation dv/dt = a - k (v - u) solved
// exactly: Stokes' drag has no error of time, a terminal speed is a fixed point at any step, and no step is too large. k is the
// geometric mean of its values before and after the kick: second order, and drag that grows as s^2 comes to rest at once where the mean of
// speeds would swing. What drag takes out of a body's motion is counted as dissipated; a stream that pushes counts against it.
#pragma once

#include <vector>

#include "solver/bodies/particle_set.hpp"

namespace scree {

/// Coefficients of the drag law of Haider and Levenspiel.
struct DragCoefficients {
  double a = 0, b = 1, c = 0, d = 1;  ///< as they stand: Stokes' law
  /// Drag over Stokes' drag.
  double over_stokes(double reynolds) const;
};
/// Of the mean ball.
DragCoefficients drag_of_ball();
/// in   sphericity   surface of the ball of equal volume over surface, in (0, 1]
DragCoefficients drag_of_sphericity(double sphericity);

/// What mass and size of a body follow from.
struct BodyKind {
  std::int32_t shape, material;
  double scale;
  auto operator<=>(const BodyKind&) const = default;
};
inline BodyKind kind_of(const BodyTable& bodies, std::size_t body) {
  return {bodies.shape[body], bodies.material[body], bodies.scale[body]};
}
inline BodyKind kind_of(const ParticleSet& p, std::size_t i) { return {p.shape[i], p.material[i], p.scale[i]}; }

class FluidForces {
 public:
  /// The scene must have a fluid.
  explicit FluidForces(const Scene& scene);

  /// Takes the weight of the displaced fluid off the force on every owned body.   Threads: parallel inside.
  void add_buoyancy(ParticleSet& p) const;
  /// The mass [kg] that body i seems to have when weighed; exactly 0 where densities agree.
  double weighed_mass(const ParticleSet& p, std::size_t i) const { return p.mass[i] - displaced_mass(p, i); }

  /// That over the mass, for bodies of a material.
  double weight_share(std::int32_t material) const { return 1 - density_ratio_[static_cast<std::size_t>(material)]; }

  /// v, L and w of all owned bodies after a time h under the present forces, torques and drag; adds to `dissipated`.
  /// Threads: parallel inside.
  void kick(ParticleSet& p, double h) const;
  void kick_body(ParticleSet& p, std::size_t i, double h) const;

  /// What pulls a body down, or up [N].
  double weight(const BodyKind& body) const;
  /// Of a body, alone and endlessly falling: its speed against the fluid [m/s].
  double terminal_speed(const BodyKind& body) const;
  double reynolds_number(const BodyKind& body, double speed) const;

 private:
  double displaced_mass(const ParticleSet& p, std::size_t i) const {
    return p.mass[i] * density_ratio_[static_cast<std::size_t>(p.material[i])];
  }
  double diameter(std::int32_t shape, double scale) const { return scale * diameter_[static_cast<std::size_t>(shape)]; }

  const Scene* scene_;
  Fluid fluid_;
  bool stokes_ = false;
  std::vector<double> density_ratio_;   // of each material: fluid over body
  std::vector<double> diameter_;        // of each shape [m]: of the ball of equal volume, scale 1
  std::vector<DragCoefficients> drag_;  // of each shape
};

}  // namespace scree
