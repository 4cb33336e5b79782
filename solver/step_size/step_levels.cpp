#include "solver/step_size/step_levels.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "solver/bodies/body_passes.hpp"
#include "solver/step_size/stability.hpp"
#include "solver/step_size/step_size.hpp"

namespace scree {

namespace {

// Contacts are looked at this often: after so many quiet steps the step may grow.
constexpr std::int64_t kContactReviewSteps = 128;
constexpr double kSlack = 0.99;       // of a factor of two: rounding of the step that was derived from the same contact
constexpr double kHysteresis = 1.25;  // the step grows only when it would not shrink again at once
constexpr std::int64_t kFinestLevel = 20;

enum Reason : std::size_t { kSpeed, kSpin, kContact, kReasons };

/// What each reason asks for [1/s], and the body that does.
struct Demand {
  std::array<double, kReasons> rate{};
  std::array<std::int64_t, kReasons> body{-1, -1, -1};  // -1: none, or a wall
  CriticalStep critical;                                // of the present contacts

  void ask(Reason reason, double value, std::int64_t id) {
    if (value > rate[reason] || (value == rate[reason] && id < body[reason])) {
      rate[reason] = value;
      body[reason] = id;
    }
  }
  Reason strictest() const { return static_cast<Reason>(std::max_element(rate.begin(), rate.end()) - rate.begin()); }
  std::string text() const {
    const Reason most = strictest();
    if (most == kContact) return "contact of " + critical.name();
    if (body[most] < 0) return "speed of a wall";
    return fmt::format("{} of body {}", most == kSpeed ? "speed" : "spin", body[most]);
  }
};

/// What bodies and walls ask for by how they move.
Demand demand_of_motion(const RunState& s) {
  Demand demand;
  const ParticleSet& p = s.particles;
  const double way = 0.5 * kMarginPerStep * s.scene.smallest_max_overlap();
  const double in_range = 0.5 * kRangePerStep * s.scene.shortest_range(), sticking = s.scene.fastest_sticking() / kStickingPerStep;
  const bool can_touch = s.clock.size.contact_time > 0 && (way > 0 || in_range > 0);
  const auto rate_of = [&](double speed) {
    const double of_margin = way > 0 ? speed / way : 0, of_range = in_range > 0 ? std::min(speed / in_range, sticking) : 0;
    return std::max(of_margin, of_range);
  };
  for (std::size_t i = 0; i < p.owned; ++i) {
    if (p.fixed[i]) continue;
    const double turning = length(p.w[i]);
    if (can_touch) demand.ask(kSpeed, rate_of(length(p.v[i]) + p.scale[i] * s.scene.shape(p.shape[i]).turning_arm * turning), p.id[i]);
    if (!p.isotropic[i]) demand.ask(kSpin, turning / kTurnPerStep, p.id[i]);
  }
  if (const double walls = can_touch ? rate_of(fastest_wall(s, s.walls)) : 0; walls > demand.rate[kSpeed]) {
    demand.rate[kSpeed] = walls;
    demand.body[kSpeed] = -1;
  }
  for (const Reason reason : {kSpeed, kSpin}) {
    const double most = s.comm.max(demand.rate[reason]);
    constexpr double kNone = 1e18;
    const double id = -s.comm.max(-(demand.rate[reason] == most ? static_cast<double>(demand.body[reason]) : kNone));
    demand.rate[reason] = most;
    demand.body[reason] = static_cast<std::int64_t>(id);
  }
  return demand;
}

std::int64_t level_for(const RunState& s, double rate) {
  return rate > 0 ? std::max<std::int64_t>(0, static_cast<std::int64_t>(std::ceil(std::log2(kSlack * rate * s.clock.size.step)))) : 0;
}

}  // namespace

void StepLevels::begin(RunState& s, ForceScratch& scratch, FirstFailure& failure) { choose(s, scratch, failure, false); }

bool StepLevels::begin_with_contacts(RunState& s, ForceScratch& scratch, FirstFailure& failure) {
  const std::int64_t before = s.clock.level;
  choose(s, scratch, failure, true);
  return s.clock.level != before;
}

void StepLevels::review(RunState& s, ForceScratch& scratch, FirstFailure& failure) {
  if (s.clock.step % kReviewSteps == 0) choose(s, scratch, failure, s.clock.step % kContactReviewSteps == 0);
}

void StepLevels::choose(RunState& s, ForceScratch& scratch, FirstFailure& failure, bool with_contacts) {
  const Settings& settings = s.scene.source().settings;
  if (settings.step_control != StepControl::quantised) return;
  Demand demand = demand_of_motion(s);
  if (with_contacts) {
    // steps_per_contact of half a period pi / omega, with omega = 2 / critical step
    demand.critical = critical_step(s, scratch);
    demand.rate[kContact] = 2 * settings.steps_per_contact / (std::numbers::pi * demand.critical.step);
  }
  const double rate = demand.rate[demand.strictest()];
  const std::int64_t level = level_for(s, rate), present = s.clock.level;
  if (level > kFinestLevel) {
    failure.keep(
        RunInvalid("step {}: the {} requires a step of {:.3g} s, 2^{} times smaller than {:.3g} s and below the minimum; check for "
                   "unphysical velocities or stiffness",
                   s.clock.step, demand.text(), 1 / rate, level, s.clock.size.step),
        s.clock.step);
    return;
  }
  if (level > present) return change(s, level, demand.text());
  if (level < present && with_contacts && level_for(s, kHysteresis * rate) < present) change(s, present - 1, "quiet");
}

void StepLevels::change(RunState& s, std::int64_t level, const std::string& reason) {
  const double before = s.clock.dt;
  s.clock.set_level(level);
  changed_ = true;
  changes_.push_back({s.clock.step, s.clock.time(), s.clock.dt, reason});
  if (s.clock.step == 0) return;
  // The forces of this step act half before and half after the change.
  const double difference = 0.5 * (s.clock.dt - before);
  add_wall_effects(s, difference, s.totals.walls);
  add_dissipation(s, difference);
  for (const std::unique_ptr<Effect>& effect : s.effects) effect->on_step_change(s, difference);
}

void check_displacement(const RunState& s, const std::function<std::string(std::size_t)>& cause_of) {
  if (!(s.clock.size.contact_time > 0)) return;  // nothing can meet
  const ParticleSet& p = s.particles;
  const double dt = s.clock.dt;
  const std::size_t i = find_row_that_goes_far(p, dt, kRadiusPerStep, 0, p.owned);
  if (i == p.owned) return;
  std::string cause = cause_of ? cause_of(i) : std::string();
  if (cause.empty()) cause = fmt::format("give a step of at most {:.3g} s", kRadiusPerStep * p.radius[i] / length(p.v[i]));
  throw RunInvalid(
      "step {}: body {} moves {:.3g} m in a step of {:.3g} s, more than a tenth of its radius of {:.3g} m; it could pass through "
      "others unseen: {}",
      s.clock.step, p.id[i], length(p.v[i]) * dt, dt, p.radius[i], cause);
}

}  // namespace scree
