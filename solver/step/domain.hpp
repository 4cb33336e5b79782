// Who leaves a run: bodies in outlets and outside the domain. And what becomes of states that are not finite.
#pragma once

#include <cstdint>
#include <unordered_set>
#include <vector>

#include "solver/ranks/failure.hpp"
#include "solver/state/run_state.hpp"

namespace scree {

/// In place of an outlet: a body left the domain; a program took it out.
inline constexpr std::int32_t kLeftDomain = -1, kTakenOut = -2;

/// A body that was taken out.
struct RemovedBody {
  std::int64_t id, step;
  double time, mass;
  Vec3 x, v;
  double entered;       ///< when it came into the run [s]
  std::int32_t outlet;  ///< that it was in; kLeftDomain, kTakenOut
};

/// Whether a place is outside a bounded domain; never across a periodic axis.
bool is_outside(const SolverScene& scene, const Vec3& x);

/// Throws RunInvalid naming the first owned body whose state is not finite.
void check_finite(const RunState& s);

/// Watches the domain of a scene and its outlets, and takes bodies out where the case asks for that.
class DomainGuard {
 public:
  /// Looks at the bodies every kReviewSteps: a body outside is a failure, or is to be removed. Every kExchangeSteps, what is in an outlet
  /// is to be removed. Collective.
  /// Returns whether bodies of any rank are to be removed: at the rebuild of lists in this step, by remove().
  bool review(const RunState& s, FirstFailure& failure);
  /// Takes these bodies of any rank out in the next step, counted as those that leave the domain. Each rank may name others. Collective.
  /// Throws UsageError on every rank for an id that no body has.
  void ask_removal(const RunState& s, const std::vector<std::int64_t>& mine);
  const std::unordered_set<std::int64_t>& asked() const { return asked_; }
  bool is_removal_asked() const { return !asked_.empty(); }
  bool is_removal_due() const { return removal_due_; }
  /// Of each owned row, after review(), whether it is to be taken out.
  std::vector<std::uint8_t> leaving(const RunState& s) const;
  /// Takes out what review() found, before ghosts are made. Between the two kicks of a step.
  /// Returns whether bodies of any rank left: the same on all.
  bool remove(RunState& s);
  /// Bodies removed since the last call, by step and id; on rank 0. Collective.
  std::vector<RemovedBody> take_removed(const mpi::Communicator& comm);
  void drop_removed() { removed_.clear(); }

 private:
  struct Returning {
    std::int32_t inlet;
    TransitBody body;
  };
  void queue_for_return(RunState& s, const std::vector<Returning>& mine) const;

  std::vector<RemovedBody> removed_;        // by this rank
  std::unordered_set<std::int64_t> asked_;  // ids that are to be taken out in any case, the same on every rank
  bool removal_due_ = false;
};

}  // namespace scree
