// Ranks: which rank owns which body, migration, and ghosts.
//
// A body is owned by the rank whose part of the cut holds its centre. When the body lists are rebuilt, bodies that left their
// part migrate with all they own (state, measured work and friction springs), and every rank receives as ghosts the bodies that
// can come within the margin of one of its own before the next rebuild. In between only position, orientation and both
// velocities of ghosts travel, to fixed places in fixed messages.
//
// Nothing here asks all ranks at once. Who may be a neighbour follows from the cut, which every rank knows; neighbours tell each
// other the box of what they own, which is tighter than their part, and then send what reaches into it; sizes come with
// the messages. Only a migration may go anywhere (see Communicator::exchange).
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/partition/partition.hpp"
#include "solver/neighbours/pair_list.hpp"
#include "solver/phases.hpp"
#include "solver/ranks/ghost_packing.hpp"
#include "solver/ranks/mpi_session.hpp"

namespace scree {

/// Whether the messages of a step are waited for at once, or pairs among owned bodies are computed meanwhile.
enum class HaloStrategy { overlap, blocking };
/// Whether a neighbour gets the bodies that reach into its box, or everything: the seed's simple way, for comparison.
enum class HaloSelection { selected, all };

/// How the ranks work together. It never changes a result.
struct ParallelOptions {
  ParallelOptions(HaloStrategy s = HaloStrategy::overlap, HaloSelection h = HaloSelection::selected, CutMethod c = CutMethod::rcb)
      : strategy(s), selection(h), cut(c) {}
  HaloStrategy strategy;
  HaloSelection selection;
  CutMethod cut;
  /// false: the first cut stays. Later cuts follow the measured work, so no test can know which bodies cross them.
  bool cuts_again = true;
};

/// Counted since the start, of this rank.
struct HaloTraffic {
  std::int64_t messages = 0, bytes = 0;  ///< sent in ghost refreshes
  std::int64_t rebuild_bytes = 0;        ///< sent when ghosts were made and bodies migrated
};

class Halo {
 public:
  /// in   first_cut   one box per rank to start from; empty: cut at the first rebalance()
  Halo(const mpi::Communicator& comm, const SolverScene& scene, const ParallelOptions& options, CutBoxes first_cut);

  bool has_cut() const { return partitioner_ != nullptr || !first_cut_.lower.empty(); }

  /// Cuts again by the given work of each owned body; the next migrate() moves the bodies. Collective.
  /// Returns the imbalance that is left, by that work; the same on every rank.
  double rebalance(const ParticleSet& p, std::span<const double> work);

  /// Sends bodies outside this rank's part to their owners, with their springs. Drops all ghosts. Collective.
  /// Returns how many bodies left this rank.
  std::int64_t migrate(const SolverScene& scene, ParticleSet& p, PairList& list);

  /// Sends each record to the rank whose part holds it; returns what came to this one. Collective.   in   now   the cell
  std::vector<ParticleRecord> deliver(const Periodicity& now, const std::vector<ParticleRecord>& records) const;

  /// Finds and fetches ghosts: bodies that can touch one of ours while none moves further than skin / 2. Every rank calls it.
  /// in   largest_radius   bounding, of the bodies of all ranks [m]
  void make_ghosts(const SolverScene& scene, ParticleSet& p, double largest_radius, double skin);

  /// Starts the refresh of ghosts; ghosts must not be read until finish_refresh().
  void start_refresh(const ParticleSet& p, PhaseTimes& times);
  void finish_refresh(ParticleSet& p, PhaseTimes& times);

  /// The values of ghosts in a column of the bodies, from their owners. At once, without overlap.   in/out   column   of every row
  void refresh_column(std::vector<double>& column, PhaseTimes& times);

  std::size_t neighbour_count() const { return neighbours_.size(); }
  const HaloTraffic& traffic() const { return traffic_; }

 private:
  struct Neighbour {
    int rank;
    std::vector<std::int32_t> send_rows;            ///< our rows that are ghosts there
    std::size_t first_ghost, ghost_count;           ///< our rows that are ghosts from there
    std::vector<char> send_buffer, receive_buffer;  // see ghost_packing.hpp
  };

  /// The image of a point within the periodic axes, in the cell as it was at the start: cuts go with the cell.
  Vec3 inside_domain(const Periodicity& now, const Vec3& x) const;
  int owner_of(const Periodicity& now, std::int64_t id, const Vec3& x) const;
  std::vector<int> possible_neighbours(double reach) const;

  const mpi::Communicator& comm_;
  ParallelOptions options_;
  CutBoxes first_cut_;  // until the first rebalance()
  CutBoxes regions_;    // of the cut in force; empty when its parts are no boxes
  std::unique_ptr<Partitioner> partitioner_;
  Periodicity first_cell_;  // at the start
  std::vector<Neighbour> neighbours_;
  std::vector<MPI_Request> requests_;
  HaloTraffic traffic_;
};

}  // namespace scree
