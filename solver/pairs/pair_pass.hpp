// One pass over pairs, as all that works on it sees it.
#pragma once

#include <atomic>
#include <optional>
#include <vector>

#include "solver/contact/ball_contact.hpp"
#include "solver/contact/pair_force.hpp"
#include "solver/pairs/force_scratch.hpp"

namespace scree {

/// The first of the pairs, in the order of the list, that make the run invalid in some way: the same one whichever is computed first.
class FailedPair {
 public:
  void add(std::int32_t k) {
    std::int32_t least = k_.load();
    while ((least < 0 || k < least) && !k_.compare_exchange_weak(least, k)) {
    }
  }
  bool exists() const { return k_.load() >= 0; }
  std::int32_t index() const { return k_.load(); }

 private:
  std::atomic<std::int32_t> k_{-1};
};

/// One evaluation of pairs: what all threads read, and what any of them may find wrong.
struct PairPass {
  const SolverScene& scene;
  const ParticleSet& p;
  const std::vector<WallState>& walls;
  double dt, friction_dt;
  ForceScratch& scratch;
  PairList& list;
  PairObservers observers;
  PairForceFunction force_of;
  BallForceFunction force_of_balls;   ///< null where no pair is a ball contact
  PairHoldsFunction holds;            ///< null where no pair remembers whether it has touched
  double stop_ratio;                  ///< overlap over the maximum overlap of a pair at which a run is stopped
  bool has_bonds;                     ///< pairs may count their overlap from one that they had as their bond broke
  bool continues;                     ///< beyond that ratio pairs go on (contact/overlap_limit.hpp)
  bool examines = false;              ///< for observers alone, one thread: neither springs nor candidates' idle times change
  bool at_rest = false;               ///< only results are asked for, of pairs whose springs stay as they are to the bit
  std::optional<PairClass> blocks{};  ///< the pass is over all pairs of this class, those in blocks too
  bool has_ball_rows = false;         ///< scratch.ball_rows are those of the present places already
  bool has_columns = true;            ///< so are the columns of p; if not, pairs that need these are left in scratch.left
  FailedPair intersecting{}, passing{}, through{};

  bool is_read_only() const { return examines || at_rest; }
  /// Whether pairs may be computed in lanes (ball_evaluation.hpp, mesh_evaluation.hpp), which leave out what PairEvaluation alone does.
  bool allows_lanes() const { return !any_observes_bodies(observers); }
  /// A step of the run that asks for forces, and for nothing that lanes leave out.
  bool asks_for_forces_alone() const { return friction_dt > 0 && friction_dt == dt && !is_read_only() && allows_lanes(); }
  /// Of both bodies together since the lists were made [m].
  double way_of(const IdlePair& idle) const { return list.travel()[idle.a] + (idle.b >= 0 ? list.travel()[idle.b] : 0.0); }
};

}  // namespace scree
