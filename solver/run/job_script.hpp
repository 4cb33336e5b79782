// A job script for SLURM whose job puts itself back into the queue until the run is complete.
#pragma once

#include <string>

namespace scree {

struct JobScript {
  std::string program;  ///< as the user called it
  std::string scene_path, run_folder;
  int ranks = 1, threads = 1;
};

/// Bash text. SLURM sends SIGUSR1 some minutes before the time limit, the solver keeps a checkpoint and ends with 138, and the
/// script requeues the job; it continues by --restart auto. After a lost machine SLURM itself requeues. A job that came back
/// without a new checkpoint is not requeued, so that it cannot go round indefinitely.
std::string slurm_script(const JobScript& job);

}  // namespace scree
