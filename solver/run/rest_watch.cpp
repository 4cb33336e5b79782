#include "solver/run/rest_watch.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/error.hpp"
#include "solver/bodies/fluid.hpp"
#include "solver/bodies/motion.hpp"
#include "solver/run/table.hpp"

namespace scree {

RestWatch::RestWatch(const Scene& scene) : active_(scene.settings.stop_at_rest), scene_(&scene) {
  if (!active_) return;
  gravity_ = length(scene.settings.gravity);
  if (!(gravity_ > 0)) throw UsageError("time.stop_at_rest: without gravity nothing falls, so rest cannot be told; leave it out");
  for (const Wall& wall : scene.walls) walls_stop_ = std::max({walls_stop_, wall.motion.end(), wall.surface.end()});
  if (scene.settings.fluid) fluid_.emplace(scene);
  double energy = 0, longest = 0;
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    if (scene.bodies.fixed[i] != 0) continue;
    const Fall fall = fall_of(kind_of(scene.bodies, i));
    energy += fall.gain;
    longest = std::max(longest, fall.time);
  }
  limit_ = kRestShare * energy;
  window_ = std::sqrt(2 * longest);
}

RestWatch::Fall RestWatch::fall_of(const BodyKind& body) const {
  constexpr double kWeightless = 1e-12;  // of the weight in a void: rounding of densities that agree
  const double diameter = body.scale * scene_->shapes[static_cast<std::size_t>(body.shape)].equivalent_diameter();
  const double mass = scene_->mass(body.shape, body.material, body.scale), weight = fluid_ ? fluid_->weight(body) : mass * gravity_;
  const bool falls = weight > kWeightless * mass * gravity_;
  const double pull = falls ? weight : mass * gravity_;
  double gain = pull * diameter;
  if (fluid_ && falls) {
    const double speed = fluid_->terminal_speed(body);
    gain = std::min(gain, 0.5 * mass * speed * speed);
  }
  return {gain, diameter * mass / pull};
}

double RestWatch::busiest(const ParticleSet& p) const {
  double most = 0;
  for (std::size_t i = 0; i < p.owned && active_; ++i) {
    if (p.fixed[i]) continue;
    const BodyKind kind = kind_of(p, i);
    auto known = gains_.find(kind);
    if (known == gains_.end()) known = gains_.emplace(kind, fall_of(kind).gain).first;
    most = std::max(most, (translational_energy(p, i) + rotational_energy(p, i)) / known->second);
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
