#include <fmt/format.h>

#include <algorithm>

#include "solver/effects/outer_forces/outer_forces.hpp"
#include "solver/state/run_state.hpp"

namespace scree {

void OuterForces::falls_asleep(RunState& s, std::size_t row) {
  const std::int64_t id = s.particles.id[row];
  const auto at = std::lower_bound(acting_.row.begin(), acting_.row.end(), row);
  if (at == acting_.row.end() || *at != row) {
    kept_.erase(id);
    return;
  }
  const std::ptrdiff_t k = at - acting_.row.begin();
  const auto turn = std::find_if(acting_.turning.begin(), acting_.turning.end(), [row](const auto& t) { return t.row == row; });
  const bool turns = turn != acting_.turning.end();
  kept_[id] = {acting_.force[static_cast<std::size_t>(k)], turns ? turn->torque : Vec3{}};
  if (turns) acting_.turning.erase(turn);
  acting_.row.erase(at);
  acting_.force.erase(acting_.force.begin() + k);
  acting_.v.erase(acting_.v.begin() + k);
  is_current_ = false;
}

void OuterForces::add_force_at_rest(const RunState& s, std::size_t row, Vec3& force, Vec3& torque) const {
  const auto found = kept_.find(s.particles.id[row]);
  if (found == kept_.end()) return;
  force += found->second.force;
  torque += found->second.torque;
}

EffectRecord OuterForces::record(const RunState& s) const {
  if (!is_used_) return {};
  std::vector<StateArray> tables;
  const auto add_table = [&](const std::vector<WrenchOnBody>& mine) {
    const std::vector<WrenchOnBody> all = of_all_ranks(s, mine);
    tables.push_back(ids_of(all));
    tables.push_back(numbers_of(all));
    return all.size();
  };
  const auto append = [](StateArray& to, const StateArray& from) {
    to.reals.insert(to.reals.end(), from.reals.begin(), from.reals.end());
    to.integers.insert(to.integers.end(), from.integers.begin(), from.integers.end());
  };
  add_table(held_);
  StateArray rows, ids, numbers;  // of one function after the other
  for (const Function& f : functions_) {
    std::vector<WrenchOnBody> mine;
    for (std::size_t i = 0; i < f.force.size(); ++i) {
      const Wrench w{f.force[i], f.torque[i]};
      if (!is_zero(w)) mine.push_back({s.particles.id[i], w});
    }
    rows.integers.push_back(static_cast<std::int64_t>(add_table(mine)));
    append(numbers, tables.back());
    tables.pop_back();
    append(ids, tables.back());
    tables.pop_back();
  }
  tables.insert(tables.end(), {rows, ids, numbers});
  add_table(table_of(kept_));
  tables.push_back(array_of(over_ranks(s.comm.get(), work_)));
  return tables;
}

void OuterForces::restore(RunState& s, const EffectRecord& record) {
  held_ = wrenches_of(record[0], record[1]);
  restored_.clear();
  StateArray ids = record[3], numbers = record[4];
  for (const std::int64_t rows : record[2].integers) {
    if (rows < 0 || static_cast<std::size_t>(rows) > ids.integers.size() ||
        static_cast<std::size_t>(rows * kNumbersOfWrench) > numbers.reals.size())
      throw InputError("outer forces: a function has {} bodies, of {} that are there; the file is damaged", rows, ids.integers.size());
    const std::ptrdiff_t bodies = rows, reals = rows * kNumbersOfWrench;
    restored_.push_back(wrenches_of({{}, {ids.integers.begin(), ids.integers.begin() + bodies}},
                                    {{numbers.reals.begin(), numbers.reals.begin() + reals}, {}}));
    ids.integers.erase(ids.integers.begin(), ids.integers.begin() + bodies);
    numbers.reals.erase(numbers.reals.begin(), numbers.reals.begin() + reals);
  }
  if (!ids.integers.empty() || !numbers.reals.empty())
    throw InputError("outer forces: {} bodies are of no function; the file is damaged", ids.integers.size());
  for (const WrenchOnBody& entry : wrenches_of(record[5], record[6])) kept_[entry.id] = entry.wrench;
  const ExactSum work = sum_of(record[7]);
  if (s.comm.rank() == 0) work_ = work;
  is_used_ = is_restored_ = true;
}

std::vector<int> OuterForces::numbers() const {
  std::vector<int> all;
  for (const Function& f : functions_) all.push_back(f.number);
  return all;
}

std::vector<std::string> OuterForces::function_names() const {
  std::vector<std::string> all;
  for (const Function& f : functions_)
    if (f.given.call != nullptr) all.push_back(f.given.name);
  return all;
}

std::int64_t OuterForces::held_count(const RunState& s) const { return s.comm.sum(static_cast<std::int64_t>(held_.size())); }

std::string OuterForces::cause_of_motion(const RunState& s, std::size_t row) const {
  constexpr double kLargePart = 0.5;  // of the force on the body
  const ParticleSet& p = s.particles;
  const auto at = std::lower_bound(acting_.row.begin(), acting_.row.end(), row);
  if (at == acting_.row.end() || *at != row) return "";
  const double own = length(acting_.force[static_cast<std::size_t>(at - acting_.row.begin())]), all = length(p.force[row]);
  if (!(own > kLargePart * all)) return "";
  const double m = p.mass[row], dt = s.clock.dt;
  return fmt::format(
      "forces of the program give it {:.3g} N of the {:.3g} N that act on it. They have a limit of their own: with this step and its mass "
      "of "
      "{:.3g} kg a drag C is stable below 2 m / dt = {:.3g} N s/m, and a spring below m (2 / dt)^2 = {:.3g} N/m; reduce the force or its "
      "coefficient, or give a step below 2 m / C and 2 sqrt(m / k)",
      own, all, m, 2 * m / dt, m * (2 / dt) * (2 / dt));
}

void OuterForces::add_energies(const RunState& s, Energies& energies) const {
  energies.outer_work = over_ranks(s.comm.get(), work_).value();
}

void OuterForces::add_log_columns(const RunState&, const Energies& energies, std::vector<Column>& columns) const {
  columns.push_back({"outer_work", "J", exact(energies.outer_work)});
}

std::vector<PlanLine> OuterForces::plan(const RunState& s) const {
  return {{"outer forces", fmt::format("held on {} bodies, and {} functions", held_count(s), functions_.size())}};
}

EffectKind outer_forces_effect() {
  EffectFormat format{"outer_forces",
                      "the forces that act from outside, or their work, differ",
                      {{"held_id", "", 1, false},
                       {"held", "N; N m", kNumbersOfWrench},
                       {"functions_bodies", "", 1, false},
                       {"functions_id", "", 1, false},
                       {"functions", "N; N m", kNumbersOfWrench},
                       {"kept_id", "", 1, false},
                       {"kept", "N; N m", kNumbersOfWrench},
                       sum_format("work")}};
  format.is_optional = true;
  EffectKind kind{format, {}, [](const RunState&) -> std::unique_ptr<Effect> { return nullptr; }};
  kind.make_on_demand = [](const RunState&) -> std::unique_ptr<Effect> { return std::make_unique<OuterForces>(); };
  return kind;
}

}  // namespace scree
