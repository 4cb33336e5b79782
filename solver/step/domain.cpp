#include "solver/step/domain.hpp"

#include <algorithm>
#include <utility>

#include "solver/bodies/motion.hpp"

namespace scree {

namespace {

bool any_left_domain(const RunState& s) {
  const ParticleSet& p = s.particles;
  for (std::size_t i = 0; i < p.owned; ++i) {
    if (!p.fixed[i] && is_outside(s.scene, p.x[i])) return true;
  }
  return false;
}

/// Throws for the first body outside.
void check_domain(const RunState& s) {
  const Domain& domain = s.scene.source().settings.domain;
  const ParticleSet& p = s.particles;
  for (std::size_t i = 0; i < p.owned; ++i) {
    if (p.fixed[i] || !is_outside(s.scene, p.x[i])) continue;
    const Vec3 over = component_max(domain.lower - p.x[i], p.x[i] - domain.upper);
    throw RunInvalid("step {}: body {} left the domain and is {:g} m outside; widen domain, or set outside = \"remove\" or \"keep\"",
                     s.clock.step, p.id[i], std::max({over.x, over.y, over.z}));
  }
}

}  // namespace

bool is_outside(const SolverScene& scene, const Vec3& x) {
  const Domain& domain = scene.source().settings.domain;
  if (!domain.bounded) return false;
  for (int k = 0; k < 3; ++k) {
    if (!scene.periodicity().is_periodic(k) && (x[k] < domain.lower[k] || x[k] > domain.upper[k])) return true;
  }
  return false;
}

void check_finite(const RunState& s) {
  const ParticleSet& p = s.particles;
  for (std::size_t i = 0; i < p.owned; ++i) {
    if (is_finite(p.x[i]) && is_finite(p.v[i]) && is_finite(p.L[i])) continue;
    throw RunInvalid("step {}: the state of body {} is not a finite number; the step is too large or the contact too stiff", s.clock.step,
                     p.id[i]);
  }
}

bool DomainGuard::review(const RunState& s, FirstFailure& failure) {
  const Domain& domain = s.scene.source().settings.domain;
  if (s.clock.substep != 0 || s.clock.step % kReviewSteps != 0 || !domain.bounded) return false;
  if (domain.outside == Outside::stop) failure.watch(s.clock.step, [&] { check_domain(s); });
  if (domain.outside != Outside::remove) return false;
  removal_due_ = s.comm.max(any_left_domain(s) ? 1.0 : 0.0) > 0;
  return removal_due_;
}

bool DomainGuard::remove(RunState& s) {
  if (!std::exchange(removal_due_, false)) return false;
  ParticleSet& p = s.particles;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < p.owned; ++i) {
    if (p.fixed[i] || !is_outside(s.scene, p.x[i])) {
      if (kept != i) p.copy_row(i, kept);
      ++kept;
      continue;
    }
    // Removal falls between the two kicks of a step: the second is that of free flight.
    finish_in_free_flight(s, p, i);
    removed_.push_back({p.id[i], s.clock.step, s.clock.time(), p.mass[i], p.x[i], p.v[i]});
    DepartureTotals& departed = s.totals.departed;
    departed.count.add(1);
    departed.mass.add(p.mass[i]);
    departed.energy.add(translational_energy(p, i) + rotational_energy(p, i) + potential_energy(s, p, i));
    departed.dissipated.add(p.dissipated[i]);
  }
  p.resize(kept);
  p.owned = kept;
  return true;
}

std::vector<RemovedBody> DomainGuard::take_removed(const mpi::Communicator& comm) {
  std::vector<std::vector<RemovedBody>> outgoing(static_cast<std::size_t>(comm.size()));
  outgoing[0] = std::exchange(removed_, {});
  std::vector<RemovedBody> all;
  for (const auto& block : comm.exchange(outgoing)) all.insert(all.end(), block.begin(), block.end());
  std::sort(all.begin(), all.end(),
            [](const RemovedBody& l, const RemovedBody& r) { return l.step != r.step ? l.step < r.step : l.id < r.id; });
  return all;
}

}  // namespace scree
