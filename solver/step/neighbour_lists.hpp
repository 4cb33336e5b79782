// When the lists of neighbours are used up, and their rebuild.
//
// Lists hold while no body moves further than half of their skin. Ranks learn one step late that one of them needs new lists, so a rank
// asks for them while they still hold for a step that it has not computed: it looks ahead. When lists are rebuilt never changes a result.
#pragma once

#include <vector>

#include "solver/ranks/agreement.hpp"
#include "solver/ranks/balance.hpp"
#include "solver/state/run_state.hpp"

namespace scree {

class NeighbourLists {
 public:
  /// What this rank has to report of its lists in this step: whether new ones are needed, and how fast its bodies are.
  /// in   rebuilt   new ones are made in this step
  StepReport look(const RunState& s, bool rebuilt);
  /// Whether the ranks may learn a step late of what look() finds.
  bool may_agree_ahead(const RunState& s, bool rebuilt) const;
  /// After look(): whether something moved further than it could have been foreseen to.
  bool are_overrun() const { return overrun_; }

  /// The skin that lists made now have, for bodies of this speed [m/s]. To be set before ghosts are made.
  void set_skin(const RunState& s, double fastest) { skin_ = skin_for(s, fastest); }
  double skin() const { return skin_; }  ///< [m]
  double limit() const;                  ///< as far as a body may be from where it was listed [m], in a cell that stays as it is
  /// As far as a point of a wall that may touch a body has moved since they were made [m].   Cost: O(bodies) for walls that turn
  double walls_have_moved(const RunState& s) const { return walls_moved(s, walls_listed_, s.walls); }
  /// Lists the pairs of bodies, ghosts and walls.
  void rebuild(RunState& s, Balance& balance);
  std::int64_t rebuilds() const { return rebuilds_; }

  /// Takes walls as they are for those that lists were made for: as a run begins.
  void begin(const RunState& s) { walls_listed_ = s.walls; }
  /// Speed of the fastest body of all ranks, as far as it is known [m/s]; infinite until a step was made.
  double fastest() const { return fastest_; }
  void set_fastest(double speed) { fastest_ = speed; }
  /// Has look() ask for new lists, made without the candidates that pairs hold: results never depend on these (for tests).
  void forget_candidates() { forget_asked_ = rebuild_asked_ = true; }

 private:
  double skin_for(const RunState& s, double fastest) const;

  double skin_ = 0, fastest_ = 0;
  std::vector<WallState> walls_listed_;
  UpperMatrix edges_listed_;  // of the cell [m]
  bool overrun_ = false, rebuild_asked_ = false, forget_asked_ = false;
  std::int64_t rebuilds_ = 0;
};

}  // namespace scree
