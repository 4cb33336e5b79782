// Passes over the bodies of a rank that lie next to each other in the particle set, beside their motion (motion_lanes.hpp): one body in
// each lane of a vector, with the bits of plain code on every instruction set. Each takes rows [begin, end), the last of them one by one.
// Threads: local, each thread takes rows of its own. Cost: of a ball with AVX2, 8 to 20 instructions a pass.
#pragma once

#include <cstddef>
#include <vector>

#include "solver/bodies/particle_set.hpp"

namespace scree {

/// Adds to p.dissipated what damping and friction take in a time dt from bodies that are not fixed: the power of the dissipative forces and
/// torques at the present velocities.
void add_dissipation_of_rows(ParticleSet& p, double dt, std::size_t begin, std::size_t end);

/// Adds to `way` how far the points of each body have gone since it was at x_before and q_before, which become its present pose. Of a ball
/// that turns, the surface stays where it is. For axes that are not periodic. in   rounding   factor that keeps `way` a bound
void add_way_of_rows(const ParticleSet& p, double rounding, std::size_t begin, std::size_t end, std::vector<Vec3>& x_before,
                     std::vector<Quat>& q_before, std::vector<double>& way);

/// The first row whose body goes farther than `share` of its radius in a time dt, of bodies that have a radius; `end` where none does.
std::size_t find_row_that_goes_far(const ParticleSet& p, double dt, double share, std::size_t begin, std::size_t end);

struct RowsMoved {
  bool beyond = false;       ///< some body is farther from where it was listed than the limit, or nowhere (not a number)
  double squared_speed = 0;  ///< largest [m^2/s^2]
};
/// in   limit_squared   of the distance from p.x_listed [m^2]
RowsMoved find_rows_moved(const ParticleSet& p, double limit_squared, std::size_t begin, std::size_t end);

}  // namespace scree
