#include "solver/step/domain.hpp"

#include <algorithm>
#include <utility>

#include "core/storage/domain_side.hpp"
#include "solver/bodies/motion.hpp"

namespace scree {

namespace {

bool is_review_step(const RunState& s) { return s.clock.substep == 0 && s.clock.step % kReviewSteps == 0; }
bool is_exchange_step(const RunState& s) { return s.clock.step % kExchangeSteps == 0 && !s.scene.outlets().empty(); }

/// Not where a body leaves the run: that is the index of an outlet, kLeftDomain or kTakenOut.
constexpr std::int32_t kStays = -3;

/// What is due in this step: the same question for review() and remove(), between which no body moves.
class Exits {
 public:
  Exits(const RunState& s, const std::unordered_set<std::int64_t>& asked)
      : s_(s),
        asked_(asked),
        of_domain_(is_review_step(s) && s.scene.source().settings.domain.outside == Outside::remove),
        of_outlets_(is_exchange_step(s)) {}
  bool are_open() const { return (of_domain_ && s_.scene.source().settings.domain.bounded) || of_outlets_; }
  std::int32_t of(std::size_t i) const {
    const ParticleSet& p = s_.particles;
    if (!asked_.empty() && asked_.contains(p.id[i])) return kTakenOut;
    if (p.fixed[i]) return kStays;
    const std::vector<Region>& outlets = s_.scene.outlets();
    for (std::size_t k = 0; of_outlets_ && k < outlets.size(); ++k) {
      if (outlets[k].contains(p.x[i])) return static_cast<std::int32_t>(k);
    }
    return of_domain_ && is_outside(s_.scene, p.x[i]) ? kLeftDomain : kStays;
  }
  bool any() const {
    for (std::size_t i = 0; i < s_.particles.owned; ++i) {
      if (of(i) != kStays) return true;
    }
    return false;
  }

 private:
  const RunState& s_;
  const std::unordered_set<std::int64_t>& asked_;
  bool of_domain_, of_outlets_;
};

/// Throws for the first body outside.
void check_domain(const RunState& s) {
  const Domain& domain = s.scene.source().settings.domain;
  const ParticleSet& p = s.particles;
  for (std::size_t i = 0; i < p.owned; ++i) {
    if (p.fixed[i] || !is_outside(s.scene, p.x[i])) continue;
    throw RunInvalid("step {}: body {} left the domain and is {}; widen domain, or set outside = \"remove\" or \"keep\"", s.clock.step,
                     p.id[i], beyond_side(domain, p.x[i], false));
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
  if (!asked_.empty()) removal_due_ = true;
  if (!is_review_step(s)) return removal_due_;
  if (domain.bounded && domain.outside == Outside::stop) failure.watch(s.clock.step, [&] { check_domain(s); });
  const Exits exits(s, asked_);
  if (removal_due_ || !exits.are_open()) return removal_due_;
  removal_due_ = s.comm.max(exits.any() ? 1.0 : 0.0) > 0;
  return removal_due_;
}

void DomainGuard::ask_removal(const RunState& s, const std::vector<std::int64_t>& mine) {
  std::vector<std::int64_t> all = s.comm.of_all(mine);
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  const std::unordered_set<std::int64_t> wanted(all.begin(), all.end());
  std::vector<std::uint8_t> here(all.size(), 0), found(all.size(), 0);
  for (std::size_t i = 0; i < s.particles.owned; ++i) {
    if (!wanted.contains(s.particles.id[i])) continue;
    here[static_cast<std::size_t>(std::lower_bound(all.begin(), all.end(), s.particles.id[i]) - all.begin())] = 1;
  }
  MPI_Allreduce(here.data(), found.data(), static_cast<int>(here.size()), MPI_UINT8_T, MPI_MAX, s.comm.get());
  mpi::on_root(s.comm, [&] {
    const auto missing = std::find(found.begin(), found.end(), 0);
    if (missing != found.end())
      throw UsageError("remove: no body of the run has the id {}; it is a wall, has left, or was never there: take ids from bodies",
                       all[static_cast<std::size_t>(missing - found.begin())]);
  });
  asked_.insert(all.begin(), all.end());
}

std::vector<std::uint8_t> DomainGuard::leaving(const RunState& s) const {
  const Exits exits(s, asked_);
  std::vector<std::uint8_t> leaves(s.particles.owned);
  for (std::size_t i = 0; i < leaves.size(); ++i) leaves[i] = exits.of(i) != kStays ? 1 : 0;
  return leaves;
}

bool DomainGuard::remove(RunState& s) {
  if (!std::exchange(removal_due_, false)) return false;
  ParticleSet& p = s.particles;
  const Exits exits(s, asked_);
  std::vector<Returning> returning;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < p.owned; ++i) {
    const std::int32_t exit = exits.of(i);
    if (exit == kStays) {
      if (kept != i) p.copy_row(i, kept);
      ++kept;
      continue;
    }
    // Removal falls between the two kicks of a step: the second is that of free flight. A body asleep had no first.
    if (p.rest[i] != kAsleep) finish_in_free_flight(s, p, i);
    removed_.push_back({p.id[i], s.clock.step, s.clock.time(), p.mass[i], p.x[i], p.v[i], p.entered[i], exit});
    DepartureTotals& departed = s.totals.departed;
    departed.count.add(1);
    departed.mass.add(p.mass[i]);
    departed.energy.add(translational_energy(p, i) + rotational_energy(p, i) + potential_energy(s, p, i));
    departed.dissipated.add(p.dissipated[i]);
    for (const std::unique_ptr<Effect>& effect : s.effects) effect->body_leaves(s, i);
    if (exit < 0) continue;
    OutletTotals& outlet = s.totals.outlets[static_cast<std::size_t>(exit)];
    outlet.count.add(1);
    outlet.mass.add(p.mass[i]);
    const std::int32_t to = s.scene.source().outlets[static_cast<std::size_t>(exit)].to;
    if (to >= 0) returning.push_back({to, {p.id[i], p.shape[i], p.material[i], p.scale[i], p.lock_rotation[i]}});
  }
  p.resize(kept);
  p.owned = kept;
  asked_.clear();
  queue_for_return(s, returning);
  return true;
}

/// Bodies of all ranks join the queues of their inlets in the order of their ids. Collective.
void DomainGuard::queue_for_return(RunState& s, const std::vector<Returning>& mine) const {
  const std::vector<Outlet>& outlets = s.scene.source().outlets;
  if (std::none_of(outlets.begin(), outlets.end(), [](const Outlet& o) { return o.to >= 0; })) return;
  std::vector<Returning> all = s.comm.of_all(mine);
  std::sort(all.begin(), all.end(), [](const Returning& l, const Returning& r) { return l.body.id < r.body.id; });
  for (const Returning& r : all) s.totals.inlets[static_cast<std::size_t>(r.inlet)].queue.push_back(r.body);
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
