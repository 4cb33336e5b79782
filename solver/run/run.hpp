// A whole run: folder, time loop, output when due, outcome.
#pragma once

#include "solver/run/run_options.hpp"

namespace scree {

/// Runs a scene to its end. Returns the exit code: done, or 128 + n after signal n (a checkpoint is kept).
/// "auto" restarts from the newest checkpoint, and starts afresh in the same folder when a run ended before its first one.
/// Throws RunInvalid after the last state was kept (exit 5), and what files and MPI throw. Collective.
int run_scene(const mpi::Communicator& comm, const RunOptions& options);

}  // namespace scree
