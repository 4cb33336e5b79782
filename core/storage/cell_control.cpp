// What a periodic cell that deforms does not go with.
#include <algorithm>

#include "core/storage/scene.hpp"

namespace scree {

CellBlocker cell_blocker(const Settings& s) {
  const auto& periodic = s.domain.periodic;
  if (!s.domain.bounded || !periodic[0] || !periodic[1] || !periodic[2])
    return {"domain", "the cell is the domain, periodic in x, y and z; give domain.min, domain.max and periodic = [\"x\", \"y\", \"z\"]"};
  if (s.domain.outside == Outside::remove) return {"domain.outside", "no body can leave it; leave outside out"};
  if (!(s.gravity == Vec3{})) return {"gravity", "nothing holds up what is in it; write gravity = [0, 0, 0]"};
  if (s.sleep) return {"time.sleep", "what sleeps would not go with the cell; leave sleep out"};
  if (s.stop_at_rest) return {"time.stop_at_rest", "rest is told by falls, and nothing falls; use cell.stop_when"};
  if (s.stop_when_empty) return {"time.stop_when_empty", "no body can leave it; leave stop_when_empty out"};
  if (s.step_control == StepControl::quantised) return {"time.step_control", "the cell moves by steps of one length; use \"fixed\""};
  if (s.integrator == Integrator::euler) return {"motion.integrator", "euler has no middle of a step to deform in; use another one"};
  if (s.fluid) return {"fluid", "a fluid does not go with the cell; leave [fluid] out"};
  if (s.heat) return {"heat", "the work of the cell is not part of the heat balance; leave [heat] out"};
  if (s.output_impacts) return {"output.impacts", "what contacts lose is counted by the velocities of bodies alone; leave impacts out"};
  return {};
}

CellBlocker cell_blocker(const Scene& scene) {
  if (const CellBlocker of_settings = cell_blocker(scene.settings); of_settings.key != nullptr) return of_settings;
  if (!scene.walls.empty()) return {"walls", "walls do not deform with it; leave them out"};
  if (!scene.inlets.empty()) return {"inlets", "the momentum of all bodies together must stay 0; leave them out"};
  if (!scene.outlets.empty()) return {"outlets", "the momentum of all bodies together must stay 0; leave them out"};
  if (!scene.forces.empty()) return {"bodies.force", "the momentum of all bodies together must stay 0; leave it out"};
  if (!scene.bonds.empty()) return {"bonds", "forces of bonds are not part of the stress that it measures; leave them out"};
  const std::vector<std::uint8_t>& fixed = scene.bodies.fixed;
  if (std::any_of(fixed.begin(), fixed.end(), [](std::uint8_t f) { return f != 0; }))
    return {"bodies.fixed", "a fixed body would not go with it; leave fixed out"};
  return {};
}

}  // namespace scree
