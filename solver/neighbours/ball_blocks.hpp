// Pairs of balls in contact, kept from step to step as lanes read and write them: blocks of 64 pairs, with springs and forces side by side.
//
// Springs and results of such pairs lie in three places of the list of pairs, and cost more to collect and to hand out than the forces
// take. From the first step after a list was made until the list is read (for a frame, a row of the log, a checkpoint, the next list),
// they lie here instead. PairList says what all pairs keep: its readers have them written back first.
//
// A pair that begins to touch is added. One that parts stays, without force, until the pairs are written back.
// Memory: 370 bytes a pair in contact.   Threads: blocks are computed by any thread, each by one at a time; all else by one thread.
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

/// Springs that a pair of balls keeps: none, of friction and the turn that goes with it, or these and one of rolling.
std::size_t ball_spring_count(const LaneLaws& laws);
/// Springs of a pair as place n of lanes has them.   Returns false for others than those of a pair of balls.
bool load_springs(const std::vector<FrictionSpring>& springs, std::size_t spring_count, std::size_t n, BallSprings& lanes);
/// The other way round.   in   spring_count > 0
void save_springs(const BallSprings& lanes, std::size_t n, std::size_t spring_count, std::vector<FrictionSpring>& springs);

struct BallBlock {
  /// `general`: the general path computes the pair, whose springs are those of the list; its forces are copied here.
  enum class State : std::uint8_t { apart, touches, general };
  BallPairs pairs;
  BallSprings springs;
  BallForces forces;
  std::array<std::int32_t, kBallPairs> index;  ///< in the list of pairs
  std::array<State, kBallPairs> state;
  bool all_touch = true;  ///< all pairs have State::touches

  /// A pair that does nothing until it touches again.
  void part(std::size_t n);
};

class BallBlocks {
 public:
  bool are_filled() const { return filled_; }
  /// Takes all pairs of balls that have touched in the last step or have springs.
  /// in   lists   of the classes: indices of pairs
  void fill(const LaneLaws& laws, const ParticleSet& p, const std::array<std::span<const std::int32_t>, kPairClasses>& lists,
            const std::vector<BodyPair>& pairs, std::vector<IdlePair>& idle, const std::vector<PairResult>& results);
  /// Gives all back, and is empty.
  void write_back(std::vector<BodyPair>& pairs, std::vector<PairResult>& results, std::vector<IdlePair>& idle);
  /// Adds pairs of a class that have waited and touch now, with their results.   in   begun   ascending
  void add(PairClass which, std::span<const std::int32_t> begun, const LaneLaws& laws, const ParticleSet& p,
           const std::vector<BodyPair>& pairs, const std::vector<PairResult>& results);

  /// The pairs of a class that are not in blocks.
  const std::vector<std::int32_t>& others(PairClass which) const { return others_[static_cast<std::size_t>(which)]; }
  std::size_t count(PairClass which) const { return of_class_[static_cast<std::size_t>(which)].size(); }
  BallBlock& block(PairClass which, std::size_t n) {
    return *blocks_[static_cast<std::size_t>(of_class_[static_cast<std::size_t>(which)][n])];
  }
  std::size_t spring_count() const { return spring_count_; }

  /// Where a pair lies: 64 times its block plus its place there; or one of these.
  static constexpr std::int32_t kOther = -1;  ///< not here: its result is that of the list
  static constexpr std::int32_t kWaits = -2;  ///< not here, and without force: it comes here when it touches
  std::int32_t place_of(std::int32_t k) const { return place_[static_cast<std::size_t>(k)]; }
  /// What pairs in blocks do, in fours (BallForces).
  const BallForces& forces_at(std::int32_t place) const { return blocks_[static_cast<std::size_t>(place) / kBallPairs]->forces; }

 private:
  static std::size_t law_of(const LaneLaws& laws, const ParticleSet& p, std::int32_t a, std::int32_t b);
  bool append(std::size_t of, std::int32_t k, const LaneLaws& laws, const ParticleSet& p, const BodyPair& pair);

  bool filled_ = false;
  std::size_t spring_count_ = 0;
  std::vector<std::unique_ptr<BallBlock>> blocks_;  // more than are used
  std::size_t used_ = 0;
  std::array<std::vector<std::int32_t>, kPairClasses> of_class_, others_;
  std::vector<std::int32_t> place_;  // of each pair of the list
};

}  // namespace scree
