// Kicks and drifts of bodies that lie next to each other in the particle set, one in each lane of a vector: part of motion.cpp, with the
// bits of its plain code on every instruction set.
#pragma once

#include <cstddef>

#include "solver/bodies/particle_set.hpp"

namespace scree {

/// Kicks rows [begin, end) over h, as far as whole vectors go. Returns the first row that is left.
std::size_t kick_in_lanes(ParticleSet& p, double h, std::size_t begin, std::size_t end);

/// The same: a kick over `kick_time`, then the drift over h.
/// in   has_rotor   bodies whose three moments are not equal turn by DlmRotor of motion.cpp; else a vector that has one is where this stops
std::size_t drift_in_lanes(ParticleSet& p, double kick_time, double h, bool has_rotor, std::size_t begin, std::size_t end);

/// Rows that drift_in_lanes takes at once, at most: where it stops, as many go the plain way.
inline constexpr std::size_t kMaxDriftLanes = 8;

}  // namespace scree
