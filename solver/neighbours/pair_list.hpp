// The body pairs of one rank: which bodies may touch, what each pair keeps between steps, and what it did in this step.
//
// Pairs are sorted by (first id, second id, zone). A pair of two bodies has the lower id as A; a body-wall pair has
// the body as A. A pair across ranks is held and computed by both owners, from the same bits.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "core/search/multilevel_grid.hpp"
#include "solver/bodies/particle_set.hpp"
#include "solver/contact/pair_force.hpp"
#include "solver/neighbours/travel_bounds.hpp"
#include "solver/phases.hpp"

namespace scree {

/// Kept between steps.
struct BodyPair {
  PairKey key;
  std::int32_t a = 0, b = 0;              ///< rows in ParticleSet; b is -1 for a wall zone
  std::unique_ptr<CandidateLists> lists;  ///< none until they are made; balls that go in lanes need none (lanes/ball_forces.hpp)
  PairState state;
};

/// Whether this rank counts a pair in sums over the scene: the owner of A does.
inline bool counts_here(const BodyPair& pair, const ParticleSet& p) { return static_cast<std::size_t>(pair.a) < p.owned; }

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

/// Written by one thread per pair and step, read by the gather. World axes. What every pair is asked for comes first.
struct PairResult {
  bool active = false;
  std::int32_t contact_count = 0;
  double overlap_ratio = 0;  ///< largest_overlap over margin sum
  double elastic = 0, tangential_elastic = 0;
  double surface_power = 0;          ///< of a wall's surface that moves [W]
  Vec3 force_a, torque_a, torque_b;  ///< force on b is -force_a; torques about each body's centre
  Vec3 dissipative_force_a, dissipative_torque_a, dissipative_torque_b;
};

/// What a step reads of a pair that nothing can happen to: kept apart from all else, 16 bytes.
struct IdlePair {
  std::int32_t a, b;  ///< as in BodyPair
  double way;         ///< of both together: until they have gone it the pair has no features [m]
};
inline constexpr double kNeverIdle = -1;  ///< such a pair is looked at in every step
inline constexpr double kTouching = -2;   ///< and so is one that touched in the last, which most likely still does

/// Bytes of the candidates of a pair.
std::size_t memory_of_candidates(const BodyPair& pair);
/// Bytes that a pair holds, its lists, state and result included.
std::size_t memory_of(const BodyPair& pair);

class PairList {
 public:
  /// Lists all pairs that can touch while no body moves further than `skin / 2`, keeps what known pairs hold, and
  /// hands waiting state to theirs. Pairs of two fixed bodies and of two ghosts are left out.
  void rebuild(const SolverScene& scene, const ParticleSet& p, const std::vector<WallState>& walls, double skin, PhaseTimes& times);

  std::vector<BodyPair>& pairs() { return pairs_; }
  const std::vector<BodyPair>& pairs() const { return pairs_; }
  std::vector<PairResult>& results() { return results_; }
  const std::vector<PairResult>& results() const { return results_; }
  std::vector<IdlePair>& idle() { return idle_; }
  const std::vector<IdlePair>& idle() const { return idle_; }
  TravelBounds& travel() { return travel_; }
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

  /// Takes pairs out of these lists, so that they are not computed; rebuild() lists them again.
  void hold_apart(const std::function<bool(const PairKey&)>& which);
  /// Puts one back. Returns its index, or -1 when it is not among the pairs.
  std::int32_t let_touch(const PairKey& key, const ParticleSet& p);

  /// Adds up what the pairs did to each owned body, in ascending order of partner: the same bits for any number of
  /// threads and ranks. Gravity included.
  void sum_onto_bodies(const Vec3& gravity, ParticleSet& p) const;

  /// Drops the lists of candidates of all pairs; results never depend on it (used by tests and after a restart).
  void forget_candidates();

 private:
  void sort_sides(const ParticleSet& p);
  std::vector<std::int32_t>& list_of(const BodyPair& pair, const ParticleSet& p);

  std::vector<BodyPair> pairs_;
  std::vector<PairResult> results_;
  std::vector<IdlePair> idle_;
  TravelBounds travel_;
  std::vector<WaitingState> waiting_;
  std::vector<std::int32_t> inner_, outer_, duplicated_, with_walls_;
  // row starts of each body's pairs, and (pair, side) entries in ascending partner order
  std::vector<std::int32_t> start_, entry_;
  MultilevelGrid grid_;
};

}  // namespace scree
