// Runs of one scene on groups of the ranks of a test, and what they came to.
#pragma once

#include <omp.h>

#include <cstdint>
#include <functional>
#include <string>

#include "tests/support/test_run.hpp"

namespace scree::test {

/// Calls `action` with a communicator of the first `count` ranks, on those; the others wait.
inline void on_ranks(int count, const std::function<void(const mpi::Communicator&)>& action) {
  MPI_Comm group = MPI_COMM_NULL;
  MPI_Comm_split(g_comm->get(), g_comm->rank() < count ? 0 : MPI_UNDEFINED, 0, &group);
  if (group != MPI_COMM_NULL) {
    {
      const mpi::Communicator comm(group);
      action(comm);
    }
    MPI_Comm_free(&group);
  }
  g_comm->sum(0.0);
}

struct Outcome {
  std::string hash;
  std::int64_t contacts = 0;  ///< of all steps that were looked at
  std::int64_t migrated = 0, ghosts = 0, owned_least = 0, cuts = 0;
};

/// State after some steps; threads are set for the run only.
inline Outcome outcome_of(const Scene& scene, int ranks, int threads, int steps, const ParallelOptions& options = {}) {
  Outcome outcome;
  omp_set_num_threads(threads);
  on_ranks(ranks, [&](const mpi::Communicator& comm) {
    TestRun run(scene, comm);
    run.start(options);
    for (int n = 1; n <= steps; ++n) {
      run.simulation->advance();
      if (n % 50 == 0) {
        outcome.contacts += contact_count(run.simulation->state());
        outcome.ghosts += comm.sum(static_cast<std::int64_t>(run.simulation->state().particles.ghost_count()));
      }
    }
    run.simulation->agree_on_failures();
    outcome.hash = state_hash(run.simulation->state());
    outcome.migrated = comm.sum(run.simulation->decomposition().migrated());
    outcome.cuts = run.simulation->decomposition().cuts();
    outcome.owned_least = -static_cast<std::int64_t>(comm.max(-static_cast<double>(run.simulation->state().particles.owned)));
  });
  omp_set_num_threads(1);
  return outcome;
}

}  // namespace scree::test
