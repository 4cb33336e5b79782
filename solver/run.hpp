// A whole run: folder, time loop, output when due, outcome.
#pragma once

#include <string>
#include <vector>

#include "solver/simulation.hpp"

namespace scree {

struct RunOptions {
  std::string scene_path, run_folder;
  std::string restart;                     ///< checkpoint path, "latest", or "" for a fresh start
  ParallelOptions parallel;
  std::vector<std::string> command;
};

/// Runs a scene to its end. Returns the exit code: done, or 128 + n after signal n (a checkpoint is kept).
/// Throws RunInvalid after the last state was kept (exit 5), and what files and MPI throw. Collective.
int run_scene(const mpi::Communicator& comm, const RunOptions& options);

/// Text of --plan: what this scene needs and what is left out and why, memory, step size, time.
std::string plan_text(const mpi::Communicator& comm, const SolverScene& scene, const Simulation& simulation);

}  // namespace scree
