// Ranks: who owns which body, migration, and ghosts.
//
// A body is owned by the rank whose box of the bisection holds its centre. When the body lists are renewed, bodies
// that left their box migrate with all they own (state and friction springs), and every rank receives as ghosts the
// bodies that can come within the margin of one of its own before the next renewal. In between only position,
// orientation and both velocities of ghosts travel, to fixed places in fixed messages.
#pragma once

#include <memory>
#include <vector>

#include "core/partition/partition.hpp"
#include "solver/mpi_session.hpp"
#include "solver/pair_list.hpp"

namespace scree {

enum class HaloStrategy { overlap, blocking };

/// What travels of a ghost in every step.
struct GhostState {
  Vec3 x, v, w;
  Quat q;
};

class Halo {
 public:
  /// in   regions   one box per rank; empty: cut at the first rebalance()
  Halo(const mpi::Communicator& comm, CutBoxes regions);

  bool has_regions() const { return !regions_.lower.empty(); }
  const CutBoxes& regions() const { return regions_; }

  /// Cuts anew by measured work; the next migrate() moves the bodies. Collective.
  void rebalance(const ParticleSet& p);

  /// Sends bodies outside this rank's box to their owners, with their springs. Drops all ghosts. Collective.
  /// Returns how many bodies left this rank.
  std::int64_t migrate(const SolverScene& scene, ParticleSet& p, PairList& list);

  /// Finds and fetches ghosts: bodies that can touch one of ours while none moves further than skin / 2. Collective.
  void make_ghosts(const SolverScene& scene, ParticleSet& p, double skin);

  /// Starts the refresh of ghosts; ghosts must not be read until finish_refresh().
  void start_refresh(const ParticleSet& p);
  void finish_refresh(ParticleSet& p);

 private:
  const mpi::Communicator& comm_;
  CutBoxes regions_;
  std::unique_ptr<Partitioner> partitioner_;
  struct Neighbour {
    int rank;
    std::vector<std::int32_t> send_rows;     ///< our rows that are ghosts there
    std::size_t first_ghost, ghost_count;    ///< our rows that are ghosts from there
    std::vector<GhostState> send_buffer, receive_buffer;
  };
  std::vector<Neighbour> neighbours_;
  std::vector<MPI_Request> requests_;
};

}  // namespace scree
