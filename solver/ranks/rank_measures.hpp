// What each rank did and held, as its log shows it.
#pragma once

#include <cstdint>
#include <vector>

#include "solver/phases.hpp"
#include "solver/ranks/mpi_session.hpp"

namespace scree {

/// Of one rank, since the start where it is a sum. Plain data: it travels to rank 0 as it is.
struct RankMeasures {
  PhaseTimes times{};    ///< [s]
  double computing = 0;  ///< processor time of its own work [s]; 0 on a single rank
  std::int64_t bodies = 0, ghosts = 0, neighbours = 0, contacts = 0;
  std::int64_t messages = 0, bytes = 0, rebuild_bytes = 0;  ///< sent
  std::int64_t migrated = 0;                                ///< bodies that left this rank
  std::int64_t body_bytes = 0, ghost_bytes = 0;             ///< held now, their pairs and candidates included
  std::int64_t peak_rss = 0;                                ///< [bytes]
};

/// Rank 0 gets one entry a rank, others none. Collective.
std::vector<RankMeasures> gather_measures(const mpi::Communicator& comm, const RankMeasures& mine);

}  // namespace scree
