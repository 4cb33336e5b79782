#include "solver/effects/effects.hpp"

#include "solver/effects/bonds/bonds.hpp"
#include "solver/effects/cell/cell.hpp"
#include "solver/effects/drives/drives.hpp"
#include "solver/effects/given_forces/given_forces.hpp"
#include "solver/effects/heat/heat.hpp"
#include "solver/effects/impacts/impacts.hpp"
#include "solver/effects/load_maps/load_maps.hpp"
#include "solver/effects/outer_forces/outer_forces.hpp"
#include "solver/effects/sleep/sleep.hpp"
#include "solver/effects/wear/wear.hpp"

namespace scree {

const std::vector<EffectKind>& effect_kinds() {
  // The order carries physics:
  //   given forces  are added to bodies before those of bonds: sums of floating-point numbers have an order
  //   outer forces  the same: a constant one gives the bits of a given force
  //   bonds         break before the second kick of a step, and are replaced after it
  //   cell          takes in the velocities at the end of a step, after all that changes them
  //   drives        set the velocities of walls at the end of a step, by which the work on walls is counted: before what records it
  //   load maps     count the sliding work of a step before walls wear by it
  //   heat          comes last in a step: what the step has dissipated is known, and bodies have their velocities
  //   wear          changes walls between two steps; which bodies sleep is judged by the walls as they are then
  static const std::vector<EffectKind> kinds{given_forces_effect(), outer_forces_effect(), bonds_effect(), cell_effect(), drives_effect(),
                                             load_maps_effect(),    impacts_effect(),      heat_effect(),  wear_effect(), sleep_effect()};
  return kinds;
}

std::vector<std::unique_ptr<Effect>> make_effects(const RunState& s) {
  std::vector<std::unique_ptr<Effect>> effects;
  for (std::size_t k = 0; k < effect_kinds().size(); ++k) {
    std::unique_ptr<Effect> effect = effect_kinds()[k].make(s);
    if (effect == nullptr) continue;
    effect->set_kind(k);
    effects.push_back(std::move(effect));
  }
  return effects;
}

}  // namespace scree
