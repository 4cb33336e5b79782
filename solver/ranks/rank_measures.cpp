#include "solver/ranks/rank_measures.hpp"

namespace scree {

std::vector<RankMeasures> gather_measures(const mpi::Communicator& comm, const RankMeasures& mine) {
  std::vector<RankMeasures> all(comm.rank() == 0 ? static_cast<std::size_t>(comm.size()) : 0);
  MPI_Gather(&mine, sizeof mine, MPI_BYTE, all.data(), sizeof mine, MPI_BYTE, 0, comm.get());
  return all;
}

}  // namespace scree
