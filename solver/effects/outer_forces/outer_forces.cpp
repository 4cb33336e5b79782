#include "solver/effects/outer_forces/outer_forces.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "core/base/error.hpp"
#include "solver/bodies/motion.hpp"
#include "solver/effects/sleep/sleep.hpp"
#include "solver/state/run_state.hpp"

namespace scree {

namespace {

constexpr std::size_t kRowsWorthThreads = 4000;

}  // namespace

void OuterForces::Acting::clear() {
  row.clear();
  force.clear();
  v.clear();
  turning.clear();
}

void OuterForces::Acting::add(const ParticleSet& p, const OnRow& on) {
  row.push_back(on.row);
  force.push_back(on.wrench.force);
  v.push_back(p.v[on.row]);
  if (!(on.wrench.torque == Vec3{})) turning.push_back({on.row, on.wrench.torque, p.w[on.row], p.L[on.row], p.q[on.row]});
}

void OuterForces::Acting::begin_kick(const ParticleSet& p) {
  const std::size_t rows = row.size();
#pragma omp parallel for if (rows > kRowsWorthThreads)
  for (std::size_t k = 0; k < rows; ++k) v[k] = p.v[row[k]];
  for (Turning& t : turning) {
    t.w = p.w[t.row];
    t.L = p.L[t.row];
    t.q = p.q[t.row];
  }
}

std::vector<OuterForces::OnRow> OuterForces::Acting::list() const {
  std::vector<OnRow> rows;
  auto turn = turning.begin();
  for (std::size_t k = 0; k < row.size(); ++k) {
    const bool turns = turn != turning.end() && turn->row == row[k];
    rows.push_back({row[k], {force[k], turns ? turn->torque : Vec3{}}});
    if (turns) ++turn;
  }
  return rows;
}

const std::vector<std::int32_t>& OuterForces::by_id(const RunState& s) {
  if (by_id_.size() != s.particles.owned) by_id_ = rows_by_id(s.particles);
  return by_id_;
}

void OuterForces::find_rows(const RunState& s) {
  const ParticleSet& p = s.particles;
  held_rows_.clear();
  is_current_ = false;
  if (held_.empty()) return;
  std::vector<std::int32_t> place(p.owned, -1);
  std::int32_t next = 0;
  join_rows(p, held_, by_id(s), [&](const WrenchOnBody&, std::int32_t row) {
    if (row >= 0) place[static_cast<std::size_t>(row)] = next;
    ++next;
  });
  for (std::size_t i = 0; i < p.owned; ++i)
    if (place[i] >= 0) held_rows_.push_back({i, held_[static_cast<std::size_t>(place[i])].wrench});
}

/// Calls a function for the owned rows.
void OuterForces::call(const RunState& s, Function& f) {
  const ParticleSet& p = s.particles;
  f.force.assign(p.owned, Vec3{});
  f.torque.assign(p.owned, Vec3{});
  f.given.call(f.force, f.torque);
  for (std::size_t i = 0; i < p.owned; ++i) {
    const bool is_force = !is_finite(f.force[i]);
    if (!is_force && is_finite(f.torque[i])) continue;
    const Vec3& wrong = is_force ? f.force[i] : f.torque[i];
    throw RunInvalid(
        "step {}: the force function {} gives body {} a {} of ({:g} {:g} {:g}) {}, which is not finite; check what it is computed from",
        s.clock.step, f.given.name, p.id[i], is_force ? "force" : "torque", wrong.x, wrong.y, wrong.z, is_force ? "N" : "N m");
  }
  keep_latest(s, f);
}

/// Of a function that is not called in every step: its forces by ids.
void OuterForces::keep_latest(const RunState& s, Function& f) {
  f.latest.clear();
  for (std::size_t i = 0; f.given.every > 1 && i < s.particles.owned; ++i) {
    const Wrench w{f.force[i], f.torque[i]};
    if (!is_zero(w)) f.latest[s.particles.id[i]] = w;
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
  for (const Function& f : functions_) add_to_sum(s, f);
}

void OuterForces::add_to_sum(const RunState& s, const Function& f) {
  const ParticleSet& p = s.particles;
  for (std::size_t i = 0; i < p.owned; ++i) {
    if (p.fixed[i]) continue;
    force_[i] += f.force[i];
    torque_[i] += f.torque[i];
  }
}

/// What is held and what functions gave, of the owned rows where there is any, ascending.
std::vector<OuterForces::OnRow> OuterForces::present(const RunState& s) const {
  if (force_.empty()) return held_rows_;
  std::vector<OnRow> rows;
  auto next = held_rows_.begin();
  for (std::size_t i = 0; i < s.particles.owned; ++i) {
    Wrench w{force_[i], torque_[i]};
    if (next != held_rows_.end() && next->row == i) {
      w.force += next->wrench.force;
      w.torque += next->wrench.torque;
      ++next;
    }
    if (!is_zero(w)) rows.push_back({i, w});
  }
  return rows;
}

/// Wakes the bodies on which other wrenches act than those with which they fell asleep.
void OuterForces::wake_changed(RunState& s, const std::vector<OnRow>& now) {
  if (s.sleep == nullptr) return;
  const ParticleSet& p = s.particles;
  const double tolerance = s.scene.source().settings.sleep_tolerance;
  std::vector<std::size_t> disturbed;
  auto next = now.begin();
  for (std::size_t i = 0; i < p.owned; ++i) {
    while (next != now.end() && next->row < i) ++next;
    const bool acts = next != now.end() && next->row == i;
    if (p.rest[i] != kAsleep) {
      if (!kept_.empty()) kept_.erase(p.id[i]);
      continue;
    }
    const auto kept = kept_.find(p.id[i]);
    if (!acts && kept == kept_.end()) continue;
    const Wrench change = (acts ? next->wrench : Wrench{}) - (kept == kept_.end() ? Wrench{} : kept->second);
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
  std::vector<OnRow> before = acting_.list();
  const auto acted = static_cast<std::ptrdiff_t>(before.size());
  for (std::size_t i = 0; i < p.owned && !kept_.empty(); ++i) {
    const auto kept = p.rest[i] == kAsleep ? kept_.find(p.id[i]) : kept_.end();
    if (kept != kept_.end()) before.push_back({i, kept->second});
  }
  std::inplace_merge(before.begin(), before.begin() + acted, before.end(), [](const OnRow& l, const OnRow& r) { return l.row < r.row; });
  const std::vector<OnRow> now = present(s);
  wake_changed(s, now);
  acting_.clear();
  auto was = before.begin();
  const auto change = [&](std::size_t row, const Wrench& by) {
    if (p.rest[row] == kAsleep) return;
    p.force[row] += by.force;
    p.torque[row] += by.torque;
  };
  for (const OnRow& is : now) {
    for (; was != before.end() && was->row < is.row; ++was) change(was->row, Wrench{} - was->wrench);
    const bool acted_before = was != before.end() && was->row == is.row;
    change(is.row, acted_before ? is.wrench - was->wrench : is.wrench);
    if (acted_before) ++was;
    if (p.rest[is.row] != kAsleep) acting_.add(p, is);
  }
  for (; was != before.end(); ++was) change(was->row, Wrench{} - was->wrench);
  is_current_ = false;
}

void OuterForces::hold(RunState& s, const std::vector<WrenchOnBody>& mine) {
  const std::vector<WrenchOnBody> all = of_all_ranks(s, mine);
  if (all.empty()) return;
  const std::vector<std::int32_t> rows = checked_rows(s, all, by_id(s));
  is_used_ = true;
  WrenchTable held;
  held.reserve(held_.size() + all.size());
  auto old = held_.begin();
  for (std::size_t k = 0; k < all.size(); ++k) {
    if (rows[k] < 0) continue;
    for (; old != held_.end() && old->id < all[k].id; ++old) held.push_back(*old);
    if (old != held_.end() && old->id == all[k].id) ++old;
    if (!is_zero(all[k].wrench)) held.push_back(all[k]);
  }
  held.insert(held.end(), old, held_.end());
  held_ = std::move(held);
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
    checked_rows(s, all, by_id(s));
    WrenchTable held;
    std::set_difference(held_.begin(), held_.end(), all.begin(), all.end(), std::back_inserter(held), has_lower_id);
    held_ = std::move(held);
  }
  find_rows(s);
  change_now(s);
}

int OuterForces::add(RunState& s, const GivenFunction& given) {
  if (given.every < 1) throw UsageError("add_force: every = {}: expected a number of steps >= 1", given.every);
  const auto open = std::find_if(functions_.begin(), functions_.end(), [](const Function& f) { return f.is_open; });
  if (open != functions_.end()) return take_place(s, static_cast<std::size_t>(open - functions_.begin()), given);
  Function f;
  f.number = ++last_number_;
  f.given = given;
  mpi::on_all(s.comm, [&] {
    try {
      call(s, f);
    } catch (const RunInvalid& error) {  // nothing has changed yet
      throw UsageError("{}", error.what());
    }
  });
  is_used_ = true;
  force_.resize(s.particles.owned);
  torque_.resize(s.particles.owned);
  add_to_sum(s, f);
  functions_.push_back(std::move(f));
  change_now(s);
  return last_number_;
}

int OuterForces::take_place(RunState& s, std::size_t place, const GivenFunction& given) {
  Function& f = functions_[place];
  f.number = ++last_number_;
  f.given = given;
  f.is_open = false;
  keep_latest(s, f);
  return last_number_;
}

void OuterForces::remove(RunState& s, int number) {
  const auto at = std::find_if(functions_.begin(), functions_.end(), [number](const Function& f) { return f.number == number; });
  if (at == functions_.end())
    throw UsageError("remove_force: no function has the number {}; it was removed before, or never added", number);
  functions_.erase(at);
  sum_functions(s);
  change_now(s);
}

/// In a kick of length dt [s].   in   w_after   (turning): the angular velocity at its end
template <class WAfter>
void OuterForces::add_work(const RunState& s, double dt, const WAfter& w_after) {
  const ParticleSet& p = s.particles;
  const std::size_t rows = acting_.row.size();
#pragma omp parallel if (rows > kRowsWorthThreads)
  {
    ExactSum sum;
#pragma omp for nowait
    for (std::size_t k = 0; k < rows; ++k) sum.add(0.5 * dt * dot(acting_.force[k], acting_.v[k] + p.v[acting_.row[k]]));
#pragma omp for nowait
    for (std::size_t k = 0; k < acting_.turning.size(); ++k) {
      const Acting::Turning& t = acting_.turning[k];
      sum.add(0.5 * dt * dot(t.torque, t.w + w_after(t)));
    }
#pragma omp critical(outer_work)
    work_.add(sum);
  }
}

void OuterForces::drift(RunState& s) {
  if (acting_.row.empty()) return;
  const ParticleSet& p = s.particles;
  if (s.integrator == Integrator::euler) {  // turns first, and kicks at the new orientation
    for (Acting::Turning& t : acting_.turning) t.w = angular_velocity(p.q[t.row], p.inverse_inertia[t.row], t.L);
    add_work(s, s.clock.dt, [&p](const Acting::Turning& t) { return angular_velocity(p.q[t.row], p.inverse_inertia[t.row], p.L[t.row]); });
    return;
  }
  add_work(s, 0.5 * s.clock.dt, [&p](const Acting::Turning& t) { return angular_velocity(t.q, p.inverse_inertia[t.row], p.L[t.row]); });
}

void OuterForces::after_migration(RunState& s, bool) {
  by_id_.clear();
  if (!is_used_) return;
  travel(s, held_, by_id(s));
  if (s.sleep != nullptr) travel(s, kept_, by_id(s));
  for (Function& f : functions_)
    if (f.given.every > 1) travel(s, f.latest, by_id(s));
}

void OuterForces::on_rebuild(const StepParts& parts) {
  RunState& s = parts.state;
  find_rows(s);
  if (std::exchange(is_restored_, false)) place_restored(s);
}

/// The forces that functions had in the last step of a restored state, on the present rows.
void OuterForces::place_restored(const RunState& s) {
  const ParticleSet& p = s.particles;
  for (const WrenchTable& table : restored_) {
    Function f;
    f.is_open = true;
    f.force.resize(p.owned);
    f.torque.resize(p.owned);
    join_rows(p, table, by_id(s), [&](const WrenchOnBody& entry, std::int32_t row) {
      if (row < 0) return;
      f.force[static_cast<std::size_t>(row)] = entry.wrench.force;
      f.torque[static_cast<std::size_t>(row)] = entry.wrench.torque;
    });
    functions_.push_back(std::move(f));
  }
  restored_.clear();
  sum_functions(s);
  acting_.clear();
  for (const OnRow& on : present(s))
    if (p.rest[on.row] != kAsleep) acting_.add(p, on);
}

void OuterForces::before_forces(RunState& s) {
  if (is_current_ && functions_.empty() && s.sleep == nullptr) return;  // the same on the same rows
  now_.clear();                                                         // of rows that may be others now, if a function throws
  acting_.clear();
  std::erase_if(functions_, [](const Function& f) { return f.given.call == nullptr; });  // nothing in a restored state is theirs now
  for (Function& f : functions_) s.clock.step % f.given.every == 0 ? call(s, f) : hold_latest(s, f);
  sum_functions(s);
  now_ = present(s);
  wake_changed(s, now_);
  is_current_ = false;
}

void OuterForces::add_forces(RunState& s) {
  ParticleSet& p = s.particles;
  if (is_current_) {
    acting_.begin_kick(p);
  } else {  // bodies that contacts woke in this step have their forces too
    acting_.clear();
    for (const OnRow& on : now_)
      if (p.rest[on.row] != kAsleep) acting_.add(p, on);
    is_current_ = true;
  }
  const std::size_t rows = acting_.row.size();
#pragma omp parallel for if (rows > kRowsWorthThreads)
  for (std::size_t k = 0; k < rows; ++k) p.force[acting_.row[k]] += acting_.force[k];
  for (const Acting::Turning& t : acting_.turning) p.torque[t.row] += t.torque;
}

void OuterForces::after_kick(RunState& s) {
  if (acting_.row.empty()) return;
  const ParticleSet& p = s.particles;
  if (s.integrator != Integrator::euler) add_work(s, 0.5 * s.clock.dt, [&p](const Acting::Turning& t) { return p.w[t.row]; });
  acting_.begin_kick(p);
}

}  // namespace scree
