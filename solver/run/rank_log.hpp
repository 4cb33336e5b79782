// ranks.csv: what each rank did and held, row by row. The page of the format is core/storage/RUN_FORMAT.md.
#pragma once

#include <string>
#include <vector>

#include "solver/ranks/rank_measures.hpp"

namespace scree {

/// Rank 0 writes. A restart keeps the rows up to its step and drops later ones.
class RankLog {
 public:
  RankLog(const std::string& path, int ranks, std::int64_t keep_up_to_step);
  /// Adds one row a rank. Of many ranks only some steps are kept, so that the file stays readable; `last` is always.
  /// Throws SystemError (disk full).
  void add_rows(std::int64_t step, const std::vector<RankMeasures>& ranks, bool last);

 private:
  std::string path_;
  std::int64_t calls_ = 0, keep_every_ = 1;
};

}  // namespace scree
