// Which rank computes which body: when space is cut again, migration, ghosts, and what each rank did and held.
#pragma once

#include "solver/ranks/balance.hpp"
#include "solver/ranks/halo.hpp"
#include "solver/ranks/rank_measures.hpp"

namespace scree {

class Decomposition {
 public:
  Decomposition(const mpi::Communicator& comm, const SolverScene& scene, const ParallelOptions& options);

  /// Whether this many ranks have their parts already: of the scene, or from a cut.
  bool has_cut() const { return halo_.has_cut(); }
  /// Cuts space by the work of the bodies and moves them to their owners, with the state of their pairs. Drops all ghosts. Collective.
  /// in   is_first   it sends most bodies round and sets up the library: its cost says nothing about the next
  void cut_again(ParticleSet& p, PairList& pairs, bool is_first);
  /// Moves bodies that left their parts to their owners, or cuts again where the work of the ranks asks for it. Drops all ghosts.
  /// Collective.   in   all   reports of all ranks
  void distribute(ParticleSet& p, PairList& pairs, const StepReport& all);

  Halo& halo() { return halo_; }
  Balance& balance() { return balance_; }
  const ParallelOptions& options() const { return options_; }

  std::int64_t cuts() const { return cuts_; }          ///< after the first
  std::int64_t migrated() const { return migrated_; }  ///< bodies that left this rank
  /// Largest over mean computing time of the ranks since the last call. Collective.
  double take_imbalance();
  /// Of this rank alone.
  RankMeasures measures(const ParticleSet& p, const PairList& pairs, const PhaseTimes& times) const;

 private:
  const mpi::Communicator& comm_;
  const SolverScene& scene_;
  ParallelOptions options_;
  Halo halo_;
  Balance balance_;
  std::int64_t cuts_ = 0, migrated_ = 0;
  double computed_before_ = 0;  // when the imbalance was last taken [s]
};

}  // namespace scree
