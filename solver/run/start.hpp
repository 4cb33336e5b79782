// Where a run begins: at its scene, or at a checkpoint of its folder.
#pragma once

#include <memory>
#include <optional>

#include "solver/run/checkpoint.hpp"
#include "solver/run/loaded_scene.hpp"
#include "solver/run/run_folder.hpp"
#include "solver/run/run_options.hpp"

namespace scree {

struct RunStart {
  std::unique_ptr<FolderLock> lock;      ///< rank 0
  std::optional<Checkpoint> checkpoint;  ///< nothing: the run begins at the scene
  bool is_complete = false;              ///< nothing is left to do
};

/// Looks at the folder, locks it and reads the checkpoint. Whatever refuses this run comes here, before the folder is touched. Collective.
/// Fails: throws on every rank what check_run_folder(), FolderLock and read_checkpoint() throw, and InputError when the checkpoint was
/// made from another scene.
RunStart find_start(const mpi::Communicator& comm, const RunOptions& options, const LoadedScene& loaded);

/// Refuses a run of more steps than can be counted, and warns of a step that a light body sets. Collective.
void check_step_size(const mpi::Communicator& comm, const RunOptions& options, const Settings& settings, const StepSize& step);

}  // namespace scree
