// scree-solver verify: whether a run is what this program, on these ranks and threads, computes again.
#pragma once

#include "solver/run/run.hpp"

namespace scree {

struct VerifyOptions {
  std::string run_folder;
  std::string from;        ///< a checkpoint, "start", or "": the older of those kept, else the start
  std::int64_t steps = 0;  ///< 0: up to the newest checkpoint, or to the last row of the log
  ParallelOptions parallel;
  int most_threads = 0;  ///< as in RunOptions
  double stall_limit = kStallLimit;
  std::function<void(const std::string&)> stalled;
};

struct Verdict {
  bool same = true;
  std::string text;  ///< for the user, on every rank
};

/// Computes steps of a run again and compares every state that it recorded: hashes in the log, bodies in frames, everything in
/// checkpoints. Of the first state that differs it names the step, the body and the field. Writes nothing. Collective.
/// Fails: throws InputError when the folder cannot be read, UsageError when nothing is recorded between these steps.
/// Limits: a frame is read by every rank as a whole.
Verdict verify_run(const mpi::Communicator& comm, const VerifyOptions& options);

}  // namespace scree
