#include "solver/step/balls_alone.hpp"

#include <algorithm>

#include "solver/built_with.hpp"
#include "solver/pairs/forces.hpp"

namespace scree {

bool are_balls_alone(const RunState& s) {
  const ParticleSet& p = s.particles;
  const Settings& settings = s.scene.source().settings;
  if (!built_with::kRotation || s.comm.size() > 1 || s.fluid || s.clock.level > 0 || settings.step_control == StepControl::quantised ||
      s.integrator == Integrator::euler || p.cell.deforms() || p.cell.periodicity().is_sheared() || s.scene.has_moving_surfaces() ||
      s.scene.has_answering_walls() || !s.scene.source().inlets.empty() || !may_use_blocks(s.scene, p))
    return false;
  const LaneLaws& laws = s.scene.ball_laws();
  // two materials that nothing asks the law of do not meet: those of walls, or what nothing is made of
  const std::vector<MaterialPair>& pairs = s.scene.source().pairs;
  if (std::any_of(pairs.begin(), pairs.end(), [&](const MaterialPair& pair) { return laws.holds[laws.row(pair.a, pair.b)] == 0; }) ||
      std::any_of(laws.row_of_zone.begin(), laws.row_of_zone.end(), [](std::int32_t row) { return row < 0; }))
    return false;  // some pairs go the general path in every step
  for (std::size_t i = 0; i < p.size(); ++i)
    if (!(p.ball_radius[i] > 0) || p.isotropic[i] == 0) return false;
  return true;
}

bool are_effects_idle(const RunState& s) {
  return std::all_of(s.effects.begin(), s.effects.end(), [](const auto& effect) { return effect->is_idle(); });
}

}  // namespace scree
