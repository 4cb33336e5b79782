// run.json: how a run ended. The page of the format is core/storage/RUN_FORMAT.md.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "solver/run/checkpoint.hpp"
#include "solver/run/loaded_scene.hpp"
#include "solver/run/rest_watch.hpp"
#include "solver/run/run_options.hpp"

namespace scree {

struct Outcome {
  std::string outcome;  ///< "completed", "interrupted", "invalid"
  std::string message;
  int exit_code = 0;
  double slowdown = 1;  ///< see CoreWatch
};

/// Writes run.json into the folder of a run, whole or not at all. Collective.
/// in   record   of the whole run
/// Fails: throws SystemError on every rank when the disk refuses.
void write_outcome(const mpi::Communicator& comm, const Outcome& outcome, const RunOptions& options, const LoadedScene& loaded,
                   Simulation& simulation, const RunRecord& record, const RestWatch& rest, const nlohmann::json& provenance);

/// A line on each inlet that has been blocked to the end.
std::vector<std::string> blocked_inlets(const Scene& scene, const RunState& state);

}  // namespace scree
