// log.csv: one row per interval. The page of the format is core/storage/RUN_FORMAT.md.
#pragma once

#include <string>
#include <vector>

#include "solver/simulation.hpp"

namespace scree {

/// Rank 0 writes; others hold an empty log. A restart keeps the rows up to its step and drops later ones.
class RunLog {
 public:
  RunLog(const std::string& path, const Scene& scene, std::int64_t keep_up_to_step);
  /// Adds a row and flushes it: a killed run keeps whole rows. Throws SystemError (disk full).
  void add_row(std::int64_t step, double time, const Energies& e, double energy_error, std::int64_t contacts,
               double max_depth_ratio, double imbalance, const PhaseTimes& times, double steps_per_second,
               const std::vector<WallLoad>& loads, const std::string& state_hash);

 private:
  std::string path_;
};

}  // namespace scree
