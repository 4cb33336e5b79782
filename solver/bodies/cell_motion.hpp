// What a step of a periodic cell that deforms does to the bodies in it (the splitting is in bodies/cell.hpp).
#pragma once

#include "solver/bodies/particle_set.hpp"

namespace scree {

/// After Cell::deform(), before the drift: the owned bodies, and the places of their lists, go with the cell.   Threads: parallel inside.
void carry_with_cell(ParticleSet& p);
/// After the drift: u / g.
void slow_with_cell(ParticleSet& p);

}  // namespace scree
