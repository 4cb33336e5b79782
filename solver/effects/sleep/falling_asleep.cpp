// Sleep::review: which bodies are ready, and which of these fall asleep.
//
// A body on its tip is not at rest, however slowly it begins to fall: the torque on it grows. So the torque must not have grown to the next
// power of 2 over the time for which a body is found at rest; else that time begins again. Of a body that stands or rocks, and comes to
// rest, it has not, sooner or later. What `rest` counts while a body is awake is the number of looks, and with it the power of 2 at the
// first of them.
#include <algorithm>
#include <cmath>

#include "core/base/index.hpp"
#include "solver/bodies/motion.hpp"
#include "solver/effects/sleep/sleep.hpp"
#include "solver/effects/sleep/sleep_loads.hpp"
#include "solver/state/run_state.hpp"

namespace scree {

namespace {

/// Beside the number of looks during a review: the body is ready.
constexpr std::int32_t kReady = 1 << 30;
constexpr std::int32_t kOctave = 20;  ///< first bit of the power of 2 of the torque
constexpr std::int32_t kMostLooks = (1 << kOctave) - 1;
/// Torques below this power of 1/2 of the tolerance may grow: far above rounding, and far below what a body falls by.
constexpr std::int32_t kLowestOctave = 10;

/// How many times a torque can be doubled below the tolerance.   in   torque   over the tolerance, below 1
std::int32_t octave_of(double torque) {
  return torque < std::ldexp(1.0, -kLowestOctave) ? kLowestOctave : static_cast<std::int32_t>(-std::ilogb(torque) - 1);
}

bool is_awake(const ParticleSet& p, std::size_t i) { return p.rest[i] != kAsleep && !p.fixed[i]; }

double kinetic_energy(const ParticleSet& p, std::size_t i) { return translational_energy(p, i) + rotational_energy(p, i); }

}  // namespace

/// Counts the looks that found each owned body at rest. Returns whether one of them is ready, and marks these.
bool Sleep::count_quiet(RunState& s) const {
  ParticleSet& p = s.particles;
  std::vector<std::uint8_t> on_restless(p.owned, 0);
  for (const std::int32_t k : s.pairs.with_walls()) {
    if (!s.pairs.results()[at(k)].active) continue;
    const BodyPair& pair = s.pairs.pairs()[at(k)];
    if (restless_[at(s.scene.zones()[at(pair.key.zone)].wall)] != 0) on_restless[at(pair.a)] = 1;
  }
  const double tolerance = s.scene.source().settings.sleep_tolerance, between = static_cast<double>(kSleepSteps) * s.clock.size.step;
  bool any = false;
  for (std::size_t i = 0; i < p.owned; ++i) {
    if (!is_awake(p, i)) continue;
    const double weight = weight_of(s, i), diameter = 2 * p.equivalent_radius[i];
    const double torque = p.lock_rotation[i] != 0 ? 0.0 : length(p.torque[i]) / (tolerance * weight * p.equivalent_radius[i]);
    const bool quiet = on_restless[i] == 0 && kinetic_energy(p, i) < kSleepEnergy * weight * diameter &&
                       length(p.force[i]) < tolerance * weight && torque < 1;
    if (!quiet) {
      p.rest[i] = 0;
      continue;
    }
    // the first look of a row of them begins the time
    const std::int32_t before = p.rest[i] & kMostLooks, begins = 1 | (octave_of(torque) << kOctave);
    p.rest[i] = before == 0 ? begins : before < kMostLooks ? p.rest[i] + 1 : p.rest[i];
    const double time = std::sqrt(2 * diameter * p.mass[i] / weight);
    if (!(before * between >= time)) continue;
    if (!((before - 1) * between >= time) && octave_of(torque) < p.rest[i] >> kOctave) {  // as the time is over
      p.rest[i] = begins;
      continue;
    }
    p.rest[i] |= kReady;
    any = true;
  }
  return any;
}

/// Takes the mark from those that touch one without it.
void Sleep::stay_with_neighbours(RunState& s) const {
  ParticleSet& p = s.particles;
  const auto is_ready = [&](std::int32_t row) { return (p.rest[at(row)] & kReady) != 0; };
  std::vector<std::int32_t> stay;
  for (std::size_t k = 0; k < s.pairs.results().size(); ++k) {
    const IdlePair& pair = s.pairs.idle()[k];
    if (pair.b < 0 || !s.pairs.results()[k].active || !is_awake(p, at(pair.a)) || !is_awake(p, at(pair.b))) continue;
    if (is_ready(pair.a) != is_ready(pair.b)) stay.push_back(is_ready(pair.a) ? pair.a : pair.b);
  }
  // marks go once all pairs are looked at: else their order would enter
  for (const std::int32_t row : stay) p.rest[at(row)] &= ~kReady;
}

/// All that are left with a mark. Returns whether somebody was.
bool Sleep::fall_asleep(RunState& s) {
  ParticleSet& p = s.particles;
  bool any = false;
  for (std::size_t i = 0; i < p.owned; ++i) {
    if (!is_awake(p, i) || (p.rest[i] & kReady) == 0) continue;
    // half of what the last step was counted with lies ahead, and is not to come
    p.dissipated[i] += contact_dissipation(p, i, -0.5 * s.clock.dt);
    for (const std::unique_ptr<Effect>& effect : s.effects) effect->falls_asleep(s, i);
    slept_.add(kinetic_energy(p, i));
    p.v[i] = p.L[i] = p.w[i] = {};
    p.rest[i] = kAsleep;
    any = true;
  }
  return any;
}

void Sleep::review(RunState& s, Halo& halo, ForceScratch& scratch, FirstFailure& failure) {
  if (find_restless_walls(s)) dirty_ = true;
  const bool ready = count_quiet(s);
  if (!(s.comm.max(ready ? 1.0 : 0.0) > 0)) return;
  halo.start_refresh(s.particles, s.times);
  halo.finish_refresh(s.particles, s.times);
  stay_with_neighbours(s);
  std::vector<std::size_t> sleepers;
  for (std::size_t i = 0; i < s.particles.owned; ++i) {
    if (is_awake(s.particles, i) && (s.particles.rest[i] & kReady) != 0) sleepers.push_back(i);
  }
  if (!(s.comm.max(fall_asleep(s) ? 1.0 : 0.0) > 0)) return;
  // ghosts that sleep have no velocity either
  halo.start_refresh(s.particles, s.times);
  halo.finish_refresh(s.particles, s.times);
  dirty_ = true;
  find_awake_rows(s);
  sort_pairs(s, scratch, failure);
  // without motion: what later forces are compared with
  const std::vector<BodyLoad> loads = loads_on(s, sleepers);
  for (std::size_t n = 0; n < sleepers.size(); ++n) {
    s.particles.force[sleepers[n]] = loads[n].force;
    s.particles.torque[sleepers[n]] = loads[n].torque;
  }
}

}  // namespace scree
