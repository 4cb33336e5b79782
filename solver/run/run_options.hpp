// What a user asks of a run.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "solver/ranks/mpi_session.hpp"
#include "solver/run/option_words.hpp"
#include "solver/step/simulation.hpp"

namespace scree {

/// [s] Long enough for a frame on a slow file system; a stalled run then costs half an hour, not the night.
inline constexpr double kStallLimit = 1800;

/// [s] of wall time between the checkpoints of a case that says nothing of them.
inline constexpr double kCheckpointInterval = 1800;

struct RunOptions {
  std::string scene_path, run_folder;
  std::string restart;  ///< checkpoint path, "latest", "auto", or "" for a fresh start
  ParallelOptions parallel;
  int most_threads = 0;              ///< that may be taken, as many as bodies keep busy; 0: those that OpenMP has, as the user says
  double stall_limit = kStallLimit;  ///< [s], 0: wait indefinitely; see Watchdog
  double checkpoint_interval = kCheckpointInterval;  ///< [s] of wall time, for a case that says nothing of checkpoints; 0: only at the end
  std::function<void(const std::string&)> stalled;   ///< ends the process with a message
  std::vector<std::string> command;
  bool has_program = false;  ///< another program steps the run and may insert and remove bodies, which its tables count from the start
  bool is_quiet = false;     ///< no progress and no notes, only warnings

  OptionWords words() const { return {has_program}; }
};

}  // namespace scree
