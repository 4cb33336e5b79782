// Ball contacts kept from step to step as lanes read and write them: blocks of 64 pairs, with springs and forces side by side. A block has
// pairs of two balls, or of balls with one plane or cylinder.
//
// Springs and results of such pairs lie in three places of the list of pairs, and cost more to collect and to hand out than the forces
// take. From the first step after a list was made until the list is read (for a frame, a row of the log, a checkpoint, the next list),
// they lie here instead. PairList says what all pairs keep: its readers have them written back first.
//
// A pair that begins to touch is added in the next step. One that parts stays, without force, until the pairs are written back. One that
// lanes leave to the loop over single pairs is taken out.
// Memory: 250 bytes a pair in contact.   Threads: blocks are computed by any thread, each by one at a time; all else by one thread.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "solver/lanes/ball_rows.hpp"
#include "solver/neighbours/body_pair.hpp"
#include "solver/neighbours/lane_rows.hpp"

namespace scree {

/// Which pairs of a rank: of owned bodies and walls; with a ghost, counted here; with a ghost, counted by its owner.
enum class PairClass : std::uint8_t { inner, outer, duplicated };
inline constexpr std::size_t kPairClasses = 3;

/// Springs that a pair of balls keeps: none, one of friction, or this and one of rolling.
std::size_t ball_spring_count(const LaneLaws& laws);
/// Whether springs are those of a ball contact, or none.
bool are_of_balls(const std::vector<FrictionSpring>& springs, std::size_t spring_count);
/// Makes them place n of lanes.
void load_springs(const std::vector<FrictionSpring>& springs, std::size_t spring_count, std::size_t n, const BallPairs& pairs,
                  BallSprings& lanes);
/// The other way round.   in   spring_count > 0
void save_springs(const BallPairs& pairs, const BallSprings& lanes, std::size_t n, std::size_t spring_count,
                  std::vector<FrictionSpring>& springs);
/// What springs store [J].
double energy_of_springs(const BallPairs& pairs, const BallSprings& lanes, std::size_t n, std::size_t spring_count);

struct BallBlock {
  BallPairs pairs;
  BallSprings springs;
  BallConstants constants;
  BallForces forces;
  std::array<std::int32_t, kBallPairs> index;    ///< in the list of pairs; -1: taken out
  std::array<std::uint8_t, kBallPairs> touches;  ///< 1 or 0
  bool all_touch = true;

  /// Makes a pair do nothing until it touches again.   Needs the eights of `pairs` and the slots of `forces`
  void part(std::size_t n);
};

class BallBlocks {
 public:
  bool are_filled() const { return filled_; }
  /// Takes all pairs of balls that have touched in the last step or have springs.
  /// in   lists   of the classes: indices of pairs
  void fill(const BallScene& scene, const std::array<std::span<const std::int32_t>, kPairClasses>& lists,
            const std::vector<BodyPair>& pairs, const std::vector<IdlePair>& idle);
  /// Gives all back, and is empty.
  void write_back(std::vector<BodyPair>& pairs, std::vector<PairResult>& results, std::vector<IdlePair>& idle);
  /// Notes pairs of a class that have waited and touch now, with a result in the list, or that lanes have left to single pairs.
  void take_out(PairClass which, std::span<const std::int32_t> pairs);
  /// Adds pairs of a class that touched when they were taken out.   in   begun   ascending
  void add(PairClass which, std::span<const std::int32_t> begun, const BallScene& scene, const std::vector<BodyPair>& pairs);

  /// The pairs of a class that are not in blocks.
  const std::vector<std::int32_t>& others(PairClass which) const { return others_[static_cast<std::size_t>(which)]; }
  /// Of these, over all classes, those that are no ball contacts, or that lanes have no formula for: they may touch.
  std::size_t count_outside() const { return outside_; }
  std::size_t count(PairClass which) const { return of_class_[static_cast<std::size_t>(which)].size(); }
  /// The n-th block of a class, with its eights and slots.
  BallBlock& block(PairClass which, std::size_t n) { return with_slots(of_class_[static_cast<std::size_t>(which)][n]); }
  /// The blocks of pairs with walls.
  const std::vector<std::int32_t>& with_walls() const { return with_walls_; }
  /// Calls action(slot) for each pair of a block; those that do not touch do nothing.
  template <class Action>
  void for_each_slot(std::int32_t block, Action&& action) const {
    const auto at = static_cast<std::size_t>(block);
    for (std::size_t k = 0; k < blocks_[at]->pairs.count; ++k) action(slots_[at * kBallPairs + k]);
  }
  /// Calls action(place) for each pair of a block that touches.
  template <class Action>
  void for_each_touching(std::int32_t block, Action&& action) const {
    const auto count = static_cast<std::int32_t>(blocks_[static_cast<std::size_t>(block)]->pairs.count);
    for (std::int32_t k = 0; k < count; ++k)
      if (const auto place = block * static_cast<std::int32_t>(kBallPairs) + k; touches(place)) action(place);
  }
  /// The wall of a block, a row of LaneLaws::zones.
  std::int32_t wall_of(std::int32_t block) const { return eights_[static_cast<std::size_t>(block) * kBallPairs / BallEight::kPairs].b[0]; }
  bool have_rolling() const { return spring_count_ == 2; }

  /// Where a pair lies: 64 times its block plus its place there; or one of these.
  static constexpr std::int32_t kOther = -1;  ///< not here: its result is that of the list
  static constexpr std::int32_t kWaits = -2;  ///< not here, and without force: it comes here when it touches
  std::int32_t place_of(std::int32_t k) const { return place_[static_cast<std::size_t>(k)]; }
  /// Whether a pair in a block touches.
  bool touches(std::int32_t place) const {
    const auto at = static_cast<std::size_t>(place);
    return blocks_[at / kBallPairs]->touches[at % kBallPairs] != 0;
  }
  /// The ball of a pair, A.
  std::int32_t ball_of(std::int32_t place) const {
    const auto at = static_cast<std::size_t>(place);
    return eights_[at / BallEight::kPairs].a[at % BallEight::kPairs];
  }
  /// What a pair in a block that touches does, but for the energy of its springs.
  void load_result(std::int32_t place, PairResult& result) const;
  /// What pairs in blocks do, by their places.
  const std::vector<BallSlot>& slots() const { return slots_; }
  const std::vector<PaddedVec3>& moments() const { return moments_; }  ///< empty where the scene has none

 private:
  BallBlock& with_slots(std::int32_t n);
  std::int32_t block_with_room(std::size_t of, std::int32_t wall);
  bool append(std::size_t of, std::int32_t k, const BallScene& scene, const BodyPair& pair);
  void complete(std::int32_t n, const BallScene& scene);
  void give_back(std::size_t place, std::size_t k, std::vector<BodyPair>& pairs, std::vector<PairResult>& results,
                 std::vector<IdlePair>& idle) const;

  bool filled_ = false;
  std::size_t spring_count_ = 0;
  std::vector<std::unique_ptr<BallBlock>> blocks_;  // more than are used
  std::size_t used_ = 0, outside_ = 0;
  std::vector<BallEight> eights_;  // of all blocks, one after another
  std::vector<BallSlot> slots_;    // the same
  std::vector<PaddedVec3> moments_;
  std::array<std::vector<std::int32_t>, kPairClasses> of_class_, others_;
  std::vector<std::int32_t> with_walls_;
  std::array<std::vector<std::int32_t>, kPairClasses>
      last_;                         // of each wall row of balls and, first, of two balls: the block being filled, or -1
  std::vector<std::int32_t> place_;  // of each pair of the list
};

}  // namespace scree
