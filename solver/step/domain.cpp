// What becomes of bodies that leave the domain, and of states that are not finite.
#include <algorithm>

#include "solver/bodies/motion.hpp"
#include "solver/step/simulation.hpp"

namespace scree {

bool Simulation::is_outside(const Vec3& x) const {
  const Domain& domain = scene_.source().settings.domain;
  if (!domain.bounded) return false;
  for (int k = 0; k < 3; ++k) {
    if (!scene_.periodicity().is_periodic(k) && (x[k] < domain.lower[k] || x[k] > domain.upper[k])) return true;
  }
  return false;
}

bool Simulation::any_left_domain() const {
  const Domain& domain = scene_.source().settings.domain;
  if (!domain.bounded || domain.outside == Outside::keep) return false;
  for (std::size_t i = 0; i < p_.owned; ++i) {
    if (!p_.fixed[i] && is_outside(p_.x[i])) return true;
  }
  return false;
}

void Simulation::check_finite() const {
  for (std::size_t i = 0; i < p_.owned; ++i) {
    if (!is_finite(p_.x[i]) || !is_finite(p_.v[i]) || !is_finite(p_.L[i])) {
      throw RunInvalid("step {}: the state of body {} is not a finite number; the step is too large or the contact too stiff", step_,
                       p_.id[i]);
    }
  }
}

void Simulation::check_domain() const {
  const Domain& domain = scene_.source().settings.domain;
  for (std::size_t i = 0; i < p_.owned; ++i) {
    if (!p_.fixed[i] && is_outside(p_.x[i])) {
      const Vec3 over = component_max(domain.lower - p_.x[i], p_.x[i] - domain.upper);
      throw RunInvalid("step {}: body {} left the domain and is {:g} m outside; widen domain, or set outside = \"remove\" or \"keep\"",
                       step_, p_.id[i], std::max({over.x, over.y, over.z}));
    }
  }
}

void Simulation::remove_outside() {
  const Domain& domain = scene_.source().settings.domain;
  if (!domain.bounded || domain.outside != Outside::remove) return;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < p_.owned; ++i) {
    if (p_.fixed[i] || !is_outside(p_.x[i])) {
      if (kept != i) p_.copy_row(i, kept);
      ++kept;
      continue;
    }
    // Removal falls between the two kicks of a step: the second is that of free flight.
    const Vec3 gravity = scene_.source().settings.gravity;
    if (integrator_ != Integrator::euler && fluid_) {
      p_.force[i] = fluid_->weighed_mass(p_, i) * gravity;
      p_.torque[i] = {};
      fluid_->kick_body(p_, i, 0.5 * dt_);
    } else if (integrator_ != Integrator::euler) {
      p_.v[i] += (0.5 * dt_) * gravity;
    }
    removed_.push_back({p_.id[i], step_, time(), p_.mass[i], p_.x[i], p_.v[i]});
    sums_[RunTotals::kRemovedCount].add(1);
    sums_[RunTotals::kRemovedMass].add(p_.mass[i]);
    sums_[RunTotals::kRemovedEnergy].add(translational_energy(p_, i) + rotational_energy(p_, i) + potential_energy(i));
    sums_[RunTotals::kRemovedDissipated].add(p_.dissipated[i]);
  }
  p_.resize(kept);
  p_.owned = kept;
}

double Simulation::potential_energy(std::size_t i) const {
  if (p_.fixed[i]) return 0;
  const double mass = fluid_ ? fluid_->weighed_mass(p_, i) : p_.mass[i];
  return -mass * dot(scene_.source().settings.gravity, scene_.periodicity().way_of(p_.x[i], p_.image[i]));
}

RemovedTotals Simulation::removed() const {
  std::vector<ExactSum> sums = {sums_[RunTotals::kRemovedCount], sums_[RunTotals::kRemovedMass]};
  add_over_ranks(comm_.get(), sums);
  return {sums[0].value(), sums[1].value()};
}

std::vector<RemovedBody> Simulation::take_removed() {
  std::vector<std::vector<RemovedBody>> outgoing(static_cast<std::size_t>(comm_.size()));
  outgoing[0] = std::move(removed_);
  removed_.clear();
  std::vector<RemovedBody> all;
  for (const auto& block : comm_.exchange(outgoing)) all.insert(all.end(), block.begin(), block.end());
  std::sort(all.begin(), all.end(),
            [](const RemovedBody& l, const RemovedBody& r) { return l.step != r.step ? l.step < r.step : l.id < r.id; });
  return all;
}

}  // namespace scree
