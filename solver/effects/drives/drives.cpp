#include "solver/effects/drives/drives.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

#include "core/base/error.hpp"
#include "core/storage/wall_state.hpp"
#include "solver/state/run_state.hpp"
#include "solver/step_size/step_size.hpp"

namespace scree {

namespace {

/// Of a period over 2 pi: a wall that its contacts push to and fro in fewer steps is not followed (the limit of stability is 2).
constexpr double kMaxPhasePerStep = 1;

/// Of the radius of the smallest body: farther than so, a wall does not go in a step, as no body does (check_displacement).
constexpr double kMaxWay = 0.25;

/// Whether a motion is on in the step with this middle.
bool is_on(const WallMotion& motion, double time) { return time >= motion.start && time < motion.stop; }

/// Of the wall's own inertia [m/s^2] or [rad/s^2], without damping.
double acceleration(const Drive& drive, const DriveState& at, const Vec3& gravity) {
  return (at.force + drive.push + drive.weight(gravity, at.way)) / drive.inertia;
}

double damping_share(const Drive& drive, double dt) { return drive.damping * dt / (2 * drive.inertia); }

/// With which it goes in a step that begins now.
double rate_ahead(const Drive& drive, const DriveState& at, const Vec3& gravity, double dt) {
  if (drive.is_outer) return at.asked;
  if (drive.inertia > 0) {
    const double rate = at.rate * (1 - damping_share(drive, dt)) + 0.5 * dt * acceleration(drive, at, gravity);
    return std::clamp(rate, -drive.most_rate, drive.most_rate);
  }
  const double missing = drive.push + at.force;  // the contacts press back
  if (!(at.impedance > 0)) return std::copysign(drive.most_rate, missing);
  return std::clamp(at.yield + drive.share * missing / at.impedance, -drive.most_rate, drive.most_rate);
}

/// Calls action(wall, drive) for each that answers to force.
template <class Action>
void for_each_drive(const RunState& s, Action&& action) {
  for (std::size_t w = 0; w < s.drives.size(); ++w) {
    if (const Drive* drive = s.scene.drive(w)) action(w, *drive);
  }
}

/// Moves them by the present step. Throws RunInvalid, on every rank, for one that goes too far in it.
void move_drives(RunState& s) {
  const double dt = s.clock.dt, middle = s.clock.time() + 0.5 * dt;
  const Vec3 gravity = s.scene.source().settings.gravity;
  for_each_drive(s, [&](std::size_t w, const Drive& drive) {
    DriveState& at = s.drives[w];
    at.rate_before = 0;
    if (!is_on(s.scene.source().walls[w].motion, middle)) return;
    const double rate = rate_ahead(drive, at, gravity, dt), to = at.way + dt * rate;
    const double most = drive.guide.turns ? std::min(kTurnPerStep, kMaxWay * s.facts.smallest_radius / s.scene.lever(w))
                                          : kMaxWay * s.facts.smallest_radius;
    if (!(dt * std::abs(rate) <= most)) {
      throw RunInvalid(
          "step {}: wall '{}' goes {:.3g} {} in a step of {:.3g} s, more than {:.3g}, where it could pass through bodies unseen; "
          "use a step of at most {:.3g} s, or give it less to go by (max_rate, damping, inertia)",
          s.clock.step, s.scene.source().walls[w].name, dt * std::abs(rate), drive.guide.turns ? "rad" : "m", dt, most,
          0.5 * most / std::abs(rate));
    }
    const double end = std::clamp(to, drive.lowest, drive.highest);
    at.rate_before = end == to ? rate : (end - at.way) / dt;
    at.way = end;
  });
}

/// Of one contact of a wall, along the way that the wall can go.
struct Resistance {
  double force = 0, stiffness = 0, impedance = 0;
  double yield = 0;  ///< stiffness times the rate at which the body gives way
};

/// in   normal    stiffness of the contact [N/m]    in   tangential   the same across its normal; 0 without friction
Resistance resistance_of(const RunState& s, const Guide& guide, const PairResult& r, std::size_t body, double normal, double tangential) {
  const ParticleSet& p = s.particles;
  Resistance of;
  of.force = guide.component(-r.force_a, cross(p.x[body], -r.force_a) - r.torque_a);
  // without friction and damping, a contact pushes along its normal
  const Vec3 push = r.dissipative_force_a - r.force_a;
  const double size = length(push);
  if (!(size > 0)) return of;
  const Vec3 n = (1 / size) * push, arm = p.radius[body] * n;
  const Vec3 way = guide.turns ? cross(guide.axis, p.x[body] + arm - guide.centre) : guide.axis;
  const Vec3 velocity = p.v[body] + cross(p.w[body], arm), across = way - dot(way, n) * n;
  of.stiffness = normal * dot(way, n) * dot(way, n) + tangential * squared_length(across);
  of.impedance = std::numbers::pi * std::sqrt(p.mass[body] / normal) * of.stiffness;
  of.yield = normal * dot(way, n) * dot(velocity, n) + tangential * dot(across, velocity);
  return of;
}

/// Sums what contacts do to them. Collective.
void sum_drive_forces(RunState& s) {
  enum { force, stiffness, impedance, yield, count };
  const Settings& settings = s.scene.source().settings;
  const double cluster = settings.gather == Gathering::area ? 1 : s.scene.extent_of_rough_pair(s.scene.extremes());
  std::vector<ExactSum> sums(count * s.drives.size());
  PairResult of_block;
  for (const std::int32_t k : s.pairs.with_walls()) {
    const PairResult& r = s.pairs.result_of(k, of_block);
    if (!r.active) continue;
    const BodyPair& pair = s.pairs.stored_pairs()[static_cast<std::size_t>(k)];
    const auto w = static_cast<std::size_t>(s.scene.zones()[static_cast<std::size_t>(pair.key.zone)].wall);
    const Drive* drive = s.scene.drive(w);
    if (drive == nullptr) continue;
    const auto body = static_cast<std::size_t>(pair.a);
    const PairLaw& law = s.scene.law(s.particles.material[body], s.scene.source().walls[w].material);
    // the stiffest that is expected of the pair; of a layer, whose area is not known, from what it holds
    double normal = cluster * law.step_stiffness;
    if (settings.gather == Gathering::area)
      normal = r.elastic > 0 ? squared_length(r.force_a - r.dissipative_force_a) / (2 * r.elastic) : 0;
    if (!(normal > 0)) continue;
    const Resistance of = resistance_of(s, drive->guide, r, body, normal, law.friction > 0 ? law.tangential_ratio * normal : 0);
    sums[count * w + force].add(of.force);
    sums[count * w + stiffness].add(of.stiffness);
    sums[count * w + impedance].add(of.impedance);
    sums[count * w + yield].add(of.yield);
  }
  add_over_ranks(s.comm.get(), sums);
  for_each_drive(s, [&](std::size_t w, const Drive&) {
    DriveState& at = s.drives[w];
    at.force = sums[count * w + force].value();
    at.stiffness = sums[count * w + stiffness].value();
    at.impedance = sums[count * w + impedance].value();
    at.yield = at.stiffness > 0 ? sums[count * w + yield].value() / at.stiffness : 0;
  });
}

/// After the forces of a step: sums them, and sets the rates of the present moment, of `s.walls` too. Collective.
/// Throws RunInvalid on every rank for a part that is too light for the contacts that it has, at this step.
void kick_drives(RunState& s) {
  sum_drive_forces(s);
  const double dt = s.clock.dt, time = s.clock.time();
  const Vec3 gravity = s.scene.source().settings.gravity;
  for_each_drive(s, [&](std::size_t w, const Drive& drive) {
    const Wall& wall = s.scene.source().walls[w];
    DriveState& at = s.drives[w];
    const bool is_at_end = at.way == drive.lowest || at.way == drive.highest;
    if (!is_on(wall.motion, time - 0.5 * dt)) {
      at.rate = 0;
    } else if (drive.inertia > 0) {
      const double phase = dt * std::sqrt(at.stiffness / drive.inertia);
      if (!(phase <= kMaxPhasePerStep)) {
        throw RunInvalid(
            "step {}: wall '{}' is too light for its contacts: together they push it to and fro within {:.3g} steps of {:.3g} s; give it "
            "more mass, or use a step of at most {:.3g} s",
            s.clock.step, wall.name, 2 * std::numbers::pi / phase, dt, 0.5 * kMaxPhasePerStep * dt / phase);
      }
      const double rate = (at.rate_before + 0.5 * dt * acceleration(drive, at, gravity)) / (1 + damping_share(drive, dt));
      at.rate = is_at_end ? 0 : std::clamp(rate, -drive.most_rate, drive.most_rate);
    } else {
      const double ahead = is_on(wall.motion, time + 0.5 * dt) ? rate_ahead(drive, at, gravity, dt) : 0;
      const bool stays = (at.way == drive.highest && ahead > 0) || (at.way == drive.lowest && ahead < 0);
      at.rate = 0.5 * (at.rate_before + (stays ? 0 : ahead));
    }
    s.walls[w] = wall_state(wall, time, dt, &at);
  });
}

struct DriveColumn {
  ArrayFormat format;
  double DriveState::*field;
};
constexpr DriveColumn kColumns[] = {{{"way", ""}, &DriveState::way},
                                    {{"rate", ""}, &DriveState::rate},
                                    {{"rate_before", ""}, &DriveState::rate_before},
                                    {{"force", ""}, &DriveState::force},
                                    {{"stiffness", ""}, &DriveState::stiffness},
                                    {{"impedance", ""}, &DriveState::impedance},
                                    {{"yield", ""}, &DriveState::yield},
                                    {{"asked", "", 1, true, true}, &DriveState::asked}};

class Drives : public Effect {
 public:
  void start(RunState& s) override { sum_drive_forces(s); }
  void drift(RunState& s) override { move_drives(s); }
  void after_kick(RunState& s) override { kick_drives(s); }

  EffectRecord record(const RunState& s) const override {
    EffectRecord record;
    for (const DriveColumn& column : kColumns) {
      StateArray& array = record.emplace_back();
      for (const DriveState& at : s.drives) array.reals.push_back(at.*column.field);
    }
    return record;
  }
  void restore(RunState& s, const EffectRecord& record) override {
    for (std::size_t c = 0; c < std::size(kColumns); ++c) {
      if (kColumns[c].format.is_later && record[c].reals.empty()) continue;
      if (record[c].reals.size() != s.drives.size())
        throw InputError("{} walls that answer to force instead of {}; the file is damaged or of another scene", record[c].reals.size(),
                         s.drives.size());
      for (std::size_t w = 0; w < s.drives.size(); ++w) s.drives[w].*kColumns[c].field = record[c].reals[w];
    }
  }
  /// The forces follow from bodies and pairs.
  std::vector<ItemHash> hashes(const RunState& s) const override {
    std::vector<ItemHash> items;
    for (const DriveState& at : s.drives) {
      ItemHash& h = items.emplace_back();
      for (const double value : {at.way, at.rate, at.rate_before}) h.add(value);
    }
    return items;
  }
};

}  // namespace

EffectKind drives_effect() {
  EffectFormat format{"drives", "the way, rate or force of a wall that answers to force differs", {}};
  for (const DriveColumn& column : kColumns) format.arrays.push_back(column.format);
  return {format, {}, [](const RunState& s) -> std::unique_ptr<Effect> {
            if (!s.scene.has_answering_walls()) return nullptr;
            return std::make_unique<Drives>();
          }};
}

}  // namespace scree
