#include "solver/step/ball_steps.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "solver/bodies/body_passes.hpp"
#include "solver/built_with.hpp"
#include "solver/step_size/step_levels.hpp"

namespace scree {

namespace {

constexpr double kRounding = 1 + 1e-9;  // far above that of the sums of a run of steps
constexpr std::int64_t kFewest = 4;     // steps that are worth beginning
constexpr std::int64_t kStepsBetweenFills = 64;

/// The last step that may be reached before single steps look at something.
std::int64_t next_break(const RunState& s, std::int64_t last) {
  const bool is_reviewed = s.scene.source().settings.domain.bounded || !s.scene.outlets().empty();
  return is_reviewed ? std::min(last, (s.clock.step / kReviewSteps + 1) * kReviewSteps) : last;
}

}  // namespace

bool BallSteps::may_run(const RunState& s, const NeighbourLists& lists) {
  const ParticleSet& p = s.particles;
  const Settings& settings = s.scene.source().settings;
  if (!built_with::kRotation || s.comm.size() > 1 || !s.effects.empty() || s.fluid || s.clock.level > 0 ||
      settings.step_control == StepControl::quantised || s.integrator == Integrator::euler || s.scene.periodicity().any() ||
      p.cell.deforms() || s.scene.has_driven_walls() || s.scene.has_moving_surfaces() || s.scene.has_answering_walls() ||
      !s.scene.source().inlets.empty() || !may_use_blocks(s.scene, p))
    return false;
  if (std::exchange(looked_at_, lists.rebuilds()) != lists.rebuilds()) {
    all_balls_ = p.owned == p.size();
    for (std::size_t i = 0; i < p.owned && all_balls_; ++i) all_balls_ = p.ball_radius[i] > 0 && p.isotropic[i] != 0;
  }
  return all_balls_;
}

/// Whether no body can have moved further than the lists allow. The fastest body of each step alone says how far any may be; where that is
/// not enough, all are asked.
bool BallSteps::lists_hold(const RunState& s, const NeighbourLists& lists) {
  const double limit = lists.limit();
  if (listed_ + 0.5 * (bound_ - bound_then_) <= limit) return true;
  double squared = 0;
#pragma omp parallel reduction(max : squared)
  for_awake_rows_of_thread(s.particles, [&](std::size_t begin, std::size_t end) {
    squared = std::max(squared, find_farthest_from_list(s.particles, begin, end));
  });
  listed_ = kRounding * std::sqrt(squared);
  bound_then_ = bound_;
  return listed_ <= limit;
}

bool BallSteps::run(RunState& s, ForceStep& forces, Balance& balance, FirstFailure& failure, const NeighbourLists& lists,
                    const Requests& requests, std::int64_t last) {
  last = next_break(s, last);
  if (last - s.clock.step < kFewest || !may_run(s, lists)) return false;
  ParticleSet& p = s.particles;
  s.pairs.fill_blocks(s.scene, p, PairClass::inner);
  if (s.pairs.blocks().count_outside() > 0) {
    // what lanes have left to the general path once may fit them again
    if (s.clock.step < filled_again_ + kStepsBetweenFills) return false;
    filled_again_ = s.clock.step;
    s.pairs.write_back();
    s.pairs.fill_blocks(s.scene, p, PairClass::inner);
    if (s.pairs.blocks().count_outside() > 0) return false;
  }

  bound_ = bound_then_ = 0;
  listed_ = lists.limit();  // asked when it matters
  const double dt = s.clock.dt, smallest = s.facts.smallest_radius;
  std::vector<BallRow>& rows = forces.scratch().ball_rows;
  {
    const PhaseTimer timer(s.times, Phase::contact);
    s.pairs.travel().add_motion_of_owned(p);
    waiting_.begin(s.pairs, PairClass::inner);
    rows.resize(p.size());
#pragma omp parallel
    for_awake_rows_of_thread(p, [&](std::size_t begin, std::size_t end) { collect_ball_rows(p, begin, end, rows.data()); });
  }
  bool moved = false;
  while (s.clock.step < last && !failure.exists() && !requests.is_signal_caught() && lists_hold(s, lists)) {
    s.pairs.fill_blocks(s.scene, p, PairClass::inner);
    if (s.pairs.blocks().count_outside() > 0) break;
    forces.compute_balls(s, balance, failure, waiting_.due(bound_, s.pairs));
    waiting_.note(bound_, s.pairs);
    const PhaseTimer timer(s.times, Phase::integrate);
    add_wall_effects(s, dt, s.totals.walls);
    const double fastest = s.pairs.move_balls(s.scene.source().settings.gravity, dt, p, rows);
    s.clock.advance();
    bound_ += kRounding * (2 * dt * fastest);
    ++count_;
    moved = true;
    if (fastest * dt > kRadiusPerStep * smallest) failure.watch(s.clock.step, [&] { check_displacement(s, {}); });
  }
  if (moved) s.pairs.travel().add_to_balls(p, 0.5 * bound_);
  return moved;
}

}  // namespace scree
