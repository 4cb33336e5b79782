// The periodic cell that bodies lie in, as it is now. That of most scenes stays as it is; one that deforms carries its bodies with it.
//
// A point that goes with the cell has the velocity L (x - centre), L = (dh/dt) h^-1 with the periods h. Of a body in a cell that deforms,
// ParticleSet::v is what it moves beside that, its peculiar velocity u: no choice of an image changes it. Two bodies approach each other
// with u_a - u_b + L r, r the branch to the image that touches. L is upper triangular: three lengths and three shears.
//
// Splitting: with g = exp(L dt), a step of a body is a kick, x -> centre + g (x - centre), x -> x + dt u, u -> u / g, a kick. Since
// exp(L dt / 2) takes x and u to sqrt(g) x and u / sqrt(g), that is the symmetric order of half a deformation, the drift and half a
// deformation, so that a step back undoes a step. Between two bodies r' = g r + dt (u_a - u_b) is then r + dt (u'_a - u'_b + L' r') to
// rounding, with u' = u / g and L' = (1 - 1 / g) / dt: the velocity by which friction and damping are found is that of the step.
//
// A shear is about the middle of the cell, so that its faces across y move in opposite directions; the world is that of the middle.
//
// Departure: in simple shear this is Newton's law; else the term (dL/dt + L L) x of the homogeneous acceleration is left out, as is usual.
#pragma once

#include "core/geometry/periodic.hpp"

namespace scree {

class Cell {
 public:
  Cell() = default;
  explicit Cell(const Periodicity& periodicity) : periodicity_(periodicity) {}

  const Periodicity& periodicity() const { return periodicity_; }
  bool deforms() const { return deforms_; }
  /// The velocity of a point that goes with the cell against another, from which `branch` leads to it [m/s].
  /// in   in_step   over the last step; else now
  Vec3 velocity_along(const Vec3& branch, bool in_step) const { return (in_step ? rate_of_step_ : rate_).times(branch); }
  /// L [1/s], now and over the last step.
  const UpperMatrix& rate() const { return rate_; }
  const UpperMatrix& rate_of_step() const { return rate_of_step_; }
  /// Where a point that goes with the cell is after the last step.
  Vec3 carried(const Vec3& x) const { return x + growth_.times(x - centre_); }

  /// From now on it deforms about its middle; with these edges [m], less what rounding took from them.
  void begin(const UpperMatrix& edges, const UpperMatrix& remainder);
  /// h [m], of a cell that deforms, sheared since it was a box. One that is not periodic along z ends there at planes: h_zz stays.
  const UpperMatrix& edges() const { return edges_; }
  const UpperMatrix& remainder() const { return remainder_; }
  void set_rate(const UpperMatrix& rate) { rate_ = rate; }
  double volume() const { return edges_.diagonal.x * edges_.diagonal.y * edges_.diagonal.z; }

  /// A step with this rate in its middle [1/s]. Its bodies follow in carry_with_cell() (bodies/cell_motion.hpp).
  void deform(const UpperMatrix& rate, double dt);
  /// g - 1 and 1 - 1 / g of the last step.
  const UpperMatrix& growth() const { return growth_; }
  const UpperMatrix& taken() const { return taken_; }
  const Vec3& centre() const { return centre_; }

 private:
  void set_edges(const UpperMatrix& edges);

  Periodicity periodicity_;
  UpperMatrix edges_;                // [m]
  Vec3 centre_;                      // [m]
  UpperMatrix remainder_;            // [m]
  UpperMatrix rate_, rate_of_step_;  // [1/s]
  UpperMatrix growth_, taken_;       // of the last step
  bool deforms_ = false;
};

}  // namespace scree
