// What the ranks must know of all bodies that there are.
#pragma once

#include <cstdint>

#include "solver/bodies/particle_set.hpp"
#include "solver/ranks/mpi_session.hpp"

namespace scree {

/// Of the bodies of all ranks, the same on every rank. Agreed again whenever bodies came or went, and at no other time.
struct BodyFacts {
  std::int64_t count = 0;
  double smallest_radius = 1;  ///< bounding [m]; 1 where there is no body
  double largest_radius = 0;   ///< bounding [m]
};

/// Collective.
BodyFacts agree_on_facts(const mpi::Communicator& comm, const ParticleSet& p);

}  // namespace scree
