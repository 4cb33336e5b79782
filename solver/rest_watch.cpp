#include "solver/rest_watch.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <optional>
#include <sstream>
#include <vector>

#include "core/base/error.hpp"
#include "solver/fluid.hpp"

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
  std::ifstream file(path);
  std::string line, cell;
  std::vector<std::string> names;
  while (std::getline(file, line)) {
    if (line.starts_with("#")) continue;
    std::istringstream row(line);
    std::vector<std::string> cells;
    while (std::getline(row, cell, ',')) cells.push_back(cell);
    if (names.empty()) {
      names = cells;
      continue;
    }
    const auto value = [&](const char* name) {
      const auto at = static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin());
      if (at >= cells.size()) throw InputError("{}: a row has no {}; the log is cut short", path, name);
      return std::strtod(cells[at].c_str(), nullptr);
    };
    add(value("time"), value("kinetic_translational") + value("kinetic_rotational"));
  }
}

}  // namespace scree
