#include "solver/effects/sleep/sleep.hpp"

#include <algorithm>
#include <cmath>
#include <unordered_set>

#include <fmt/format.h>

#include "core/base/index.hpp"
#include "solver/effects/sleep/sleep_loads.hpp"
#include "solver/state/run_state.hpp"

namespace scree {

namespace {

bool sleeps(const ParticleSet& p, std::int32_t row) { return p.rest[at(row)] == kAsleep; }

bool is_zero(const Vec3& v) { return v.x == 0 && v.y == 0 && v.z == 0; }

/// A wall on which no body sleeps, at the present time. By its velocities, which are 0 once it has stopped: places may round.
bool is_restless(const RunState& s, std::size_t w) {
  const Wall& wall = s.scene.source().walls[w];
  const WallState& state = s.walls[w];
  if (sleep_blocker(wall) != nullptr) return true;
  for (const Vec3* v : {&state.velocity, &state.angular_velocity, &state.velocity_before, &state.angular_velocity_before,
                        &state.surface.velocity, &state.surface.spin, &state.surface_before.velocity, &state.surface_before.spin}) {
    if (!is_zero(*v)) return true;
  }
  return false;
}

}  // namespace

double weight_of(const RunState& s, std::size_t body) {
  const double mass = s.fluid ? std::abs(s.fluid->weighed_mass(s.particles, body)) : s.particles.mass[body];
  return mass * length(s.scene.source().settings.gravity);
}

void Sleep::on_rebuild(const StepParts& parts) {
  RunState& s = parts.state;
  kind_.assign(s.pairs.pairs().size(), Kind::unknown);
  dirty_ = true;
  find_awake_rows(s);
}

void Sleep::find_awake_rows(RunState& s) {
  ParticleSet& p = s.particles;
  p.may_sleep = true;
  p.awake.clear();
  for (std::size_t i = 0; i < p.owned; ++i) {
    if (p.rest[i] == kAsleep) continue;
    if (p.awake.empty() || p.awake.back().end != i) p.awake.push_back({i, i});
    p.awake.back().end = i + 1;
  }
}

/// Returns whether one has begun or ceased to be so.
bool Sleep::find_restless_walls(const RunState& s) {
  if (!restless_.empty() && !s.scene.has_driven_walls() && !s.scene.has_moving_surfaces()) return false;
  std::vector<std::uint8_t> now;
  for (std::size_t w = 0; w < s.walls.size(); ++w) now.push_back(is_restless(s, w) ? 1 : 0);
  const bool changed = now != restless_;
  restless_ = std::move(now);
  return changed;
}

Sleep::Kind Sleep::kind_of_pair(const RunState& s, std::size_t k) const {
  const ParticleSet& p = s.particles;
  const IdlePair& pair = s.pairs.idle()[k];
  const bool a_sleeps = sleeps(p, pair.a);
  if (pair.b < 0) {
    if (!a_sleeps) return Kind::awake;
    const std::int32_t zone = s.pairs.pairs()[k].key.zone;
    return restless_[at(s.scene.zones()[at(zone)].wall)] != 0 ? Kind::border : Kind::resting;
  }
  const bool b_sleeps = sleeps(p, pair.b);
  if (!a_sleeps && !b_sleeps) return Kind::awake;
  const bool a_rests = a_sleeps || p.fixed[at(pair.a)] != 0, b_rests = b_sleeps || p.fixed[at(pair.b)] != 0;
  return a_rests && b_rests ? Kind::resting : Kind::border;
}

void Sleep::sort_pairs(RunState& s, ForceScratch& scratch, FirstFailure& failure) {
  if (find_restless_walls(s)) dirty_ = true;
  if (!dirty_) return;
  dirty_ = false;
  const ParticleSet& p = s.particles;
  any_ = std::find(p.rest.begin(), p.rest.end(), kAsleep) != p.rest.end();
  ghost_sleeps_.resize(p.ghost_count());
  for (std::size_t g = 0; g < ghost_sleeps_.size(); ++g) ghost_sleeps_[g] = p.rest[p.owned + g] == kAsleep ? 1 : 0;
  border_.clear();
  fresh_.clear();
  for (std::size_t k = 0; k < kind_.size(); ++k) {
    const Kind kind = any_ ? kind_of_pair(s, k) : Kind::awake;
    // both woke, the second of them in the step before
    if (kind == Kind::awake && kind_[k] != Kind::awake) s.pairs.pairs()[k].state.kept.clear();
    if (kind == Kind::resting && kind_[k] != Kind::resting) fresh_.push_back(static_cast<std::int32_t>(k));
    if (kind == Kind::border) border_.push_back(static_cast<std::int32_t>(k));
    // one of both has fallen asleep
    if (kind == Kind::border && kind_[k] == Kind::awake && s.pairs.results()[k].active)
      s.pairs.pairs()[k].state.kept = {{0, s.pairs.results()[k].force_a}};
    kind_[k] = kind;
  }
  const std::vector<std::int32_t>* const all[kLists] = {&s.pairs.inner(), &s.pairs.outer(), &s.pairs.duplicated()};
  for (std::size_t list = 0; any_ && list < kLists; ++list) {
    due_[list].clear();
    for (const std::int32_t k : *all[list]) {
      if (kind_[at(k)] != Kind::resting) due_[list].push_back(k);
    }
  }
  compute_resting(s, scratch, failure);
}

/// Results of pairs that are resting and have none; a contact that has no kept force yet begins to rest with this one.
void Sleep::compute_resting(RunState& s, ForceScratch& scratch, FirstFailure& failure) {
  if (fresh_.empty() || failure.exists()) return;
  failure.watch(s.clock.step, [&] {
    evaluate_at_rest(s.scene, s.particles, s.walls, fresh_, s.clock.dt, s.clock.step, scratch, s.pairs);
    for (const std::int32_t k : fresh_) {
      const PairResult& r = s.pairs.results()[at(k)];
      std::vector<KeptForce>& kept = s.pairs.pairs()[at(k)].state.kept;
      if (r.active && kept.empty()) kept.push_back({0, r.force_a});
    }
  });
}

void Sleep::update_ghosts(RunState& s, ForceScratch& scratch, FirstFailure& failure) {
  const ParticleSet& p = s.particles;
  for (std::size_t g = 0; g < ghost_sleeps_.size() && !dirty_; ++g) dirty_ = (ghost_sleeps_[g] != 0) != (p.rest[p.owned + g] == kAsleep);
  sort_pairs(s, scratch, failure);
}

void Sleep::wake_disturbed(RunState& s) {
  ParticleSet& p = s.particles;
  const double tolerance = s.scene.source().settings.sleep_tolerance;
  std::vector<std::size_t> disturbed, borders;
  for (const std::int32_t k : border_) {
    const PairResult& r = s.pairs.results()[at(k)];
    BodyPair& pair = s.pairs.pairs()[at(k)];
    const std::size_t body = at(sleeps(p, pair.a) ? pair.a : pair.b);
    std::vector<KeptForce>& kept = pair.state.kept;
    bool wakes = r.active;  // of a contact that begins
    if (!kept.empty()) {
      const Vec3 change = (r.active ? r.force_a : Vec3{}) - kept.front().force;
      wakes = pair.b < 0 || !(length(change) <= tolerance * weight_of(s, body));
      if (!r.active) kept.clear();
    }
    if (body >= p.owned) continue;
    if (wakes)
      disturbed.push_back(body);
    else
      borders.push_back(body);
  }
  // all changes since a body fell asleep together, of contacts that have ended too: its force and torque are those that it had then
  std::sort(borders.begin(), borders.end());
  borders.erase(std::unique(borders.begin(), borders.end()), borders.end());
  const std::vector<BodyLoad> loads = loads_on(s, borders);
  for (std::size_t n = 0; n < borders.size(); ++n) {
    const std::size_t body = borders[n];
    const double most = tolerance * weight_of(s, body);
    const bool turns = p.lock_rotation[body] == 0;
    if (!(length(loads[n].force - p.force[body]) <= most) ||
        (turns && !(length(loads[n].torque - p.torque[body]) <= most * p.equivalent_radius[body])))
      disturbed.push_back(body);
  }
  // each pair is judged by which bodies slept as the step began: else the order of pairs would enter
  wake_rows(s, disturbed);
}

void Sleep::wake_rows(RunState& s, const std::vector<std::size_t>& rows) {
  if (rows.empty()) return;
  for (const std::size_t row : rows) s.particles.rest[row] = 0;
  dirty_ = true;
  find_awake_rows(s);
}

std::vector<std::int64_t> Sleep::touching_those_that_leave(const RunState& s, const std::vector<std::uint8_t>& leaves) const {
  const ParticleSet& p = s.particles;
  const auto is_leaving = [&](std::int32_t row) { return row >= 0 && at(row) < p.owned && leaves[at(row)] != 0; };
  std::vector<std::int64_t> mine;
  for (const BodyPair& pair : s.pairs.pairs()) {
    if (pair.state.kept.empty() || pair.b < 0) continue;
    if (is_leaving(pair.a)) mine.push_back(pair.key.b);
    if (is_leaving(pair.b)) mine.push_back(pair.key.a);
  }
  return s.comm.of_all(mine);
}

void Sleep::wake(RunState& s, const std::vector<std::int64_t>& ids) {
  if (ids.empty()) return;
  const std::unordered_set<std::int64_t> known(ids.begin(), ids.end());
  for (std::size_t i = 0; i < s.particles.owned; ++i) {
    if (s.particles.rest[i] == kAsleep && known.contains(s.particles.id[i])) s.particles.rest[i] = 0;
  }
}

bool Sleep::after_step(const StepParts& parts) {
  if (parts.state.clock.step % kSleepSteps == 0) review(parts.state, parts.halo, parts.scratch, parts.failure);
  return false;
}

EffectRecord Sleep::record(const RunState& s) const { return {array_of(over_ranks(s.comm.get(), slept_))}; }

void Sleep::restore(RunState& s, const EffectRecord& record) {
  const ExactSum slept = sum_of(record.front());
  if (s.comm.rank() == 0) slept_ = slept;
}

void Sleep::add_energies(const RunState& s, Energies& energies) const { energies.slept = over_ranks(s.comm.get(), slept_).value(); }

void Sleep::add_log_columns(const RunState& s, const Energies& energies, std::vector<Column>& columns) const {
  const auto end = s.particles.rest.begin() + static_cast<std::ptrdiff_t>(s.particles.owned);
  const std::int64_t asleep = s.comm.sum(static_cast<std::int64_t>(std::count(s.particles.rest.begin(), end, kAsleep)));
  columns.push_back({"asleep", "-", fmt::format("{}", asleep)});
  columns.push_back({"slept", "J", exact(energies.slept)});
}

EffectKind sleep_effect() {
  return {
      {"", "the energy of bodies that fell asleep differs", {sum_format("slept")}}, {}, [](const RunState& s) -> std::unique_ptr<Effect> {
        const Settings& settings = s.scene.source().settings;
        if (!settings.sleep) return nullptr;
        const bool streams = settings.fluid && length(settings.fluid->velocity) > 0;
        if (!s.scene.source().bonds.empty() || settings.output_impacts || streams)
          throw UsageError("time.sleep does not go with bonds, output.impacts or a fluid that streams; leave out one of both");
        // without gravity nothing has a weight to compare a force with
        if (!(length(settings.gravity) > 0)) return nullptr;
        return std::make_unique<Sleep>();
      }};
}

}  // namespace scree
