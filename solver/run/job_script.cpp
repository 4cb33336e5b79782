#include "solver/run/job_script.hpp"

#include <fmt/format.h>

#include <filesystem>

namespace scree {

namespace {

/// A word that bash reads as it is.
std::string quoted(const std::string& word) {
  std::string text = "'";
  for (const char c : word) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return text + "'";
}

/// The name of the run as a job name and a part of a file name: letters that SBATCH lines take without quotes.
std::string plain_name(const std::string& run_folder) {
  std::filesystem::path folder(run_folder);
  if (!folder.has_filename()) folder = folder.parent_path();  // "drum.run/"
  std::string name = folder.stem().string();
  for (char& c : name) {
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' || c == '_' || c == '.';
    if (!plain) c = '_';
  }
  return name.empty() ? "scree" : name;
}

}  // namespace

std::string slurm_script(const JobScript& job) {
  return fmt::format(R"script(#!/bin/bash
# Takes the run {name} to its end, over as many jobs as that needs. Adapt the next lines to your cluster; then: sbatch THIS_FILE
#SBATCH --job-name={name}
#SBATCH --output={name}.%j.log
#SBATCH --open-mode=append
#SBATCH --ntasks={ranks}
#SBATCH --cpus-per-task={threads}
#SBATCH --time=24:00:00
# 5 minutes before the end the solver is asked for a checkpoint (SIGUSR1); it then ends with code 138
#SBATCH --signal=USR1@300
#SBATCH --requeue
set -uo pipefail

run={run}
export OMP_NUM_THREADS="${{SLURM_CPUS_PER_TASK:-{threads}}}"
newest_checkpoint() {{ for file in "$run"/checkpoint_[0-9]*[0-9].h5; do [[ -e "$file" ]] && echo "$file"; done | tail -n 1; }}

before=$(newest_checkpoint)
code=0
# Some clusters want srun --mpi=pmix. One rank that ends with an error ends all.
srun --ntasks="${{SLURM_NTASKS:-{ranks}}}" --cpus-per-task="$OMP_NUM_THREADS" --kill-on-bad-exit=1 \
  {program} {scene_word} -o "$run" --restart auto || code=$?

if [[ $code -eq 138 ]]; then
  if [[ "$(newest_checkpoint)" == "$before" ]]; then
    echo "no new checkpoint since the last job: not requeued; give more time, or a larger --signal=USR1@SECONDS" >&2
    exit 4
  fi
  scontrol requeue "$SLURM_JOB_ID"
fi
exit "$code"
)script",
                     fmt::arg("name", plain_name(job.run_folder)), fmt::arg("ranks", job.ranks), fmt::arg("threads", job.threads),
                     fmt::arg("run", quoted(job.run_folder)), fmt::arg("program", quoted(job.program)),
                     fmt::arg("scene_word", quoted(job.scene_path)));
}

}  // namespace scree
