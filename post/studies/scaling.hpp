// Strong and weak scaling from the ranks.csv of several runs: a table and two charts.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace scree {

/// What one run took per step, from the first to the last row of its ranks.csv. Output is left out.
struct ScalingRow {
  std::string run;
  std::string strategy;  ///< "overlap/selected/rcb" as in run.json
  std::int64_t bodies = 0, steps = 0;
  int ranks = 1, threads = 1;
  double step_seconds = 0;                       ///< of the rank that took longest, waiting included [s]
  double wait_seconds = 0;                       ///< mean over the ranks, waiting for neighbours and for what all must agree on [s]
  double determinism = 0;                        ///< share of a step that goes into order, ordered sums and pairs computed twice
  double imbalance = 1;                          ///< largest over mean processor time of the ranks' own work
  double ghosts = 0, neighbours = 0, bytes = 0;  ///< mean of a rank; bytes sent in a step
  double body_bytes = 0, ghost_bytes = 0;        ///< memory of one [B]
  int cores() const { return ranks * threads; }
};

/// Throws InputError with the file named when a run has no run.json or no ranks.csv with two steps in it.
ScalingRow read_scaling_row(const std::string& run_folder);

/// Writes scaling.csv, strong.svg and weak.svg into a folder, and returns the table.
///
/// Strong: runs of the same bodies, speedup over the run on fewest cores times those. Weak: runs with the same bodies per core
/// (to 2 %), efficiency against the one on fewest cores. A chart without two such runs says so.
std::string write_scaling(const std::vector<std::string>& run_folders, const std::string& folder);

}  // namespace scree
