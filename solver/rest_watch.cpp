#include "solver/rest_watch.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/base/error.hpp"
#include "solver/fluid.hpp"
#include "solver/run_log.hpp"

namespace scree {

RestWatch::RestWatch(const Scene& scene) : active_(scene.settings.stop_at_rest) {
  if (!active_) return;
  const double g = length(scene.settings.gravity);
  if (!(g > 0)) throw UsageError("time.stop_at_rest: without gravity nothing falls, so rest cannot be told; leave it out");
  std::optional<FluidForces> fluid;
  if (scene.settings.fluid) fluid.emplace(scene);
  double energy = 0, longest = 0;
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    if (scene.bodies.fixed[i] != 0) continue;
    const double diameter = scene.bodies.scale[i] * scene.shapes[static_cast<std::size_t>(scene.bodies.shape[i])].equivalent_diameter();
    const double mass = scene.mass(i);
    if (!fluid) {
      energy += mass * g * diameter;
      longest = std::max(longest, diameter / g);
    } else if (const double weight = fluid->weight(i); weight > 0) {
      const double speed = fluid->terminal_speed(i);
      energy += std::min(weight * diameter, 0.5 * mass * speed * speed);
      longest = std::max(longest, diameter * mass / weight);
    }
  }
  limit_ = kRestShare * energy;
  window_ = std::sqrt(2 * longest);
}

void RestWatch::add(double time, double kinetic) {
  if (!(kinetic <= limit_)) last_busy_ = std::max(last_busy_, time);
}

void RestWatch::read_log(const std::string& path) {
  if (!active_) return;
  const TableRows log = read_table(path);
  const std::size_t time = log.column("time"), translational = log.column("kinetic_translational"), rotational = log.column("kinetic_rotational");
  if (std::max({time, translational, rotational}) >= log.names.size()) {
    throw InputError("{}: lacks one of the columns time, kinetic_translational and kinetic_rotational; it is damaged or of another kind", path);
  }
  const auto value = [](const std::string& cell) { return std::strtod(cell.c_str(), nullptr); };
  for (const auto& row : log.rows) add(value(row[time]), value(row[translational]) + value(row[rotational]));
}

}  // namespace scree
