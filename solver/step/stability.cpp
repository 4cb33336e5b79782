// Whether the step is small enough for the contacts that there are, and the guards against what it is not.
#include <algorithm>
#include <array>
#include <cmath>
#include <unordered_map>

#include "solver/bodies/motion.hpp"
#include "solver/step/simulation.hpp"

namespace scree {

namespace {

struct NamedBound {
  std::int64_t id;
  BodyBound bound;
};

}  // namespace

CriticalStep Simulation::critical_step() {
  // Pairs lie sorted by key, and so do their numbers.
  std::vector<std::int32_t> touching;
  for (const auto* which : {&pairs_.inner(), &pairs_.outer(), &pairs_.duplicated()}) {
    for (const std::int32_t k : *which) {
      if (pairs_.results()[static_cast<std::size_t>(k)].active) touching.push_back(k);
    }
  }
  std::sort(touching.begin(), touching.end());
  StabilityBound bounds(p_.size());
  const LineariseFunction function = linearise_function(scene_.law_choice());
  const PairVisitor look = [&](const PairContact& pair) { bounds.add(linearise(pair, function)); };
  visit_pairs(scene_, p_, walls_, touching, step_, scratch_, pairs_, look);

  // The owner of a ghost knows all of its pairs.
  if (comm_.size() > 1) {
    std::vector<NamedBound> shared;
    std::vector<std::uint8_t> is_shared(p_.size(), 0);
    for (const std::int32_t k : touching) {
      const BodyPair& pair = pairs_.pairs()[static_cast<std::size_t>(k)];
      if (pair.b < 0) continue;
      const auto a = static_cast<std::size_t>(pair.a), b = static_cast<std::size_t>(pair.b);
      if ((a < p_.owned) == (b < p_.owned)) continue;
      const std::size_t own = a < p_.owned ? a : b;
      if (is_shared[own]++ == 0) shared.push_back({p_.id[own], bounds.bound_of(own)});
    }
    const auto ranks = static_cast<std::size_t>(comm_.size());
    std::unordered_map<std::int64_t, BodyBound> of_id;
    for (const auto& block : comm_.exchange(std::vector<std::vector<NamedBound>>(ranks, shared))) {
      for (const NamedBound& n : block) of_id[n.id] = n.bound;
    }
    for (std::size_t i = p_.owned; i < p_.size(); ++i) {
      if (const auto it = of_id.find(p_.id[i]); it != of_id.end()) bounds.set_bound(i, it->second);
    }
  }

  CriticalStep critical = bounds.critical_step(scene_.source().settings.law != ContactLaw::hunt_crossley);
  if (comm_.size() > 1) {
    const auto ranks = static_cast<std::size_t>(comm_.size());
    for (const auto& block : comm_.exchange(std::vector<std::vector<CriticalStep>>(ranks, {critical}))) {
      const CriticalStep& other = block.front();
      if (other.step < critical.step || (other.step == critical.step && other.key < critical.key)) critical = other;
    }
  }
  return critical;
}

double Simulation::shadow_energy_gap() const {
  std::vector<ExactSum> sum(1);
  for (std::size_t i = 0; i < p_.owned; ++i) {
    if (p_.fixed[i]) continue;
    const Vec3 torque = rotate_inverse(p_.q[i], p_.torque[i]);
    const Vec3& w = p_.inverse_inertia[i];
    sum[0].add(squared_length(p_.force[i]) * p_.inverse_mass[i] + torque.x * torque.x * w.x + torque.y * torque.y * w.y +
               torque.z * torque.z * w.z);
  }
  add_over_ranks(comm_.get(), sum);
  return sum[0].value() * dt_ * dt_ / 8;
}

std::pair<std::int64_t, double> Simulation::fastest_body() const {
  // by kinetic energy; the lower id among equals
  double most = -1;
  std::int64_t id = -1;
  for (std::size_t i = 0; i < p_.owned; ++i) {
    const double kinetic = translational_energy(p_, i) + rotational_energy(p_, i);
    if (kinetic > most || (kinetic == most && p_.id[i] < id)) {
      most = kinetic;
      id = p_.id[i];
    }
  }
  const double overall = comm_.max(most);
  const double none = 1e18;
  const double lowest = -comm_.max(-(most == overall && id >= 0 ? static_cast<double>(id) : none));
  return {lowest < none ? static_cast<std::int64_t>(lowest) : -1, overall};
}

void Simulation::choose_level(bool with_contacts) {
  const Settings& settings = scene_.source().settings;
  if (settings.step_control != StepControl::quantised) return;
  // what each reason asks for [1/s], and the body that does
  enum : std::size_t { speed, spin, contact, count };
  std::array<double, count> rate{};
  std::array<std::int64_t, count> body{-1, -1, -1};
  const auto ask = [&](std::size_t reason, double value, std::int64_t id) {
    if (value > rate[reason] || (value == rate[reason] && id < body[reason])) {
      rate[reason] = value;
      body[reason] = id;
    }
  };
  const double way = kMarginPerStep * scene_.margin();
  const bool can_touch = step_size_.contact_time > 0 && way > 0;
  for (std::size_t i = 0; i < p_.owned; ++i) {
    if (p_.fixed[i]) continue;
    const double turning = length(p_.w[i]);
    if (can_touch) ask(speed, (length(p_.v[i]) + p_.scale[i] * scene_.shape(p_.shape[i]).turning_arm * turning) / way, p_.id[i]);
    if (!p_.isotropic[i]) ask(spin, turning / kTurnPerStep, p_.id[i]);
  }
  if (can_touch) {
    const double walls = fastest_wall(walls_) / way;
    if (walls > rate[speed]) ask(speed, walls, -1);
  }
  for (const std::size_t reason : {std::size_t{speed}, std::size_t{spin}}) {
    const double most = comm_.max(rate[reason]);
    const double none = 1e18;
    const double id = -comm_.max(-(rate[reason] == most ? static_cast<double>(body[reason]) : none));
    rate[reason] = most;
    body[reason] = static_cast<std::int64_t>(id);
  }
  CriticalStep critical;
  if (with_contacts) {
    // steps_per_contact of half a period pi / omega, with omega = 2 / critical step
    critical = critical_step();
    rate[contact] = 2 * settings.steps_per_contact / (3.14159265358979323846 * critical.step);
  }

  constexpr double kSlack = 0.99;       // of a factor of two: rounding of the step that was derived from the same contact
  constexpr double kHysteresis = 1.25;  // the step grows only when it would not shrink again at once
  constexpr std::int64_t kFinest = 20;
  const auto level_for = [&](double asked) {
    return asked > 0 ? std::max<std::int64_t>(0, static_cast<std::int64_t>(std::ceil(std::log2(kSlack * asked * step_size_.step)))) : 0;
  };
  const auto strictest = static_cast<std::size_t>(std::max_element(rate.begin(), rate.end()) - rate.begin());
  std::int64_t level = level_for(rate[strictest]);
  std::string reason = strictest == contact  ? "contact of " + critical.name()
                       : body[strictest] < 0 ? std::string("speed of a wall")
                                             : fmt::format("{} of body {}", strictest == speed ? "speed" : "spin", body[strictest]);
  if (level > kFinest) {
    fail(
        RunInvalid("step {}: the {} requires a step of {:.3g} s, 2^{} times smaller than {:.3g} s and below the minimum; check for "
                   "unphysical velocities or stiffness",
                   step_, reason, 1 / rate[strictest], level, step_size_.step));
    return;
  }
  if (level < level_) {
    if (!with_contacts || level_for(kHysteresis * rate[strictest]) >= level_) return;
    level = level_ - 1;
    reason = "quiet";
  }
  if (level == level_) return;

  // The forces of this step act half before and half after the change.
  const double before = dt_;
  level_ = level;
  dt_ = std::ldexp(step_size_.step, -static_cast<int>(level_));
  level_changed_ = true;
  step_changes_.push_back({step_, time(), dt_, reason});
  if (step_ == 0) return;
  const double difference = 0.5 * (dt_ - before);
  add_wall_totals(difference, sums_);
  for (std::size_t i = 0; i < p_.owned; ++i) {
    if (!p_.fixed[i]) p_.dissipated[i] -= difference * (dot(p_.dissipative_force[i], p_.v[i]) + dot(p_.dissipative_torque[i], p_.w[i]));
  }
}

void Simulation::check_displacement() {
  // Two bodies must not pass each other between two looks at who is near: at this share of its radius a step, what a body could
  // miss is smaller than the skin of the lists. Pairs that are listed are watched by evaluate_pairs.
  constexpr double kRadiusPerStep = 0.1;
  if (!(step_size_.contact_time > 0)) return;  // nothing can meet
  const double dt2 = dt_ * dt_;
  for (std::size_t i = 0; i < p_.owned; ++i) {
    const double limit = kRadiusPerStep * p_.radius[i];
    if (!(squared_length(p_.v[i]) * dt2 > limit * limit)) continue;
    fail(RunInvalid(
        "step {}: body {} moves {:.3g} m in a step of {:.3g} s, more than a tenth of its radius of {:.3g} m; it could pass through "
        "others unseen: give a step of at most {:.3g} s",
        step_, p_.id[i], length(p_.v[i]) * dt_, dt_, p_.radius[i], limit / length(p_.v[i])));
    return;
  }
}

}  // namespace scree
