// The body pairs of one rank: which bodies may touch, what each pair keeps between steps, and what it did in this step.
//
// Pairs are sorted by (first id, second id, zone). A pair of two bodies has the lower id as A; a body-wall pair has
// the body as A. A pair across ranks is held and computed by both owners, from the same bits.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "core/search/multilevel_grid.hpp"
#include "solver/lanes/ball_motion.hpp"
#include "solver/neighbours/ball_blocks.hpp"
#include "solver/neighbours/body_pair.hpp"
#include "solver/neighbours/travel_bounds.hpp"
#include "solver/phases.hpp"

namespace scree {

/// A pair that may touch, by its key and rows; b is -1 for a wall zone.
struct NearPair {
  PairKey key;
  std::int32_t a, b;
};
/// Pairs whose surfaces may come nearer than twice `range` while no body moves further than `skin / 2`, in ascending order of keys. Pairs
/// of two fixed bodies and of two ghosts are left out.
/// in   range   how far from its surface each body reaches, its margin included (SolverScene::contact_range) [m]
/// out  grid    scratch     in/out  times  adds the sort
std::vector<NearPair> find_near_pairs(const SolverScene& scene, const ParticleSet& p, const std::vector<WallState>& walls, double range,
                                      double skin, MultilevelGrid& grid, PhaseTimes& times);

/// Between the centres of two bodies in lists, as long as these hold, at most [m]: half of the skin is used up on either side, and at most
/// half of it by a cell that deforms (step/neighbour_lists.cpp).   in   radius   the largest
inline double longest_branch(double radius, double range, double skin) { return 2 * (radius + range) + 2.5 * skin; }

/// Bytes of the candidates of a pair.
std::size_t memory_of_candidates(const BodyPair& pair);
/// Bytes that a pair holds, its lists, state and result included.
std::size_t memory_of(const BodyPair& pair);

class PairList {
 public:
  /// Lists all pairs that can touch while no body moves further than `skin / 2`, keeps what known pairs hold, and
  /// hands waiting state to theirs. Pairs of two fixed bodies and of two ghosts are left out.
  void rebuild(const SolverScene& scene, const ParticleSet& p, const std::vector<WallState>& walls, double skin, PhaseTimes& times);

  /// Makes springs of balls that are of an older checkpoint, or of a run with another law, those of their pairs (contact/ball_contact.hpp).
  void set_axes_of_springs(const SolverScene& scene, const ParticleSet& p);

  /// All that pairs keep and did. Where pairs of balls lie in blocks, they are written back first.   Threads: not in a parallel region.
  std::vector<BodyPair>& pairs() { return write_back(), pairs_; }
  const std::vector<BodyPair>& pairs() const { return write_back(), pairs_; }
  std::vector<PairResult>& results() { return write_back(), results_; }
  const std::vector<PairResult>& results() const { return write_back(), results_; }
  /// The same, for loops over pairs that know which of them lie in blocks: state and results of those are out of date.
  std::vector<BodyPair>& stored_pairs() { return pairs_; }
  const std::vector<BodyPair>& stored_pairs() const { return pairs_; }
  std::vector<PairResult>& stored_results() { return results_; }
  const std::vector<PairResult>& stored_results() const { return results_; }
  std::vector<IdlePair>& idle() { return idle_; }
  const std::vector<IdlePair>& idle() const { return idle_; }
  /// What a pair does, wherever it lies, but for the energy of springs and the torque on a wall.   in   room   for it, where it lies in a
  /// block
  const PairResult& result_of(std::int32_t k, PairResult& room) const;
  /// The force of a pair on A, wherever it lies; null: the pair is not active.
  const Vec3* force_of(std::int32_t k) const {
    const std::int32_t place = blocks_.are_filled() ? blocks_.place_of(k) : BallBlocks::kOther;
    if (place >= 0) return blocks_.touches(place) ? &blocks_.slots()[static_cast<std::size_t>(place)].force : nullptr;
    const PairResult& result = results_[static_cast<std::size_t>(k)];
    return result.active ? &result.force_a : nullptr;
  }
  /// Ball contacts, in blocks; empty unless they have been moved there.
  BallBlocks& blocks() { return blocks_; }
  const BallBlocks& blocks() const { return blocks_; }
  /// Moves the pairs of balls in contact into blocks, unless they are there, and adds those of a class that have begun to touch in the step
  /// before.   in   scene   with lane laws for balls
  void fill_blocks(const SolverScene& scene, const ParticleSet& p, PairClass which);
  /// Pairs of a class whose results of this step are in the list though they waited for blocks or lie there; those that waited are added
  /// with the next step.   in   begun, left   ascending
  void take_out_of_blocks(PairClass which, std::span<const std::int32_t> begun, std::span<const std::int32_t> left, const ParticleSet& p);
  /// Writes back what lies in blocks, which then are empty.
  void write_back() const {
    if (blocks_.are_filled()) blocks_.write_back(pairs_, results_, idle_);
    for (std::vector<std::int32_t>& begun : begun_) begun.clear();
  }
  TravelBounds& travel() { return travel_; }
  const TravelBounds& travel() const { return travel_; }
  /// State of pairs that are not listed: what arrived since the lists were made, and what lasts while its bodies are apart.
  std::vector<WaitingState>& waiting() { return waiting_; }
  const std::vector<WaitingState>& waiting() const { return waiting_; }
  /// Indices of pairs among owned bodies and walls; of pairs with a ghost that this rank counts; and of those that the ghost's
  /// owner counts, and computes too.
  const std::vector<std::int32_t>& inner() const { return inner_; }
  const std::vector<std::int32_t>& outer() const { return outer_; }
  const std::vector<std::int32_t>& duplicated() const { return duplicated_; }
  /// Indices of pairs with a wall.
  const std::vector<std::int32_t>& with_walls() const { return with_walls_; }
  /// The wall zone of each of them: what every step reads of all of them stands in one row.
  const std::vector<std::int32_t>& zones_of_walls() const { return zones_of_walls_; }

  /// Takes pairs out of these lists, so that they are not computed; rebuild() lists them again.
  void hold_apart(const std::function<bool(const PairKey&)>& which);
  /// Puts one back. Returns its index, or -1 when it is not among the pairs.
  std::int32_t let_touch(const PairKey& key, const ParticleSet& p);

  /// Adds up what the pairs did to each owned body, in ascending order of partner: the same bits for any number of
  /// threads and ranks. Gravity included.
  void sum_onto_bodies(const Vec3& gravity, ParticleSet& p) const;

  /// Instead of sum_onto_bodies() where all owned bodies are balls and nothing else acts on them: takes them from the forces of a step to
  /// their places in the next (lanes/ball_motion.hpp). Needs filled blocks.
  /// in   dt, share   as in BallMotion     in/out   groups, rows   of the owned bodies     out   p   forces of some
  /// Threads: parallel inside.
  BallsMoved move_balls(const Vec3& gravity, double dt, double share, ParticleSet& p, std::vector<BallGroup>& groups,
                        std::vector<BallRow>& rows) const;

  /// Drops the lists of candidates of all pairs; results never depend on it (used by tests and after a restart).
  void forget_candidates();

 private:
  void sort_sides(const ParticleSet& p);
  std::vector<std::int32_t>& list_of(const BodyPair& pair, const ParticleSet& p);

  BallSums sums_of_blocks() const;
  void sum_blocks(const Vec3& gravity, ParticleSet& p) const;
  void sum_with_others(std::size_t i, const BallSums& sums, const Vec3& gravity, ParticleSet& p) const;
  void list_due(std::size_t row);
  void list_due_of(std::span<const std::int32_t> pairs, const ParticleSet& p);

  // Whether a pair lies here or in a block is no part of what the list says: a reader finds all of it here (write_back()).
  mutable std::vector<BodyPair> pairs_;
  mutable std::vector<PairResult> results_;
  mutable std::vector<IdlePair> idle_;
  mutable BallBlocks blocks_;
  mutable std::array<std::vector<std::int32_t>, kPairClasses> begun_;  // of each class, pairs that blocks take with the next step
  TravelBounds travel_;
  std::vector<WaitingState> waiting_;
  std::vector<std::int32_t> inner_, outer_, duplicated_, with_walls_, zones_of_walls_;
  // row starts of each body's pairs, and (pair, side) entries in ascending partner order
  std::vector<std::int32_t> start_, entry_;
  // of each body's entries those that may have a force while pairs lie in blocks, in the same order: their number, and from the same
  // start twice the place in blocks plus the side, or -1 less the entry
  std::vector<std::int32_t> due_count_, due_;
  std::vector<std::uint8_t> due_others_;  // some of them are not in blocks
  MultilevelGrid grid_;
};

}  // namespace scree
