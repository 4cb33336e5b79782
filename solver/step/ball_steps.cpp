#include "solver/step/ball_steps.hpp"

#include <omp.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "solver/step/balls_alone.hpp"
#include "solver/step_size/step_levels.hpp"

namespace scree {

namespace {

constexpr double kRounding = 1 + 1e-9;  // far above that of the sums of a run of steps
constexpr std::int64_t kFewest = 4;     // steps that are worth beginning
constexpr std::int64_t kStepsBetweenFills = 64;
constexpr double kWallsNearlyThere = 0.9;  // of what lists allow: beyond, they are soon made again

/// The last step that may be reached before single steps look at something.
std::int64_t next_break(const RunState& s, std::int64_t last) {
  const Domain& domain = s.scene.source().settings.domain;
  const bool is_reviewed = (domain.bounded && domain.outside != Outside::keep) || !s.scene.outlets().empty();
  return is_reviewed ? std::min(last, (s.clock.step / kReviewSteps + 1) * kReviewSteps) : last;
}

double farthest_coordinate(const ParticleSet& p) {
  double farthest = 0;
  const auto count = static_cast<std::ptrdiff_t>(p.owned);
#pragma omp parallel for schedule(static) reduction(max : farthest)
  for (std::ptrdiff_t i = 0; i < count; ++i) {
    const Vec3& x = p.x[static_cast<std::size_t>(i)];
    farthest = std::max({farthest, std::abs(x.x), std::abs(x.y), std::abs(x.z)});
  }
  return farthest;
}

}  // namespace

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
  if (walls_listed_ > limit) return false;
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

/// Returns whether lists last for some steps more.   in   s   columns of bodies are up to date
bool BallSteps::begin_walls(const RunState& s, const NeighbourLists& lists) {
  walls_listed_ = walls_way_ = 0;
  if (!s.scene.has_driven_walls()) return true;
  walls_listed_ = lists.walls_have_moved(s);
  if (walls_listed_ > kWallsNearlyThere * lists.limit()) return false;
  wall_reach_.clear();
  for (std::size_t w = 0; w < s.walls.size(); ++w) wall_reach_.push_back(farthest_from_wall(s, w, s.walls[w].position));
  return true;
}

/// Walls of the step that has begun.
void BallSteps::move_walls(RunState& s) {
  if (!s.scene.has_driven_walls()) return;
  walls_before_.swap(s.walls);
  s.set_walls();
  double moved = 0;
  for (std::size_t w = 0; w < s.walls.size(); ++w) {
    const double shift = length(s.walls[w].position - walls_before_[w].position);
    // bodies and walls have moved since the distance was measured
    const double farthest = wall_reach_[w] + bound_ + walls_way_ + shift;
    moved = std::max(moved, shift + chord_of_turn(walls_before_[w], s.walls[w]) * farthest);
  }
  walls_listed_ += kRounding * moved;
  walls_way_ += kRounding * moved;
}

bool BallSteps::run(RunState& s, ForceStep& forces, Balance& balance, FirstFailure& failure, const NeighbourLists& lists,
                    const Requests& requests, std::int64_t last) {
  last = next_break(s, last);
  if (last - s.clock.step < kFewest) return false;
  if (!are_effects_idle(s)) return false;
  if (std::exchange(looked_at_, lists.rebuilds()) != lists.rebuilds()) may_run_ = are_balls_alone(s);
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

  // a place is rounded; what it lacks is in its remainder
  bound_ = bound_then_ = 4 * std::numeric_limits<double>::epsilon() * farthest_coordinate(p);
  listed_ = lists.limit();  // asked when it matters
  const double dt = s.clock.dt;
  if (!begin_walls(s, lists)) return false;
  const std::function<void()> write_columns = [this, &s, &forces] { leave(s, forces); };
  enter(s, forces);
  bool moved = false, failed = false;
  while (s.clock.step < last && !requests.is_signal_caught() && lists_hold(s, lists)) {
    s.pairs.fill_blocks(s.scene, p, PairClass::inner);
    if (s.pairs.blocks().count_outside() > 0) break;
    forces.compute_balls(s, balance, failure, waiting_.due(bound_ + walls_way_, s.pairs), write_columns);
    // a single step ends such a one, without its pairs
    if ((failed = failure.exists())) break;
    waiting_.note(bound_ + walls_way_, s.pairs);
    const PhaseTimer timer(s.times, Phase::integrate);
    add_wall_effects_of_balls(s, forces.scratch().ball_rows, dt, pairs_outside(forces), s.totals.walls);
    const BallsMoved found =
        s.pairs.move_balls(s.scene.source().settings.gravity, dt, kRadiusPerStep, p, groups_, forces.scratch().ball_rows);
    s.clock.advance();
    bound_ += kRounding * (2 * dt * std::sqrt(found.squared_speed));
    move_walls(s);
    ++count_;
    moved = true;
    if (found.go_far) {
      leave(s, forces);
      failure.watch(s.clock.step, [&] { check_displacement(s, {}); });
      break;
    }
  }
  leave(s, forces);
  if (s.scene.has_driven_walls()) waiting_.end_of_walls(s.pairs);
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
    if (!std::binary_search(due.begin(), due.end(), k)) outside_.push_back(k);
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
