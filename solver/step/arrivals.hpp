// Bodies that join a run after its start.
#pragma once

#include <vector>

#include "solver/ranks/halo.hpp"
#include "solver/state/run_state.hpp"

namespace scree {

/// A study build refuses what was left out of it.
void check_built_with(const mpi::Communicator& comm, const SolverScene& scene, const ParticleSet& p);

/// Agrees what is known of all bodies, and of the contacts that they can have, after bodies came or went. The step stays. Collective.
void agree_on_bodies(RunState& s);

/// A body that came in.
struct InsertedBody {
  std::int64_t id, step;
  double time, mass, diameter;
  Vec3 x;
  std::int32_t inlet;  ///< -1: a program inserted it
  std::int32_t shape, material;
};

class Arrivals {
 public:
  /// Bodies that join in the next step, each given by one rank, with the place and velocities that they have at its end if they touch
  /// nothing; in a fluid to first order in the step. Their ids are above all that bodies and walls have or had, and differ. Until that
  /// step they are in no measure and no checkpoint. Collective.
  /// Throws on every rank, and no body joins: what SolverScene::check_body() does, InputError for an id that is taken, and RunInvalid when
  /// the step of the run is too long for their contacts.
  void add(RunState& s, const std::vector<ParticleRecord>& mine);
  /// The same for bodies of which every rank knows that they can join: the run was prepared for them, and no id is taken.
  /// in   largest_id   that any body has or had then, the same on every rank
  void add_known(RunState& s, const std::vector<ParticleRecord>& mine, std::int64_t largest_id);
  /// Those of this rank.
  const std::vector<ParticleRecord>& waiting() const { return mine_; }
  /// Whether any rank has bodies that wait: the same on all.
  bool are_waiting() const { return waiting_; }
  /// Lets them join on the ranks that own their places, between the two kicks of a step, after migration and before ghosts are made.
  /// Returns whether any rank had some. Collective.
  bool join(RunState& s, const Halo& halo);
  /// Bodies of add() that joined since the last call, in the order of their ids; the same on every rank.
  std::vector<InsertedBody> take_inserted();

 private:
  std::vector<ParticleRecord> mine_;
  std::vector<InsertedBody> added_, inserted_;  // by add(), the same on every rank: that wait, and that have joined
  bool waiting_ = false;
};

}  // namespace scree
