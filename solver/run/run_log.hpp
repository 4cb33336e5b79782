// log.csv, steps.csv, removed.csv and inserted.csv. The page of the formats is core/storage/RUN_FORMAT.md.
#pragma once

#include <string>
#include <vector>

#include "solver/ranks/rank_measures.hpp"
#include "solver/run/measures.hpp"
#include "solver/run/table.hpp"

namespace scree {

/// What a row of log.csv tells: of the whole scene, at a full step.
struct LogRow {
  std::int64_t step = 0;
  double time = 0;  ///< [s]
  Energies energies;
  double energy_error = 0;  ///< change of the balance since the start [J]
  std::int64_t contacts = 0;
  std::int64_t deep_now = 0;  ///< pairs deeper than their maximum overlap, and what there was of them since the start
  DeepTotals deep;
  double max_overlap_ratio = 0, imbalance = 0;  ///< since the row before
  std::vector<RankMeasures> ranks;              ///< since the start of the run; the row has the mean of their times
  double steps_per_second = 0;
  RemovedTotals removed, inserted;
  bool has_program = false;  ///< see RunOptions: bodies may come and go without inlets and outlets
  CriticalStep critical;
  std::vector<WallLoad> loads;   ///< in the world
  std::vector<WallState> walls;  ///< in the world
  std::vector<DriveState> drives;
  std::vector<Column> of_effects;
  Vec3 origin;  ///< of the scene as it is computed, in the world [m]
  std::string state_hash;
};

/// Whether the case takes bodies out: the run then has a removed.csv.
bool can_remove(const Scene& scene);

// The columns of the tables, each declared once. A header is that of a row without values.
std::vector<Column> log_columns(const Scene& scene, const LogRow& row);
std::vector<Column> step_columns(const StepChange& change);  ///< steps.csv: every change of a quantised step
/// removed.csv: the bodies that were taken out.
std::vector<Column> removed_columns(const Scene& scene, const RemovedBody& body, bool has_program);
/// inserted.csv: the bodies that came in.
std::vector<Column> inserted_columns(const Scene& scene, const InsertedBody& body, bool has_program);

}  // namespace scree
