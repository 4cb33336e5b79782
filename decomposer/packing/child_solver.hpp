// The solver as a child process: packings that only motion can make (settle, compact) are runs of scree-solver.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "core/storage/frame_file.hpp"
#include "core/storage/scene_file.hpp"

namespace scree {

/// How the solver is started: words of a command, for instance { "mpirun", "-n", "4", "scree-solver" }.
/// Empty: the scree-solver beside this program, or else the one on the PATH.
struct ChildSolver {
  std::vector<std::string> command;
};

/// Runs a scene to its end in a temporary folder, which is gone afterwards, and gives the last frame.
///
/// The child does not see that this program has started MPI.
/// in   progress   told the share of the run that is done, whenever the child tells it: every 5 %
/// Throws RunInvalid with the solver's own words when it ends with 2, 3 or 5 (bodies pressed too far, lost, refused), SystemError
/// when it cannot be started or ends otherwise.
Frame run_solver(const ChildSolver& solver, const Scene& scene, const std::function<void(double)>& progress = {});

}  // namespace scree
