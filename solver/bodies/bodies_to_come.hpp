// Bodies that the inlets of a scene may bring, as the step size takes them.
#pragma once

#include <cstdint>
#include <vector>

#include "solver/bodies/particle_set.hpp"

namespace scree {

/// The bodies that the inlets of a scene can bring, such that what holds for them holds for all: the smallest and the largest of each
/// shape. Their ids are kIdToCome and above.
std::vector<ParticleRecord> bodies_to_come(const SolverScene& scene);
inline constexpr std::int64_t kIdToCome = std::int64_t{1} << 62;

}  // namespace scree
