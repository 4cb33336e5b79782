// log.csv: one row per interval. The page of the format is core/storage/RUN_FORMAT.md.
#pragma once

#include <string>
#include <vector>

#include "solver/run/rank_log.hpp"
#include "solver/step/simulation.hpp"

namespace scree {

/// The names of a table's columns and its rows, cell by cell. A row counts only when it is complete: it ends its line, begins with a
/// step and has a cell for each column. What a killed writer left of its last row does not.
struct TableRows {
  std::vector<std::string> names;
  std::vector<std::vector<std::string>> rows;
  std::size_t column(const std::string& name) const;  ///< names.size() when there is none
  std::int64_t step(std::size_t row) const { return std::stoll(rows[row][0]); }
};
/// Nothing when there is no such file.
TableRows read_table(const std::string& path);

/// Begins a table anew with this header, and with the rows up to a step of the one that is there; a negative step keeps none.
/// The first column is the step.
void start_table(const std::string& path, const std::string& header, std::int64_t keep_up_to_step);
/// Adds rows and flushes them: all of them or, on a full disk, none. Throws SystemError (disk full).
void append_to_table(const std::string& path, const std::string& rows);
/// Waits until a table is on the disk: before a checkpoint that relies on its rows. Throws SystemError.
void sync_table(const std::string& path);

/// Rank 0 writes; others hold an empty log. A restart keeps the rows up to its step and drops later ones.
class RunLog {
 public:
  RunLog(const std::string& path, const Scene& scene, std::int64_t keep_up_to_step);
  /// in   ranks   measures of all ranks: the row has the mean of their times
  void add_row(std::int64_t step, double time, const Energies& e, double energy_error, std::int64_t contacts, double max_overlap_ratio,
               double imbalance, const std::vector<RankMeasures>& ranks, double steps_per_second, const RemovedTotals& removed,
               double critical_step, const std::vector<WallLoad>& loads, const std::vector<WallState>& walls,
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
