// How far the points of each body have gone, step by step: two bodies cannot have come nearer than the sum of their ways.
//
// A pair that looked at its candidates knows how far both may go before the first of them can matter; until then it costs
// two additions a step. The way is a bound, never a result: it is made again with the body lists and differs between ranks.
//
// In a cell that deforms, the way of a body is what it moves beside the cell, and half of what the cell takes two bodies towards each
// other that lists hold: images of bodies move with it, however little the bodies themselves do.
#pragma once

#include <vector>

#include "solver/bodies/particle_set.hpp"

namespace scree {

class TravelBounds {
 public:
  /// Begins again: no body has moved.   in   branch   between the centres of two bodies that lists hold, at most [m]
  void restart(const ParticleSet& p, double branch);
  /// Adds what the owned bodies, or the ghosts, have moved since the last call.   Threads: parallel inside.
  void add_motion_of_owned(const ParticleSet& p);
  void add_motion_of_ghosts(const ParticleSet& p);
  /// Adds to every owned body that it has moved by no more than `way` since the last call [m].   in   p   all of them balls
  void add_to_balls(const ParticleSet& p, double way);
  /// No point of the body has gone further since the start [m].
  double operator[](std::int32_t row) const { return way_[static_cast<std::size_t>(row)]; }

 private:
  void add_motion(const ParticleSet& p, std::size_t row);

  double branch_ = 0;
  std::vector<double> way_;
  std::vector<Vec3> x_;
  std::vector<Quat> q_;
};

}  // namespace scree
