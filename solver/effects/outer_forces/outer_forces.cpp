#include "solver/effects/outer_forces/outer_forces.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <unordered_set>

#include "core/base/error.hpp"
#include "solver/bodies/motion.hpp"
#include "solver/effects/sleep/sleep.hpp"
#include "solver/state/run_state.hpp"

namespace scree {

namespace {

using WrenchById = OuterForces::WrenchById;

bool is_zero(const Wrench& w) { return w == Wrench{}; }
Wrench operator-(const Wrench& a, const Wrench& b) { return {a.force - b.force, a.torque - b.torque}; }

/// What all ranks give, by ascending id, on every rank. Collective.
std::vector<WrenchOnBody> of_all_ranks(const RunState& s, const std::vector<WrenchOnBody>& mine) {
  std::vector<WrenchOnBody> all;
  for (const auto& block : s.comm.exchange(std::vector<std::vector<WrenchOnBody>>(static_cast<std::size_t>(s.comm.size()), mine)))
    all.insert(all.end(), block.begin(), block.end());
  std::sort(all.begin(), all.end(), [](const WrenchOnBody& l, const WrenchOnBody& r) { return l.id < r.id; });
  return all;
}

/// Owned rows by id, of a few ids.
std::unordered_map<std::int64_t, std::size_t> rows_of(const ParticleSet& p, const std::unordered_set<std::int64_t>& ids) {
  std::unordered_map<std::int64_t, std::size_t> rows;
  for (std::size_t i = 0; i < p.owned; ++i)
    if (ids.contains(p.id[i])) rows[p.id[i]] = i;
  return rows;
}

/// Rows of what all ranks named. Throws UsageError on every rank. Collective.
std::unordered_map<std::int64_t, std::size_t> checked_rows(const RunState& s, const std::vector<WrenchOnBody>& all) {
  std::unordered_set<std::int64_t> ids;
  for (const WrenchOnBody& w : all) ids.insert(w.id);
  std::unordered_map<std::int64_t, std::size_t> mine = rows_of(s.particles, ids);
  std::vector<std::uint8_t> state(all.size(), 0), of_any(all.size(), 0);  // 0: not here, 1: here, 2: here and fixed
  for (std::size_t k = 0; k < all.size(); ++k) {
    const auto found = mine.find(all[k].id);
    if (found != mine.end()) state[k] = s.particles.fixed[found->second] ? 2 : 1;
  }
  MPI_Allreduce(state.data(), of_any.data(), static_cast<int>(state.size()), MPI_UINT8_T, MPI_MAX, s.comm.get());
  mpi::on_root(s.comm, [&] {
    for (std::size_t k = 0; k < all.size(); ++k) {
      if (k > 0 && all[k].id == all[k - 1].id)
        throw UsageError("outer force: body {} is named twice in one call; add up its forces, and name it once", all[k].id);
      if (!is_finite(all[k].wrench.force) || !is_finite(all[k].wrench.torque))
        throw UsageError("outer force: body {} gets a force or torque that is not a finite number; check what it is computed from",
                         all[k].id);
      if (of_any[k] == 0)
        throw UsageError("outer force: no body of the run has the id {}; it is a wall, has left, or was never there: take ids from bodies",
                         all[k].id);
      if (of_any[k] == 2) throw UsageError("outer force: body {} is fixed, and no force moves it; leave it out", all[k].id);
    }
  });
  return mine;
}

/// What a rank holds of bodies that it does not own any more goes to their owners; what nobody owns has left the run. Collective.
void travel(const RunState& s, WrenchById& of) {
  std::unordered_set<std::int64_t> owned;
  if (!of.empty()) owned.insert(s.particles.id.begin(), s.particles.id.begin() + static_cast<std::ptrdiff_t>(s.particles.owned));
  std::vector<WrenchOnBody> lost;
  for (const auto& [id, wrench] : of)
    if (!owned.contains(id)) lost.push_back({id, wrench});
  for (const WrenchOnBody& w : lost) of.erase(w.id);
  const std::vector<WrenchOnBody> all = of_all_ranks(s, lost);
  if (all.empty()) return;
  std::unordered_map<std::int64_t, Wrench> found;
  for (const WrenchOnBody& w : all) found[w.id] = w.wrench;
  for (std::size_t i = 0; i < s.particles.owned; ++i) {
    const auto here = found.find(s.particles.id[i]);
    if (here != found.end()) of.insert(*here);
  }
}

constexpr std::int64_t kNumbers = 6;  // of a wrench

StateArray ids_of(const std::vector<WrenchOnBody>& rows) {
  StateArray array;
  for (const WrenchOnBody& r : rows) array.integers.push_back(r.id);
  return array;
}
StateArray numbers_of(const std::vector<WrenchOnBody>& rows) {
  StateArray array;
  for (const WrenchOnBody& r : rows) {
    for (const Vec3* v : {&r.wrench.force, &r.wrench.torque}) array.reals.insert(array.reals.end(), {v->x, v->y, v->z});
  }
  return array;
}
/// Those of the bodies of this rank. Throws InputError.
WrenchById wrenches_of(const StateArray& ids, const StateArray& numbers) {
  if (numbers.reals.size() != static_cast<std::size_t>(kNumbers) * ids.integers.size())
    throw InputError("outer forces: {} numbers for {} bodies; the file is damaged", numbers.reals.size(), ids.integers.size());
  WrenchById all;
  for (std::size_t k = 0; k < ids.integers.size(); ++k) {
    const double* n = numbers.reals.data() + static_cast<std::size_t>(kNumbers) * k;
    all[ids.integers[k]] = {{n[0], n[1], n[2]}, {n[3], n[4], n[5]}};
  }
  return all;
}

}  // namespace

void OuterForces::find_rows(const RunState& s) {
  held_rows_.clear();
  for (std::size_t i = 0; i < s.particles.owned && !held_.empty(); ++i) {
    const auto found = held_.find(s.particles.id[i]);
    if (found != held_.end()) held_rows_.emplace_back(i, found->second);
  }
}

/// Calls a function for the owned rows.
void OuterForces::call(const RunState& s, Function& f) {
  const ParticleSet& p = s.particles;
  f.force.assign(p.owned, Vec3{});
  f.torque.assign(p.owned, Vec3{});
  f.call(f.force, f.torque);
  f.latest.clear();
  for (std::size_t i = 0; i < p.owned; ++i) {
    if (!is_finite(f.force[i]) || !is_finite(f.torque[i]))
      throw RunInvalid("step {}: a function of outer forces gives body {} a force or torque that is not a finite number", s.clock.step,
                       p.id[i]);
    const Wrench w{f.force[i], f.torque[i]};
    if (f.every > 1 && !is_zero(w)) f.latest[p.id[i]] = w;
  }
}

/// The last forces of a function that is not called in this step, on the present rows.
void OuterForces::hold_latest(const RunState& s, Function& f) {
  const ParticleSet& p = s.particles;
  f.force.assign(p.owned, Vec3{});
  f.torque.assign(p.owned, Vec3{});
  for (std::size_t i = 0; i < p.owned; ++i) {
    const auto found = f.latest.find(p.id[i]);
    if (found == f.latest.end()) continue;
    f.force[i] = found->second.force;
    f.torque[i] = found->second.torque;
  }
}

/// All functions together.
void OuterForces::sum_functions(const RunState& s) {
  const ParticleSet& p = s.particles;
  force_.assign(functions_.empty() ? 0 : p.owned, Vec3{});
  torque_.assign(force_.size(), Vec3{});
  for (const Function& f : functions_) {
    for (std::size_t i = 0; i < p.owned; ++i) {
      if (p.fixed[i]) continue;
      force_[i] += f.force[i];
      torque_[i] += f.torque[i];
    }
  }
}

/// What is held and what functions gave, of the owned rows where there is any, ascending.
std::vector<std::pair<std::size_t, Wrench>> OuterForces::present(const RunState& s) const {
  if (force_.empty()) return held_rows_;
  std::vector<std::pair<std::size_t, Wrench>> rows;
  auto next = held_rows_.begin();
  for (std::size_t i = 0; i < s.particles.owned; ++i) {
    Wrench w{force_[i], torque_[i]};
    if (next != held_rows_.end() && next->first == i) {
      w.force += next->second.force;
      w.torque += next->second.torque;
      ++next;
    }
    if (!is_zero(w)) rows.emplace_back(i, w);
  }
  return rows;
}

/// Wakes the bodies on which other wrenches act than those with which they fell asleep.
void OuterForces::wake_changed(RunState& s, const std::vector<std::pair<std::size_t, Wrench>>& now) {
  if (s.sleep == nullptr) return;
  const ParticleSet& p = s.particles;
  const double tolerance = s.scene.source().settings.sleep_tolerance;
  std::vector<std::size_t> disturbed;
  auto next = now.begin();
  for (std::size_t i = 0; i < p.owned; ++i) {
    while (next != now.end() && next->first < i) ++next;
    const bool acts = next != now.end() && next->first == i;
    if (p.rest[i] != kAsleep) {
      if (!kept_.empty()) kept_.erase(p.id[i]);
      continue;
    }
    const auto kept = kept_.find(p.id[i]);
    if (!acts && kept == kept_.end()) continue;
    const Wrench change = (acts ? next->second : Wrench{}) - (kept == kept_.end() ? Wrench{} : kept->second);
    const double most = tolerance * weight_of(s, i);
    if (length(change.force) <= most && (p.lock_rotation[i] || length(change.torque) <= most * p.equivalent_radius[i])) continue;
    disturbed.push_back(i);
    if (kept != kept_.end()) kept_.erase(kept);
  }
  s.sleep->wake_rows(s, disturbed);
}

/// Between two steps: forces on bodies become those that they would have with what acts now.
void OuterForces::change_now(RunState& s) {
  ParticleSet& p = s.particles;
  std::unordered_map<std::size_t, Wrench> before;
  for (const Acting& a : acting_) before[a.row] = a.wrench;
  for (std::size_t i = 0; i < p.owned && !kept_.empty(); ++i) {
    const auto kept = p.rest[i] == kAsleep ? kept_.find(p.id[i]) : kept_.end();
    if (kept != kept_.end()) before[i] = kept->second;
  }
  const std::vector<std::pair<std::size_t, Wrench>> now = present(s);
  wake_changed(s, now);
  std::vector<Acting> acting;
  auto next = now.begin();
  const auto change = [&](std::size_t row, const Wrench& to) {
    if (p.rest[row] == kAsleep) return;
    const auto was = before.find(row);
    const Wrench by = was == before.end() ? to : to - was->second;
    p.force[row] += by.force;
    p.torque[row] += by.torque;
    if (was != before.end()) before.erase(was);
  };
  for (; next != now.end(); ++next) {
    change(next->first, next->second);
    if (p.rest[next->first] == kAsleep) continue;
    const std::size_t i = next->first;
    acting.push_back({i, next->second, p.v[i], p.w[i], p.q[i]});
  }
  std::vector<std::size_t> ended;
  for (const auto& [row, wrench] : before) ended.push_back(row);
  for (const std::size_t row : ended) change(row, {});
  acting_ = std::move(acting);
}

void OuterForces::hold(RunState& s, const std::vector<WrenchOnBody>& mine) {
  const std::vector<WrenchOnBody> all = of_all_ranks(s, mine);
  if (all.empty()) return;
  const auto rows = checked_rows(s, all);
  is_used_ = true;
  for (const WrenchOnBody& w : all) {
    if (!rows.contains(w.id)) continue;
    if (is_zero(w.wrench))
      held_.erase(w.id);
    else
      held_[w.id] = w.wrench;
  }
  find_rows(s);
  change_now(s);
}

void OuterForces::release(RunState& s, const std::optional<std::vector<std::int64_t>>& mine) {
  if (!mine) {
    held_.clear();
  } else {
    std::vector<WrenchOnBody> named;
    for (const std::int64_t id : *mine) named.push_back({id, {}});
    const std::vector<WrenchOnBody> all = of_all_ranks(s, named);
    checked_rows(s, all);
    for (const WrenchOnBody& w : all) held_.erase(w.id);
  }
  find_rows(s);
  change_now(s);
}

int OuterForces::add(RunState& s, ForceFunction function, std::int64_t every) {
  if (every < 1) throw UsageError("outer force: every = {}: expected a number of steps >= 1", every);
  Function f{++last_number_, std::move(function), every, {}, {}, {}};
  mpi::on_all(s.comm, [&] { call(s, f); });
  functions_.push_back(std::move(f));
  is_used_ = true;
  sum_functions(s);
  change_now(s);
  return last_number_;
}

void OuterForces::remove(RunState& s, int number) {
  const auto at = std::find_if(functions_.begin(), functions_.end(), [number](const Function& f) { return f.number == number; });
  if (at == functions_.end()) throw UsageError("outer force: no function has the number {}; it was removed before, or never added", number);
  functions_.erase(at);
  sum_functions(s);
  change_now(s);
}

/// dt/2, or dt where a scheme has one kick a step.
void OuterForces::add_work(const RunState& s, const Acting& a, double dt, const Vec3& w_after) {
  const ParticleSet& p = s.particles;
  work_.add(0.5 * dt * (dot(a.wrench.force, a.v + p.v[a.row]) + dot(a.wrench.torque, a.w + w_after)));
}

void OuterForces::drift(RunState& s) {
  const ParticleSet& p = s.particles;
  const double dt = s.integrator == Integrator::euler ? s.clock.dt : 0.5 * s.clock.dt;
  for (const Acting& a : acting_) {
    if (p.rest[a.row] == kAsleep) continue;
    const bool turns = !(a.wrench.torque == Vec3{});
    add_work(s, a, dt, turns ? angular_velocity(a.q, p.inverse_inertia[a.row], p.L[a.row]) : Vec3{});
  }
}

void OuterForces::after_migration(RunState& s, bool) {
  if (!is_used_) return;
  travel(s, held_);
  if (s.sleep != nullptr) travel(s, kept_);
  for (Function& f : functions_)
    if (f.every > 1) travel(s, f.latest);
}

void OuterForces::on_rebuild(const StepParts& parts) {
  RunState& s = parts.state;
  find_rows(s);
  if (restored_.empty()) return;
  const ParticleSet& p = s.particles;
  acting_.clear();
  for (std::size_t i = 0; i < p.owned; ++i) {
    const auto found = restored_.find(p.id[i]);
    if (found != restored_.end()) acting_.push_back({i, found->second, p.v[i], p.w[i], p.q[i]});
  }
  restored_.clear();
}

void OuterForces::before_forces(RunState& s) {
  for (Function& f : functions_) s.clock.step % f.every == 0 ? call(s, f) : hold_latest(s, f);
  sum_functions(s);
  const ParticleSet& p = s.particles;
  const std::vector<std::pair<std::size_t, Wrench>> now = present(s);
  wake_changed(s, now);
  acting_.clear();
  for (const auto& [i, wrench] : now)
    if (p.rest[i] != kAsleep) acting_.push_back({i, wrench, p.v[i], p.w[i], p.q[i]});
}

void OuterForces::add_forces(RunState& s) {
  ParticleSet& p = s.particles;
  for (const Acting& a : acting_) {
    p.force[a.row] += a.wrench.force;
    p.torque[a.row] += a.wrench.torque;
  }
}

void OuterForces::after_kick(RunState& s) {
  const ParticleSet& p = s.particles;
  for (Acting& a : acting_) {
    if (s.integrator != Integrator::euler) add_work(s, a, 0.5 * s.clock.dt, p.w[a.row]);
    a.v = p.v[a.row];
    a.w = p.w[a.row];
    a.q = p.q[a.row];
  }
}

void OuterForces::falls_asleep(RunState& s, std::size_t row) {
  const auto at = std::lower_bound(acting_.begin(), acting_.end(), row, [](const Acting& a, std::size_t r) { return a.row < r; });
  if (at == acting_.end() || at->row != row) {
    kept_.erase(s.particles.id[row]);
    return;
  }
  kept_[s.particles.id[row]] = at->wrench;
  acting_.erase(at);
}

void OuterForces::add_force_at_rest(const RunState& s, std::size_t row, Vec3& force, Vec3& torque) const {
  const auto found = kept_.find(s.particles.id[row]);
  if (found == kept_.end()) return;
  force += found->second.force;
  torque += found->second.torque;
}

EffectRecord OuterForces::record(const RunState& s) const {
  if (!is_used_) return {};
  std::vector<WrenchOnBody> acting;
  for (const Acting& a : acting_) acting.push_back({s.particles.id[a.row], a.wrench});
  for (const auto& [id, wrench] : restored_) acting.push_back({id, wrench});
  const auto listed = [](const WrenchById& of) {
    std::vector<WrenchOnBody> rows;
    for (const auto& [id, wrench] : of) rows.push_back({id, wrench});
    return rows;
  };
  EffectRecord record;
  for (const auto& rows : {listed(held_), acting, listed(kept_)}) {
    const std::vector<WrenchOnBody> all = of_all_ranks(s, rows);
    record.push_back(ids_of(all));
    record.push_back(numbers_of(all));
  }
  record.push_back(array_of(over_ranks(s.comm.get(), work_)));
  return record;
}

void OuterForces::restore(RunState& s, const EffectRecord& record) {
  held_ = wrenches_of(record[0], record[1]);
  restored_ = wrenches_of(record[2], record[3]);
  kept_ = wrenches_of(record[4], record[5]);
  const ExactSum work = sum_of(record[6]);
  if (s.comm.rank() == 0) work_ = work;
  is_used_ = true;
}

void OuterForces::add_energies(const RunState& s, Energies& energies) const {
  energies.outer_work = over_ranks(s.comm.get(), work_).value();
}

void OuterForces::add_log_columns(const RunState&, const Energies& energies, std::vector<Column>& columns) const {
  columns.push_back({"outer_work", "J", exact(energies.outer_work)});
}

std::vector<PlanLine> OuterForces::plan(const RunState& s) const {
  const std::int64_t held = s.comm.sum(static_cast<std::int64_t>(held_.size()));
  return {{"outer forces", fmt::format("held on {} bodies, and {} functions", held, functions_.size())}};
}

EffectKind outer_forces_effect() {
  EffectFormat format{"outer_forces", "the forces that act from outside, or their work, differ", {}};
  format.is_optional = true;
  for (const char* name : {"held", "acting", "kept"}) {
    static const std::unordered_map<std::string, const char*> ids{{"held", "held_id"}, {"acting", "acting_id"}, {"kept", "kept_id"}};
    format.arrays.push_back({ids.at(name), "", 1, false});
    format.arrays.push_back({name, "N; N m", kNumbers});
  }
  format.arrays.push_back(sum_format("work"));
  EffectKind kind{format, {}, [](const RunState&) -> std::unique_ptr<Effect> { return nullptr; }};
  kind.make_on_demand = [](const RunState&) -> std::unique_ptr<Effect> { return std::make_unique<OuterForces>(); };
  return kind;
}

}  // namespace scree
