#include "solver/run/rank_log.hpp"

#include <algorithm>

namespace scree {

std::vector<Column> rank_columns(std::int64_t step, std::size_t rank, const RankMeasures& measures) {
  const auto count = [](auto value) { return fmt::format("{}", value); };
  std::vector<Column> columns{{"step", "-", count(step)},
                              {"rank", "-", count(rank)},
                              {"bodies", "-", count(measures.bodies)},
                              {"ghosts", "-", count(measures.ghosts)},
                              {"neighbours", "-", count(measures.neighbours)},
                              {"contacts", "-", count(measures.contacts)},
                              {"computing", "s", fmt::format("{:.6g}", measures.computing)}};
  for (std::size_t p = 0; p < measures.times.size(); ++p) {
    columns.push_back({std::string("t_") + phase_name(static_cast<Phase>(p)), "s", fmt::format("{:.6g}", measures.times[p])});
  }
  columns.push_back({"messages", "-", count(measures.messages)});
  columns.push_back({"bytes", "B", count(measures.bytes)});
  columns.push_back({"renewal_bytes", "B", count(measures.rebuild_bytes)});
  columns.push_back({"migrated", "-", count(measures.migrated)});
  columns.push_back({"body_bytes", "B", count(measures.body_bytes)});
  columns.push_back({"ghost_bytes", "B", count(measures.ghost_bytes)});
  columns.push_back({"peak_rss", "B", count(measures.peak_rss)});
  return columns;
}

RankLog::RankLog(int ranks) {
  constexpr int kRanksInEveryRow = 16;
  keep_every_ = std::max(1, ranks / kRanksInEveryRow);
}

std::string RankLog::rows(std::int64_t step, const std::vector<RankMeasures>& ranks, bool last) {
  if (calls_++ % keep_every_ != 0 && !last) return "";
  std::string rows;
  for (std::size_t r = 0; r < ranks.size(); ++r) rows += row_of(rank_columns(step, r, ranks[r]));
  return rows;
}

}  // namespace scree
