#include "solver/step/ball_steps.hpp"

#include <omp.h>

#include <algorithm>
#include <cmath>
#include <utility>

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

bool go_without_break(const RunState& s) {
  const ParticleSet& p = s.particles;
  const Settings& settings = s.scene.source().settings;
  if (!built_with::kRotation || s.comm.size() > 1 || !s.effects.empty() || s.fluid || s.clock.level > 0 ||
      settings.step_control == StepControl::quantised || s.integrator == Integrator::euler || s.scene.periodicity().any() ||
      p.cell.deforms() || s.scene.has_driven_walls() || s.scene.has_moving_surfaces() || s.scene.has_answering_walls() ||
      !s.scene.source().inlets.empty() || !may_use_blocks(s.scene, p))
    return false;
  const LaneLaws& laws = s.scene.ball_laws();
  if (std::count(laws.holds.begin(), laws.holds.end(), 0) > 0 ||
      std::any_of(laws.row_of_zone.begin(), laws.row_of_zone.end(), [](std::int32_t row) { return row < 0; }))
    return false;  // some pairs go the general path in every step
  for (std::size_t i = 0; i < p.size(); ++i)
    if (!(p.ball_radius[i] > 0) || p.isotropic[i] == 0) return false;
  return true;
}

/// Calls action(begin, end) with the groups of the calling thread. In a parallel region.
template <class Action>
void BallSteps::each_share(Action&& action) const {
  const auto thread = static_cast<std::size_t>(omp_get_thread_num()), threads = static_cast<std::size_t>(omp_get_num_threads());
  action(groups_.size() * thread / threads, groups_.size() * (thread + 1) / threads);
}

/// Whether no body can have moved further than the lists allow. The fastest body of each step alone says how far any may be; where that is
/// not enough, all are asked.
bool BallSteps::lists_hold(const RunState& s, const NeighbourLists& lists) {
  const double limit = lists.limit();
  if (listed_ + 0.5 * (bound_ - bound_then_) <= limit) return true;
  const ParticleSet& p = s.particles;
  double squared = 0;
  bool has_numbers = true;
#pragma omp parallel reduction(max : squared) reduction(&& : has_numbers)
  each_share([&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin * BallGroup::kBalls; i < std::min(end * BallGroup::kBalls, p.owned); ++i) {
      const BallGroup& group = groups_[i / BallGroup::kBalls];
      const std::size_t n = i % BallGroup::kBalls;
      const double moved = squared_length(Vec3{group.x[0][n], group.x[1][n], group.x[2][n]} - p.x_listed[i]);
      squared = std::max(squared, moved);
      has_numbers = has_numbers && std::isfinite(moved);
    }
  });
  listed_ = kRounding * std::sqrt(squared);
  bound_then_ = bound_;
  return has_numbers && listed_ <= limit;
}

bool BallSteps::run(RunState& s, ForceStep& forces, Balance& balance, FirstFailure& failure, const NeighbourLists& lists,
                    const Requests& requests, std::int64_t last) {
  last = next_break(s, last);
  if (last - s.clock.step < kFewest) return false;
  if (std::exchange(looked_at_, lists.rebuilds()) != lists.rebuilds() || !s.effects.empty()) may_run_ = go_without_break(s);
  if (!may_run_) return false;
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
  const double dt = s.clock.dt;
  const std::function<void()> write_columns = [this, &s, &forces] { leave(s, forces); };
  enter(s, forces);
  bool moved = false, failed = false;
  while (s.clock.step < last && !requests.is_signal_caught() && lists_hold(s, lists)) {
    s.pairs.fill_blocks(s.scene, p, PairClass::inner);
    if (s.pairs.blocks().count_outside() > 0) break;
    forces.compute_balls(s, balance, failure, waiting_.due(bound_, s.pairs), write_columns);
    // a single step ends such a one, without its pairs
    if ((failed = failure.exists())) break;
    waiting_.note(bound_, s.pairs);
    const PhaseTimer timer(s.times, Phase::integrate);
    add_wall_impulses_of_balls(s, dt, pairs_outside(forces), s.totals.walls);
    const BallsMoved found =
        s.pairs.move_balls(s.scene.source().settings.gravity, dt, kRadiusPerStep, p, groups_, forces.scratch().ball_rows);
    s.clock.advance();
    bound_ += kRounding * (2 * dt * std::sqrt(found.squared_speed));
    ++count_;
    moved = true;
    if (found.go_far) {
      leave(s, forces);
      failure.watch(s.clock.step, [&] { check_displacement(s, {}); });
      if (failure.exists()) break;
    }
  }
  leave(s, forces);
  if (moved) s.pairs.travel().add_to_balls(p, 0.5 * bound_);
  return moved && !failed;
}

/// Pairs of this step whose results do not lie in blocks.
std::span<const std::int32_t> BallSteps::pairs_outside(ForceStep& forces) {
  const std::vector<std::int32_t>& due = waiting_.last_due();
  const std::vector<std::int32_t>& left = forces.scratch().left;
  if (left.empty()) return due;
  outside_ = due;
  for (const std::int32_t k : left)
    if (std::find(due.begin(), due.end(), k) == due.end()) outside_.push_back(k);
  return outside_;
}

void BallSteps::enter(RunState& s, ForceStep& forces) {
  const PhaseTimer timer(s.times, Phase::integrate);
  const ParticleSet& p = s.particles;
  s.pairs.travel().add_motion_of_owned(p);
  waiting_.begin(s.pairs, PairClass::inner);
  groups_.resize(group_count(p));
  std::vector<BallRow>& rows = forces.scratch().ball_rows;
  rows.resize(groups_.size() * BallGroup::kBalls);
#pragma omp parallel
  each_share([&](std::size_t begin, std::size_t end) { group_balls(p, begin, end, groups_.data(), rows.data()); });
}

void BallSteps::leave(RunState& s, ForceStep& forces) {
  const PhaseTimer timer(s.times, Phase::integrate);
#pragma omp parallel
  each_share([&](std::size_t begin, std::size_t end) {
    ungroup_balls(groups_.data(), forces.scratch().ball_rows.data(), begin, end, s.particles);
  });
}

}  // namespace scree
