#include "solver/effects/sleep/sleep_loads.hpp"

#include <algorithm>
#include <utility>

#include "solver/state/run_state.hpp"

namespace scree {

std::vector<BodyLoad> loads_on(RunState& s, const std::vector<std::size_t>& rows) {
  std::vector<BodyLoad> loads;
  if (rows.empty()) return loads;
  ParticleSet& p = s.particles;
  struct Columns {
    Vec3 force, torque, dissipative_force, dissipative_torque;
  };
  std::vector<Columns> kept;
  std::vector<RowRun> runs;
  for (const std::size_t i : rows) {
    kept.push_back({p.force[i], p.torque[i], p.dissipative_force[i], p.dissipative_torque[i]});
    if (runs.empty() || runs.back().end != i) runs.push_back({i, i});
    runs.back().end = i + 1;
  }
  // the sums of a step go over those that are awake: for once these are
  std::swap(p.awake, runs);
  s.pairs.sum_onto_bodies(s.scene.source().settings.gravity, p);
  if (s.fluid) s.fluid->add_buoyancy(p);
  std::swap(p.awake, runs);
  for (const std::size_t i : rows) {
    for (const std::unique_ptr<Effect>& effect : s.effects) effect->add_force_at_rest(s, i, p.force[i], p.torque[i]);
  }
  for (std::size_t n = 0; n < rows.size(); ++n) {
    const std::size_t i = rows[n];
    loads.push_back({p.force[i], p.torque[i]});
    p.force[i] = kept[n].force;
    p.torque[i] = kept[n].torque;
    p.dissipative_force[i] = kept[n].dissipative_force;
    p.dissipative_torque[i] = kept[n].dissipative_torque;
  }
  return loads;
}

}  // namespace scree
