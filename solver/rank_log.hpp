// ranks.csv: what each rank did and held, row by row. The page of the format is core/storage/RUN_FORMAT.md.
#pragma once

#include <string>
#include <vector>

#include "solver/mpi_session.hpp"
#include "solver/phases.hpp"

namespace scree {

/// Of one rank, since the start where it is a sum. Plain data: it travels to rank 0 as it is.
struct RankMeasures {
  PhaseTimes times{};                 ///< [s]
  double computing = 0;               ///< processor time of its own work [s]; 0 on a single rank
  std::int64_t bodies = 0, ghosts = 0, neighbours = 0, contacts = 0;
  std::int64_t messages = 0, bytes = 0, renewal_bytes = 0;  ///< sent
  std::int64_t migrated = 0;          ///< bodies that left this rank
  std::int64_t body_bytes = 0, ghost_bytes = 0;             ///< held now, their pairs and candidates included
  std::int64_t peak_rss = 0;          ///< [bytes]
};

/// Rank 0 gets one entry a rank, others none. Collective.
std::vector<RankMeasures> gather_measures(const mpi::Communicator& comm, const RankMeasures& mine);

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
