// Quantised steps: the step is divided by a power of two, its level, as speeds, spins and the present contacts ask for. And the guard
// against a step in which a body could pass another unseen.
#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "solver/pairs/forces.hpp"
#include "solver/ranks/failure.hpp"
#include "solver/state/run_state.hpp"

namespace scree {

/// The step changed, at the end of a step.
struct StepChange {
  std::int64_t step;
  double time, step_size;
  std::string reason;
};

class StepLevels {
 public:
  /// Chooses the level as a run begins, before forces are known. Does nothing unless the scene asks for quantised steps. Collective.
  void begin(RunState& s, ForceScratch& scratch, FirstFailure& failure);
  /// The same with the contacts that there are, once their forces are. Returns whether the step changed.
  bool begin_with_contacts(RunState& s, ForceScratch& scratch, FirstFailure& failure);
  /// Chooses it every kReviewSteps, at the end of a step. The present contacts are looked at in some of these, for a few percent of the
  /// time; only then may the step grow. Collective.
  void review(RunState& s, ForceScratch& scratch, FirstFailure& failure);
  /// Whether the level changed since the last call: lists are made for the step.
  bool take_change() { return std::exchange(changed_, false); }
  /// All changes since the last call, the same on every rank.
  std::vector<StepChange> take_changes() { return std::exchange(changes_, {}); }

 private:
  void choose(RunState& s, ForceScratch& scratch, FirstFailure& failure, bool with_contacts);
  void change(RunState& s, std::int64_t level, const std::string& reason);

  bool changed_ = false;
  std::vector<StepChange> changes_;
};

// Two bodies must not pass each other between two searches for neighbours: at this share of its radius a step, what a body could miss is
// smaller than the skin of the lists. Pairs that are listed are watched by evaluate_pairs.
inline constexpr double kRadiusPerStep = 0.1;

/// Throws RunInvalid for the first body that moves so far in a step that it could miss another.
/// in   cause_of   why a body, by its row, moves so far, and what to do; "", or none: a shorter step cures it
void check_displacement(const RunState& s, const std::function<std::string(std::size_t)>& cause_of);

}  // namespace scree
