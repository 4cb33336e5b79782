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
  std::vector<WrenchOnBody> of_functions;
  for (std::size_t i = 0; i < force_.size(); ++i) {
    const Wrench w{force_[i], torque_[i]};
    if (!is_zero(w)) of_functions.push_back({s.particles.id[i], w});
  }
  EffectRecord record;
  for (const auto& rows : {held_, of_functions, table_of(kept_)}) {
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
  for (const WrenchOnBody& entry : wrenches_of(record[4], record[5])) kept_[entry.id] = entry.wrench;
  const ExactSum work = sum_of(record[6]);
  if (s.comm.rank() == 0) work_ = work;
  is_used_ = is_restored_ = true;
}

WrenchTable OuterForces::latest_of(int number) const {
  const auto at = std::find_if(functions_.begin(), functions_.end(), [number](const Function& f) { return f.number == number; });
  return at == functions_.end() ? WrenchTable{} : table_of(at->latest);
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
  EffectFormat format{"outer_forces",
                      "the forces that act from outside, or their work, differ",
                      {{"held_id", "", 1, false},
                       {"held", "N; N m", kNumbersOfWrench},
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
