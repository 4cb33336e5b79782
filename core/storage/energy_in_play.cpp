#include "core/storage/energy_in_play.hpp"

namespace scree {

double still_fall_energy(const Scene& scene) {
  constexpr double kStillFall = 1e-6;  // diameters
  double energy = 0;
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    if (scene.bodies.fixed[i] != 0) continue;
    const double diameter = scene.bodies.scale[i] * scene.shapes[static_cast<std::size_t>(scene.bodies.shape[i])].equivalent_diameter();
    energy += kStillFall * scene.mass(i) * length(scene.settings.gravity) * diameter;
  }
  return energy;
}

double relative_energy_error(double error, const EnergyInPlay& in_play, const Scene& scene) {
  const double scale = std::max(in_play.largest(), still_fall_energy(scene));
  return scale > 0 ? error / scale : 0;
}

}  // namespace scree
