#include "solver/step/wall_drives.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

#include "core/base/error.hpp"
#include "core/storage/wall_state.hpp"

namespace scree {

namespace {

/// Of a period over 2 pi: a wall that its contacts push to and fro in fewer steps is not followed (the limit of stability is 2).
constexpr double kMostPhasePerStep = 1;

/// Whether a motion is on in the step with this middle.
bool is_on(const WallMotion& motion, double time) { return time >= motion.start && time < motion.stop; }

/// Of the wall's own inertia [m/s^2] or [rad/s^2], without damping.
double acceleration(const Drive& drive, const DriveState& at, const Vec3& gravity) {
  return (at.force + drive.push + drive.weight(gravity, at.way)) / drive.inertia;
}

double damping_share(const Drive& drive, double dt) { return drive.damping * dt / (2 * drive.inertia); }

/// With which it goes in a step that begins now.
/// in   contact_time   in which a servo makes up for its share [s]
double rate_ahead(const Drive& drive, const DriveState& at, const Vec3& gravity, double dt, double contact_time) {
  if (drive.inertia > 0) {
    const double rate = at.rate * (1 - damping_share(drive, dt)) + 0.5 * dt * acceleration(drive, at, gravity);
    return std::clamp(rate, -drive.most_rate, drive.most_rate);
  }
  const double missing = drive.push + at.force;  // the contacts press back
  if (!(at.stiffness > 0)) return std::copysign(drive.most_rate, missing);
  return std::clamp(at.yield + drive.share * missing / (at.stiffness * contact_time), -drive.most_rate, drive.most_rate);
}

/// Of the most sluggish contact; a step where none can occur.
double contact_time_of(const RunState& s) { return std::max(s.clock.size.slowest_contact_time, s.clock.dt); }

/// Calls action(wall, drive) for each that answers to force.
template <class Action>
void for_each_drive(const RunState& s, Action&& action) {
  for (std::size_t w = 0; w < s.totals.drives.size(); ++w) {
    if (const Drive* drive = s.scene.drive(w)) action(w, *drive);
  }
}

}  // namespace

void move_drives(RunState& s) {
  const double dt = s.clock.dt, middle = s.clock.time() + 0.5 * dt;
  const Vec3 gravity = s.scene.source().settings.gravity;
  for_each_drive(s, [&](std::size_t w, const Drive& drive) {
    DriveState& at = s.totals.drives[w];
    at.rate_before = 0;
    if (!is_on(s.scene.source().walls[w].motion, middle)) return;
    const double rate = rate_ahead(drive, at, gravity, dt, contact_time_of(s)), to = at.way + dt * rate;
    const double end = std::clamp(to, drive.lowest, drive.highest);
    at.rate_before = end == to ? rate : (end - at.way) / dt;
    at.way = end;
  });
}

void feel_drives(RunState& s) {
  if (s.totals.drives.empty()) return;
  enum { force, stiffness, yield, count };
  std::vector<ExactSum> sums(count * s.totals.drives.size());
  std::vector<Guide> guides(s.totals.drives.size());
  std::vector<bool> answers(s.totals.drives.size(), false);
  for_each_drive(s, [&](std::size_t w, const Drive& drive) {
    guides[w] = drive.guide;
    answers[w] = true;
  });
  for (const std::int32_t k : s.pairs.with_walls()) {
    const PairResult& r = s.pairs.results()[static_cast<std::size_t>(k)];
    if (!r.active) continue;
    const BodyPair& pair = s.pairs.pairs()[static_cast<std::size_t>(k)];
    const auto w = static_cast<std::size_t>(s.scene.zones()[static_cast<std::size_t>(pair.key.zone)].wall);
    if (!answers[w]) continue;
    const auto on_wall = [&](const Vec3& force_a, const Vec3& torque_a) {
      return guides[w].component(-force_a, cross(s.particles.x[static_cast<std::size_t>(pair.a)], -force_a) - torque_a);
    };
    const double all = on_wall(r.force_a, r.torque_a), elastic = all - on_wall(r.dissipative_force_a, r.dissipative_torque_a);
    sums[count * w + force].add(all);
    if (!(r.elastic > 0)) continue;
    sums[count * w + stiffness].add(elastic * elastic / (2 * r.elastic));
    const Vec3 push = r.dissipative_force_a - r.force_a;
    sums[count * w + yield].add(elastic * dot(push, s.particles.v[static_cast<std::size_t>(pair.a)]) / (2 * r.elastic));
  }
  add_over_ranks(s.comm.get(), sums);
  for_each_drive(s, [&](std::size_t w, const Drive&) {
    s.totals.drives[w].force = sums[count * w + force].value();
    DriveState& at = s.totals.drives[w];
    at.stiffness = sums[count * w + stiffness].value();
    at.yield = at.stiffness > 0 ? sums[count * w + yield].value() / at.stiffness : 0;
  });
}

void respond_drives(RunState& s) {
  feel_drives(s);
  const double dt = s.clock.dt, time = s.clock.time();
  const Vec3 gravity = s.scene.source().settings.gravity;
  for_each_drive(s, [&](std::size_t w, const Drive& drive) {
    const Wall& wall = s.scene.source().walls[w];
    DriveState& at = s.totals.drives[w];
    const bool is_at_end = at.way == drive.lowest || at.way == drive.highest;
    if (!is_on(wall.motion, time - 0.5 * dt)) {
      at.rate = 0;
    } else if (drive.inertia > 0) {
      const double phase = dt * std::sqrt(at.stiffness / drive.inertia);
      if (!(phase <= kMostPhasePerStep)) {
        throw RunInvalid(
            "step {}: wall '{}' is too light for its contacts: together they push it to and fro within {:.3g} steps of {:.3g} s; give it "
            "more mass, or use a step of at most {:.3g} s",
            s.clock.step, wall.name, 2 * std::numbers::pi / phase, dt, 0.5 * kMostPhasePerStep * dt / phase);
      }
      const double rate = (at.rate_before + 0.5 * dt * acceleration(drive, at, gravity)) / (1 + damping_share(drive, dt));
      at.rate = is_at_end ? 0 : std::clamp(rate, -drive.most_rate, drive.most_rate);
    } else {
      const double ahead = is_on(wall.motion, time + 0.5 * dt) ? rate_ahead(drive, at, gravity, dt, contact_time_of(s)) : 0;
      const bool stays = (at.way == drive.highest && ahead > 0) || (at.way == drive.lowest && ahead < 0);
      at.rate = 0.5 * (at.rate_before + (stays ? 0 : ahead));
    }
    s.walls[w] = wall_state(wall, time, dt, &at);
  });
}

double wall_share_of_frequency(const RunState& s, std::size_t wall) {
  if (wall >= s.totals.drives.size()) return 0;
  const Drive* drive = s.scene.drive(wall);
  return drive != nullptr && drive->inertia > 0 ? s.totals.drives[wall].stiffness / drive->inertia : 0;
}

}  // namespace scree
