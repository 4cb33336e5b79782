#include "solver/ranks/decomposition.hpp"

#include <sys/resource.h>

#include <chrono>

#include "solver/built_with.hpp"

namespace scree {

namespace {

/// The boxes that a scene is cut into, if it is cut for this many ranks.
CutBoxes cut_of_scene(const SolverScene& scene, int ranks) {
  const Partition& partition = scene.source().partition;
  return partition.ranks == ranks ? CutBoxes{partition.lower, partition.upper} : CutBoxes{};
}

}  // namespace

Decomposition::Decomposition(const mpi::Communicator& comm, const SolverScene& scene, const ParallelOptions& options)
    : comm_(comm), scene_(scene), options_(options), halo_(comm, scene, options, cut_of_scene(scene, comm.size())), balance_(comm.size()) {}

void Decomposition::cut_again(ParticleSet& p, PairList& pairs, bool is_first) {
  const auto start = std::chrono::steady_clock::now();
  const double expected = halo_.rebalance(p, balance_.work_of_bodies(p));
  migrated_ += halo_.migrate(scene_, p, pairs);
  const double seconds = is_first ? 0 : std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  balance_.note_cut(seconds, expected, p);
}

void Decomposition::distribute(ParticleSet& p, PairList& pairs, const StepReport& all) {
  if (!built_with::kRanks) return;  // no other rank
  if (!options_.cuts_again || !balance_.is_cut_due(all)) {
    migrated_ += halo_.migrate(scene_, p, pairs);
    return;
  }
  cut_again(p, pairs, false);
  ++cuts_;
}

double Decomposition::take_imbalance() {
  const double since = balance_.computing() - computed_before_;
  computed_before_ = balance_.computing();
  const double mean = comm_.sum(since) / comm_.size(), largest = comm_.max(since);
  return mean > 0 ? largest / mean : 1;
}

RankMeasures Decomposition::measures(const ParticleSet& p, const PairList& pairs, const PhaseTimes& times) const {
  RankMeasures m;
  m.times = times;
  m.computing = balance_.computing();
  m.bodies = static_cast<std::int64_t>(p.owned);
  m.ghosts = static_cast<std::int64_t>(p.ghost_count());
  m.neighbours = static_cast<std::int64_t>(halo_.neighbour_count());
  m.messages = halo_.traffic().messages;
  m.bytes = halo_.traffic().bytes;
  m.rebuild_bytes = halo_.traffic().rebuild_bytes;
  m.migrated = migrated_;
  const std::size_t row = p.row_bytes();
  std::size_t own_pairs = 0, ghost_pairs = 0;
  for (const BodyPair& pair : pairs.pairs()) {
    const bool with_ghost = static_cast<std::size_t>(pair.a) >= p.owned || (pair.b >= 0 && static_cast<std::size_t>(pair.b) >= p.owned);
    (with_ghost ? ghost_pairs : own_pairs) += memory_of(pair);
  }
  m.body_bytes = static_cast<std::int64_t>(p.owned * row + own_pairs);
  m.ghost_bytes = static_cast<std::int64_t>(p.ghost_count() * (row + 2 * kGhostBytes) + ghost_pairs);  // sent there, received here
  for (std::size_t k = 0; k < pairs.pairs().size(); ++k) {
    if (counts_here(pairs.pairs()[k], p) && pairs.results()[k].active) m.contacts += pairs.results()[k].contact_count;
  }
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  m.peak_rss = static_cast<std::int64_t>(usage.ru_maxrss) * 1024;
  return m;
}

}  // namespace scree
