// Steps of a bed of balls one after another, without what a step of another scene may need in between: while nothing but pairs of balls in
// blocks and gravity acts on bodies, a step is two passes, over pairs and over bodies, and each number is read and written once.
//
// The bits are those of single steps, so that it never matters when this begins and ends. It ends before a step after which something is
// written, where lists are used up, where a pair needs the general path, and where bodies are looked at by review (kReviewSteps).
// What goes so: step/balls_alone.hpp.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "solver/neighbours/waiting_balls.hpp"
#include "solver/ranks/requests.hpp"
#include "solver/step/force_step.hpp"
#include "solver/step/neighbour_lists.hpp"

namespace scree {

class BallSteps {
 public:
  /// Goes on from bodies that have moved in the present step, whose forces are not known, to bodies that have moved in a later one, `last`
  /// at most. Does nothing where single steps are needed.
  /// in   requests   end it
  /// Returns whether bodies have moved, and the lists of their new places are to be looked at.   Threads: parallel inside.
  bool run(RunState& s, ForceStep& forces, Balance& balance, FirstFailure& failure, const NeighbourLists& lists, const Requests& requests,
           std::int64_t last);

  /// Steps that went so since the start.
  std::int64_t count() const { return count_; }

 private:
  bool lists_hold(const RunState& s, const NeighbourLists& lists);
  bool begin_walls(const RunState& s, const NeighbourLists& lists);
  void move_walls(RunState& s);
  /// Takes bodies into groups, and back into their columns.
  void enter(RunState& s, ForceStep& forces);
  void leave(RunState& s, ForceStep& forces);
  std::span<const std::int32_t> pairs_outside(ForceStep& forces);
  template <class Action>
  void each_share(Action&& action) const;

  std::vector<BallGroup> groups_;  // what moves of the bodies
  WaitingBalls waiting_;
  std::vector<std::int32_t> outside_;
  std::int64_t looked_at_ = -1;  // number of lists for which `may_run_` was found
  bool may_run_ = false;
  std::int64_t count_ = 0, filled_again_ = -(std::int64_t{1} << 40);
  double bound_ = 0;  // two bodies have come nearer by this since the steps began, at most [m]
  // of walls that move: how far away bodies are, how far points of walls there have moved since lists were made and since the steps began,
  // at most [m]; and where walls were in the step before
  std::vector<double> wall_reach_;
  double walls_listed_ = 0, walls_way_ = 0;
  std::vector<WallState> walls_before_;
  double listed_ = 0;  // as far as a body was from where it was listed when `bound_` was `bound_then_`, at most [m]
  double bound_then_ = 0;
};

}  // namespace scree
