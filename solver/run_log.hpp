// log.csv: one row per interval. The page of the format is core/storage/RUN_FORMAT.md.
#pragma once

#include <string>
#include <vector>

#include "solver/rank_log.hpp"
#include "solver/simulation.hpp"

namespace scree {

/// Begins a table anew with this header, and with the rows up to a step of the one that is there; a negative step keeps none.
/// The first column is the step.
void start_table(const std::string& path, const std::string& header, std::int64_t keep_up_to_step);
/// Adds rows and flushes them: all of them or, on a full disk, none. Throws SystemError (disk full).
void append_to_table(const std::string& path, const std::string& rows);

/// Rank 0 writes; others hold an empty log. A restart keeps the rows up to its step and drops later ones.
class RunLog {
 public:
  RunLog(const std::string& path, const Scene& scene, std::int64_t keep_up_to_step);
  /// in   ranks   measures of all ranks: the row has the mean of their times
  void add_row(std::int64_t step, double time, const Energies& e, double energy_error, std::int64_t contacts,
               double max_depth_ratio, double imbalance, const std::vector<RankMeasures>& ranks, double steps_per_second,
               const RemovedTotals& removed, double critical_step, const std::vector<WallLoad>& loads, const std::vector<WallState>& walls,
               const std::string& state_hash);

 private:
  std::string path_;
};

/// steps.csv: every change of a quantised step.
std::string step_header();
std::string step_rows(const std::vector<StepChange>& changes);

/// removed.csv: the bodies that left the domain and were taken out.
std::string removed_header();
std::string removed_rows(const std::vector<RemovedBody>& bodies);

}  // namespace scree
