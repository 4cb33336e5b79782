#include "solver/run/rest_watch.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/base/error.hpp"
#include "solver/bodies/fluid.hpp"
#include "solver/bodies/motion.hpp"
#include "solver/run/table.hpp"

namespace scree {

RestWatch::RestWatch(const Scene& scene) : active_(scene.settings.stop_at_rest) {
  if (!active_) return;
  const double g = length(scene.settings.gravity);
  if (!(g > 0)) throw UsageError("time.stop_at_rest: without gravity nothing falls, so rest cannot be told; leave it out");
  for (const Wall& wall : scene.walls) walls_stop_ = std::max(walls_stop_, wall.motion.end());
  std::optional<FluidForces> fluid;
  if (scene.settings.fluid) fluid.emplace(scene);
  constexpr double kWeightless = 1e-12;  // of the weight in a void: rounding of densities that agree
  double energy = 0, longest = 0;
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    if (scene.bodies.fixed[i] != 0) continue;
    const double diameter = scene.bodies.scale[i] * scene.shapes[static_cast<std::size_t>(scene.bodies.shape[i])].equivalent_diameter();
    const double mass = scene.mass(i), weight = fluid ? fluid->weight(i) : mass * g;
    const bool falls = weight > kWeightless * mass * g;
    const double pull = falls ? weight : mass * g;
    double gain = pull * diameter;
    if (fluid && falls) {
      const double speed = fluid->terminal_speed(i);
      gain = std::min(gain, 0.5 * mass * speed * speed);
    }
    energy += gain;
    longest = std::max(longest, diameter * mass / pull);
    fall_.emplace(scene.bodies.id[i], gain);
  }
  limit_ = kRestShare * energy;
  window_ = std::sqrt(2 * longest);
}

double RestWatch::busiest(const ParticleSet& p) const {
  double most = 0;
  for (std::size_t i = 0; i < p.owned; ++i) {
    const auto fall = fall_.find(p.id[i]);
    if (fall != fall_.end()) most = std::max(most, (translational_energy(p, i) + rotational_energy(p, i)) / fall->second);
  }
  return most;
}

void RestWatch::add(double time, double kinetic) {
  if (!(kinetic <= limit_)) last_busy_ = std::max(last_busy_, time);
}

void RestWatch::read_log(const std::string& path) {
  if (!active_) return;
  const StepTable log = read_table(path);
  const std::size_t time = log.column("time"), translational = log.column("kinetic_translational"),
                    rotational = log.column("kinetic_rotational");
  if (std::max({time, translational, rotational}) >= log.names.size()) {
    throw InputError("{}: lacks one of the columns time, kinetic_translational and kinetic_rotational; it is damaged or of another kind",
                     path);
  }
  const auto value = [](const std::string& cell) { return std::strtod(cell.c_str(), nullptr); };
  for (const auto& row : log.rows) add(value(row[time]), value(row[translational]) + value(row[rotational]));
}

}  // namespace scree
