// ranks.csv: what each rank did and held, row by row. The page of the format is core/storage/RUN_FORMAT.md.
#pragma once

#include <string>
#include <vector>

#include "solver/ranks/rank_measures.hpp"
#include "solver/run/table.hpp"

namespace scree {

/// The columns of ranks.csv, each declared once.
std::vector<Column> rank_columns(std::int64_t step, std::size_t rank, const RankMeasures& measures);

/// Which rows of the log have their ranks in ranks.csv: of many ranks only some, so that the file stays readable.
class RankLog {
 public:
  explicit RankLog(int ranks);
  /// One row a rank, or "" when this row of the log is left out; `last` never is.
  std::string rows(std::int64_t step, const std::vector<RankMeasures>& ranks, bool last);

 private:
  std::int64_t calls_ = 0, keep_every_ = 1;
};

}  // namespace scree
