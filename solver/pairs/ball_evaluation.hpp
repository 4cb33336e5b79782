// What the loop over pairs does with pairs of balls, and of balls with planes and cylinders of walls: collects those that are due, and
// finds the forces of many of them at once (lanes/ball_forces.hpp). The bits are those of PairEvaluation, which computes what is left
// to it.
//
// Such a pair keeps no candidates. Its gap tells whether it touches, and if not, how far both may go before it can: until then it is
// idle, as other pairs are (neighbours/travel_bounds.hpp). Pairs that touched in the last step are not asked first: their forces are
// found, and with them that some have parted.
#pragma once

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "solver/lanes/ball_forces.hpp"
#include "solver/pairs/pair_evaluation.hpp"

namespace scree {

/// Whether pairs of balls go their own way in this pass: not where more is asked for than forces.
bool has_ball_way(const PairPass& pass);

/// Pairs of balls of a pass, and what all threads read of the walls that they meet.
class BallPass {
 public:
  explicit BallPass(PairPass& pass);
  PairPass& pass() const { return pass_; }
  const BallScene& scene() const { return scene_; }

 private:
  PairPass& pass_;
  BallScene scene_;
};

/// One thread's part of a pass.
class BallEvaluation {
 public:
  explicit BallEvaluation(const BallPass& balls);

  /// Takes a pair.   Returns false for one that it cannot take.
  bool take(std::int32_t k) {
    const IdlePair& idle = pass_.list.idle()[static_cast<std::size_t>(k)];
    if (pass_.way_of(idle) < idle.way) return true;  // its result says so already
    if (!(pass_.p.ball_radius[static_cast<std::size_t>(idle.a)] > 0)) return false;
    const bool touched = idle.way == kTouching;
    if (idle.b >= 0) {
      if (!(pass_.p.ball_radius[static_cast<std::size_t>(idle.b)] > 0)) return false;
      add(k, idle.a, idle.b, touched, touched ? old_contacts_ : two_balls_);
    } else {
      const std::int32_t zone = pass_.list.stored_pairs()[static_cast<std::size_t>(k)].key.zone;
      const std::int32_t row = balls_.scene().laws.row_of_zone[static_cast<std::size_t>(zone)];
      if (row < 0) return false;
      add(k, idle.a, row, touched, touched ? old_contacts_at_walls_ : at_walls_);
    }
    return true;
  }

  /// Computes what has been taken and not yet been.
  void finish() {
    for (Due* due : {&two_balls_, &at_walls_})
      if (due->pairs.count > 0) look(*due);
    for (Due* due : {&old_contacts_, &old_contacts_at_walls_})
      if (due->pairs.count > 0) press(*due);
  }

  /// Computes the pairs of a block; some may be left to the general path.
  void compute(BallBlock& block);
  /// Pairs that were taken, and that the general path is to compute.
  const std::vector<std::int32_t>& left() const { return left_; }
  /// Pairs that have waited for their place in blocks and touch now, those of the general path too.
  std::vector<std::int32_t> begun_to_touch() const;
  /// Pairs of blocks that are among `left`.
  const std::vector<std::int32_t>& left_of_blocks() const { return left_of_blocks_; }
  double largest_overlap() const { return largest_overlap_; }  ///< over the maximum overlap of its pair
  bool too_deep() const { return too_deep_; }

 private:
  struct Due {
    Due() = default;
    Due(const Due&) = delete;  // pairs lie in it
    Due& operator=(const Due&) = delete;
    BallEights eights;
    BallPairs pairs{.eights = eights.data()};
    std::array<std::int32_t, kBallPairs> index;  ///< in the list of pairs
  };

  void add(std::int32_t k, std::int32_t a, std::int32_t b, bool touched, Due& due) {
    prefetch<sizeof(PairState)>(&pass_.list.stored_pairs()[static_cast<std::size_t>(k)].state);
    prefetch<sizeof(PairResult)>(&pass_.list.stored_results()[static_cast<std::size_t>(k)]);
    const std::size_t n = due.pairs.count++;
    due.pairs.a(n) = a;
    due.pairs.b(n) = b;
    due.index[n] = k;
    if (!touched) {
      if (due.pairs.count == kBallPairs) look(due);
      return;
    }
    if (n >= kAhead) ask_for_springs(due.index[n - kAhead]);
    if (due.pairs.count == kBallPairs) press(due);
  }
  void ask_for_springs(std::int32_t k) const {
    prefetch<kMaxSprings * sizeof(FrictionSpring)>(pass_.list.stored_pairs()[static_cast<std::size_t>(k)].state.springs.data());
  }
  void look(Due& due);
  void press(Due& due);
  /// Calls work(due), and shares out its time over the pairs where that is asked for.
  template <class Work>
  void timed(Due& due, Work&& work);
  void take_touching(const Due& due, std::size_t n, std::size_t& count);
  void leave(BallBlock& block, std::size_t n);
  void part(std::int32_t k, std::size_t a, std::size_t b, bool at_wall, double gap);
  void find_forces();
  void hand_out();

  static constexpr std::size_t kAhead = 8;       ///< pairs before a pair's springs are asked for: where they lie is known by then
  static constexpr std::size_t kMaxSprings = 2;  ///< see ball_spring_count()

  const BallPass& balls_;
  PairPass& pass_;
  std::size_t spring_count_ = 0;  ///< that each pair in contact keeps
  Due two_balls_, at_walls_, old_contacts_, old_contacts_at_walls_, touching_;
  alignas(64) std::array<double, kBallPairs> gap_;
  BallSprings springs_;
  BallForces forces_;
  std::array<BallSlot, kBallPairs> slots_;
  std::array<PaddedVec3, kBallPairs> moments_;
  std::vector<std::int32_t> left_, begun_;  // begun_: touch, and did not in the last step
  std::vector<std::int32_t> left_of_blocks_;
  double largest_overlap_ = 0;
  bool too_deep_ = false;
};

}  // namespace scree
