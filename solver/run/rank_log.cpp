#include "solver/run/rank_log.hpp"

#include <algorithm>

#include "solver/run/run_log.hpp"

namespace scree {

namespace {

std::string header() {
  std::string names = "step,rank,bodies,ghosts,neighbours,contacts,computing", units = "# units: -,-,-,-,-,-,s";
  for (std::size_t p = 0; p < static_cast<std::size_t>(Phase::count); ++p) {
    names += std::string(",t_") + phase_name(static_cast<Phase>(p));
    units += ",s";
  }
  return names + ",messages,bytes,renewal_bytes,migrated,body_bytes,ghost_bytes,peak_rss\n" + units + ",-,B,B,-,B,B,B\n";
}

}  // namespace

RankLog::RankLog(const std::string& path, int ranks, std::int64_t keep_up_to_step) : path_(path) {
  constexpr int kRanksInEveryRow = 16;
  keep_every_ = std::max(1, ranks / kRanksInEveryRow);
  start_table(path, header(), keep_up_to_step);
}

void RankLog::add_rows(std::int64_t step, const std::vector<RankMeasures>& ranks, bool last) {
  if (calls_++ % keep_every_ != 0 && !last) return;
  std::string rows;
  for (std::size_t r = 0; r < ranks.size(); ++r) {
    const RankMeasures& m = ranks[r];
    rows += fmt::format("{},{},{},{},{},{},{:.6g}", step, r, m.bodies, m.ghosts, m.neighbours, m.contacts, m.computing);
    for (const double t : m.times) rows += fmt::format(",{:.6g}", t);
    rows +=
        fmt::format(",{},{},{},{},{},{},{}\n", m.messages, m.bytes, m.rebuild_bytes, m.migrated, m.body_bytes, m.ghost_bytes, m.peak_rss);
  }
  append_to_table(path_, rows);
}

}  // namespace scree
