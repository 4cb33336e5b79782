// Whether the step is small enough for the contacts that there are, and the guards against what it is not.
#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "solver/motion.hpp"
#include "solver/simulation.hpp"

namespace scree {

namespace {

struct NamedBound {
  std::int64_t id;
  BodyBound bound;
};

}  // namespace

CriticalStep Simulation::critical_step() {
  std::vector<PairStiffness> found;
  const PairLooker look = [&](const PairLook& pair) { found.push_back(linearise(pair)); };
  for (const auto* which : {&pairs_.inner(), &pairs_.outer(), &pairs_.twice()}) {
    look_at_pairs(scene_, p_, walls_, *which, step_, scratch_, pairs_, look);
  }
  std::sort(found.begin(), found.end(), [](const PairStiffness& l, const PairStiffness& r) { return l.key < r.key; });
  std::vector<BodyBound> bounds = body_bounds(found, p_.size());

  // The owner of a ghost knows all of its pairs.
  if (comm_.size() > 1) {
    std::vector<NamedBound> shared;
    std::vector<std::uint8_t> is_shared(p_.size(), 0);
    for (const PairStiffness& pair : found) {
      if (pair.b < 0) continue;
      const auto a = static_cast<std::size_t>(pair.a), b = static_cast<std::size_t>(pair.b);
      if ((a < p_.owned) == (b < p_.owned)) continue;
      const std::size_t own = a < p_.owned ? a : b;
      if (is_shared[own]++ == 0) shared.push_back({p_.id[own], bounds[own]});
    }
    const auto ranks = static_cast<std::size_t>(comm_.size());
    std::unordered_map<std::int64_t, BodyBound> of_id;
    for (const auto& block : comm_.exchange(std::vector<std::vector<NamedBound>>(ranks, shared))) {
      for (const NamedBound& n : block) of_id[n.id] = n.bound;
    }
    for (std::size_t i = p_.owned; i < p_.size(); ++i) {
      if (const auto it = of_id.find(p_.id[i]); it != of_id.end()) bounds[i] = it->second;
    }
  }

  CriticalStep critical = critical_step_of(found, bounds, scene_.source().settings.law != "hunt-crossley");
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
    sum[0].add(squared_length(p_.force[i]) * p_.inverse_mass[i] + torque.x * torque.x * w.x + torque.y * torque.y * w.y + torque.z * torque.z * w.z);
  }
  add_over_ranks(comm_.get(), sum);
  return sum[0].value() * step_size_.step * step_size_.step / 8;
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

void Simulation::check_displacement() {
  // Two bodies must not pass each other between two looks at who is near: at this share of its radius a step, what a body could
  // miss is smaller than the skin of the lists. Pairs that are listed are watched by evaluate_pairs.
  constexpr double kRadiusPerStep = 0.1;
  if (!(step_size_.contact_time > 0)) return;   // nothing can meet
  const double dt2 = step_size_.step * step_size_.step;
  for (std::size_t i = 0; i < p_.owned; ++i) {
    const double limit = kRadiusPerStep * p_.radius[i];
    if (!(squared_length(p_.v[i]) * dt2 > limit * limit)) continue;
    fail(RunInvalid("step {}: body {} moves {:.3g} m in a step of {:.3g} s, more than a tenth of its radius of {:.3g} m; it could pass through "
                    "others unseen: give a step of at most {:.3g} s", step_, p_.id[i], length(p_.v[i]) * step_size_.step, step_size_.step,
                    p_.radius[i], limit / length(p_.v[i])));
    return;
  }
}

}  // namespace scree
