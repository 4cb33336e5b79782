// What a scene has of attraction: which materials attract each other, how, and what that asks of its laws.
#include <algorithm>
#include <cmath>

#include "core/storage/attraction.hpp"
#include "solver/scene/solver_scene.hpp"

namespace scree {

void SolverScene::check_necks() const {
  for (const MaterialPair& pair : scene_->pairs) {
    if (!attracts(pair) || pull_kind(pair) == PullKind::neck) continue;
    throw UsageError(
        "pairs: '{}' and '{}' attract each other without adhesion_hysteresis, other materials with it; in one scene either all that "
        "attract "
        "have it, or none",
        scene_->materials[static_cast<std::size_t>(pair.a)].name, scene_->materials[static_cast<std::size_t>(pair.b)].name);
  }
}

double SolverScene::largest_pull_off(const MaterialPair& pair, const BodyExtremes& extremes) const {
  return attracts(pair) ? pull_off_force(pair, largest_impact(pair, extremes).radius) : 0;
}

double SolverScene::sticking_speed(const MaterialPair& pair) const {
  if (scene_->settings.gather == Gathering::area) return BodyExtremes::kNone;  // its work goes with the area that touches
  double mobility = 0;
  for (const std::int32_t m : {pair.a, pair.b}) mobility += 1 / extremes_.least_mass[static_cast<std::size_t>(m)];
  const Material &a = scene_->materials[static_cast<std::size_t>(pair.a)], &b = scene_->materials[static_cast<std::size_t>(pair.b)];
  const double radius = largest_impact(pair, extremes_).radius;
  return radius > 0 ? std::sqrt(2 * parting_energy(scene_->settings.law, pair, a, b, radius) * mobility) : 0;
}

void SolverScene::add_attraction(const MaterialPair& pair, const BodyExtremes& extremes, PairLaw& law) const {
  const Material &a = scene_->materials[static_cast<std::size_t>(pair.a)], &b = scene_->materials[static_cast<std::size_t>(pair.b)];
  const Settings& settings = scene_->settings;
  if (const AttractionFault fault = attraction_fault(settings, pair, a, b); fault.key[0] != 0)
    throw UsageError("pairs: '{}' and '{}': {} {}", a.name, b.name, fault.key, fault.text);
  const double radius = largest_impact(pair, extremes).radius;
  if (pull_kind(pair) == PullKind::neck)
    law.neck_adhesion = pair.adhesion;
  else if (settings.gather == Gathering::area)
    law.pull_modulus = steepest_pull(settings, pair, a, b, radius);
  else if (pair.adhesion > 0 || pair.surface_tension > 0)
    law.pull_off_per_radius = pull_off_force(pair, 1);
  else
    law.pull_off = pair.pull_off;
  if (pull_kind(pair) == PullKind::bridge) law.bridge = &pair;
  law.reach = attraction_range(settings.law, pair, a, b, radius);
  check_pressing(settings, pair, a, b, radius, largest_max_overlap_);
}

}  // namespace scree
