// What the first steps of a run take, for its plan.
#pragma once

#include <cstdint>

#include "core/base/mpi_session.hpp"
#include "solver/step/simulation.hpp"

namespace scree {

/// The first steps of the run.
struct Pace {
  std::int64_t steps = 0;
  double seconds = 0;  ///< of them: processor time of the first thread of the slowest rank
  std::int64_t contacts = 0;
  double slowdown = 1;  ///< see CoreWatch
  double per_step() const { return steps > 0 ? seconds / static_cast<double>(steps) : 0; }
};

/// Makes some steps of the run, at most 400 and at most for 2 s. Collective.
Pace pace_of(const mpi::Communicator& comm, Simulation& simulation, std::int64_t whole_run);

}  // namespace scree
