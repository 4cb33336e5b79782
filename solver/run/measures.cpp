// What a simulation tells of itself: energies, loads, counts, the hash of its state. Every function is collective.
#include <omp.h>
#include <sys/resource.h>

#include <algorithm>
#include <concepts>
#include <cstring>

#include "core/storage/checksum.hpp"
#include "solver/bodies/motion.hpp"
#include "solver/built_with.hpp"
#include "solver/step/simulation.hpp"

namespace scree {

namespace {

struct ItemHash {
  std::uint64_t a = 1, b = 2;
  void add(std::uint64_t bits) {
    a = mix(a ^ bits);
    b = mix(b + bits);
  }
  void add(double value) {
    std::uint64_t bits = 0;
    std::memcpy(&bits, &value, sizeof bits);
    add(bits);
  }
  template <std::integral Value>
  void add(Value value) {
    add(static_cast<std::uint64_t>(value));
  }
  void add(const Vec3& v) {
    add(v.x);
    add(v.y);
    add(v.z);
  }
  void add(const Quat& q) {
    add(q.w);
    add(Vec3{q.x, q.y, q.z});
  }
};

}  // namespace

/// Adds what the present forces do to the walls in a time dt. The sums are exact, so that threads may add up parts of them.
void Simulation::add_wall_totals(double dt, std::vector<ExactSum>& sums) const {
  constexpr std::size_t kWorthAThread = 64;  // pairs, 45 us: starting a thread and adding its part takes some 5 us
  const std::size_t parts = std::clamp<std::size_t>(wall_pairs_.size() / kWorthAThread, 1, static_cast<std::size_t>(omp_get_max_threads()));
  const auto part = [&](std::size_t n) {
    const std::size_t begin = wall_pairs_.size() * n / parts, end = wall_pairs_.size() * (n + 1) / parts;
    return std::span(wall_pairs_).subspan(begin, end - begin);
  };
  std::vector<std::vector<ExactSum>> others(parts - 1, std::vector<ExactSum>(sums.size()));
#pragma omp parallel for schedule(static, 1) if (parts > 1)
  for (std::size_t n = 0; n < parts; ++n) add_wall_totals(part(n), dt, n == 0 ? sums : others[n - 1]);
  for (const auto& other : others) {
    for (std::size_t i = 0; i < sums.size(); ++i) sums[i].add(other[i]);
  }
}

void Simulation::add_wall_totals(std::span<const std::int32_t> pairs, double dt, std::vector<ExactSum>& sums) const {
  for (const std::int32_t k : pairs) {
    const PairResult& r = pairs_.results()[static_cast<std::size_t>(k)];
    if (!r.active) continue;
    const BodyPair& pair = pairs_.pairs()[static_cast<std::size_t>(k)];
    const auto w = static_cast<std::size_t>(scene_.zones()[static_cast<std::size_t>(pair.key.zone)].wall);
    const Vec3 on_wall = -r.force_a;
    ExactSum* impulse = &sums[RunTotals::kFirstImpulse + 3 * w];
    impulse[0].add(dt * on_wall.x);
    impulse[1].add(dt * on_wall.y);
    impulse[2].add(dt * on_wall.z);
    const WallState& state = walls_[w];
    // torque on A about its centre turns into minus torque on the wall about any point, plus the lever
    const Vec3 lever = p_.x[static_cast<std::size_t>(pair.a)] - state.position;
    const Vec3 torque_wall = cross(lever, on_wall) - r.torque_a;
    sums[RunTotals::kWallWork].add(-dt * (dot(on_wall, state.velocity) + dot(torque_wall, state.angular_velocity)));
    // Damping and friction take force times sliding velocity: the bodies' part is counted with them, this is the walls'.
    const Vec3 lossy = -r.dissipative_force_a;
    const Vec3 dissipative_torque = cross(lever, lossy) - r.dissipative_torque_a;
    sums[RunTotals::kWallDissipated].add(-dt * (dot(lossy, state.velocity) + dot(dissipative_torque, state.angular_velocity)));
  }
}

Energies Simulation::energies() const {
  enum { translational, rotational, potential, elastic, tangential, dissipated, wall_work, count };
  std::vector<ExactSum> e(count);
  for (std::size_t i = 0; i < p_.owned; ++i) {
    e[translational].add(translational_energy(p_, i));
    e[rotational].add(rotational_energy(p_, i));
    e[potential].add(potential_energy(i));
    e[dissipated].add(p_.dissipated[i]);
  }
  for (std::size_t k = 0; k < pairs_.pairs().size(); ++k) {
    const PairResult& r = pairs_.results()[k];
    if (!r.active || !counts_here(pairs_.pairs()[k], p_)) continue;
    e[elastic].add(r.elastic);
    e[tangential].add(r.tangential_elastic);
  }
  add_over_ranks(comm_.get(), e);
  std::vector<ExactSum> walls = sums_;
  add_wall_totals(-0.5 * dt_, walls);
  add_over_ranks(comm_.get(), walls);
  const double stored = e[tangential].value();
  // What friction took out of the motion is in part stored in its springs: that part is not lost.
  const double lost =
      e[dissipated].value() + walls[RunTotals::kWallDissipated].value() + walls[RunTotals::kRemovedDissipated].value() - stored;
  return {e[translational].value(),
          e[rotational].value(),
          e[potential].value(),
          e[elastic].value(),
          stored,
          lost,
          walls[RunTotals::kWallWork].value(),
          walls[RunTotals::kRemovedEnergy].value()};
}

RunTotals Simulation::totals() const {
  RunTotals totals{sums_, comm_.max(max_overlap_ratio_), level_};
  add_over_ranks(comm_.get(), totals.sums);
  return totals;
}

std::vector<WallLoad> Simulation::wall_loads() const {
  const std::size_t walls = scene_.source().walls.size();
  std::vector<ExactSum> now(6 * walls), since_start = sums_;
  for (const std::int32_t k : wall_pairs_) {
    const PairResult& r = pairs_.results()[static_cast<std::size_t>(k)];
    if (!r.active) continue;
    const BodyPair& pair = pairs_.pairs()[static_cast<std::size_t>(k)];
    const auto w = static_cast<std::size_t>(scene_.zones()[static_cast<std::size_t>(pair.key.zone)].wall);
    const Vec3 torque_origin = cross(p_.x[static_cast<std::size_t>(pair.a)], -r.force_a) - r.torque_a;
    const double parts[6] = {-r.force_a.x, -r.force_a.y, -r.force_a.z, torque_origin.x, torque_origin.y, torque_origin.z};
    for (std::size_t i = 0; i < 6; ++i) now[6 * w + i].add(parts[i]);
  }
  add_wall_totals(-0.5 * dt_, since_start);
  add_over_ranks(comm_.get(), now);
  add_over_ranks(comm_.get(), since_start);
  std::vector<WallLoad> loads(walls);
  const auto vector = [](const ExactSum* s) { return Vec3{s[0].value(), s[1].value(), s[2].value()}; };
  for (std::size_t w = 0; w < walls; ++w) {
    loads[w] = {vector(&now[6 * w]), vector(&now[6 * w + 3]), vector(&since_start[RunTotals::kFirstImpulse + 3 * w])};
  }
  return loads;
}

std::int64_t Simulation::contact_count() const {
  std::int64_t count = 0;
  for (std::size_t k = 0; k < pairs_.pairs().size(); ++k) {
    if (counts_here(pairs_.pairs()[k], p_)) count += pairs_.results()[k].active ? pairs_.results()[k].contact_count : 0;
  }
  return comm_.sum(count);
}

std::int64_t Simulation::active_pair_count() const {
  std::int64_t count = 0;
  for (std::size_t k = 0; k < pairs_.pairs().size(); ++k) {
    if (counts_here(pairs_.pairs()[k], p_) && pairs_.results()[k].active) ++count;
  }
  return comm_.sum(count);
}

double Simulation::take_max_overlap_ratio() {
  const double result = comm_.max(max_overlap_ratio_);
  max_overlap_ratio_ = 0;
  return result;
}

double Simulation::take_imbalance() {
  const double since = balance_.computing() - computed_before_;
  computed_before_ = balance_.computing();
  const double mean = comm_.sum(since) / comm_.size(), largest = comm_.max(since);
  return mean > 0 ? largest / mean : 1;
}

RankMeasures Simulation::rank_measures() const {
  RankMeasures m;
  m.times = times_;
  m.computing = balance_.computing();
  m.bodies = static_cast<std::int64_t>(p_.owned);
  m.ghosts = static_cast<std::int64_t>(p_.ghost_count());
  m.neighbours = static_cast<std::int64_t>(halo_->neighbour_count());
  m.messages = halo_->traffic().messages;
  m.bytes = halo_->traffic().bytes;
  m.rebuild_bytes = halo_->traffic().rebuild_bytes;
  m.migrated = migrated_;
  const std::size_t row = p_.row_bytes();
  std::size_t own_pairs = 0, ghost_pairs = 0;
  for (const BodyPair& pair : pairs_.pairs()) {
    const bool with_ghost = static_cast<std::size_t>(pair.a) >= p_.owned || (pair.b >= 0 && static_cast<std::size_t>(pair.b) >= p_.owned);
    (with_ghost ? ghost_pairs : own_pairs) += memory_of(pair);
  }
  m.body_bytes = static_cast<std::int64_t>(p_.owned * row + own_pairs);
  m.ghost_bytes = static_cast<std::int64_t>(p_.ghost_count() * (row + 2 * kGhostBytes) + ghost_pairs);  // sent there, received here
  for (std::size_t k = 0; k < pairs_.pairs().size(); ++k) {
    if (counts_here(pairs_.pairs()[k], p_) && pairs_.results()[k].active) m.contacts += pairs_.results()[k].contact_count;
  }
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  m.peak_rss = static_cast<std::int64_t>(usage.ru_maxrss) * 1024;
  return m;
}

std::int64_t Simulation::bodies_outside() const {
  std::int64_t count = 0;
  for (std::size_t i = 0; i < p_.owned; ++i) count += is_outside(p_.x[i]) ? 1 : 0;
  return comm_.sum(count);
}

std::string Simulation::state_hash() const {
  std::uint64_t sums[3] = {0, 0, p_.owned};
  const auto add = [&](const ItemHash& h) {
    sums[0] += h.a;  // a sum modulo 2^64 of item hashes: no order of bodies or ranks enters
    sums[1] += h.b;
  };
  for (std::size_t i = 0; i < p_.owned; ++i) {
    ItemHash h;
    for_each_body_column([&](const auto& c) {
      if (c.uses & kHashed) h.add((p_.*c.column)[i]);
    });
    add(h);
  }
  for (const BodyPair& pair : pairs_.pairs()) {
    if (!counts_here(pair, p_)) continue;
    for_each_kind(pair.state, [&](const auto& rows) {
      for (const auto& row : rows) {
        ItemHash h;
        h.add(pair.key.a);
        h.add(pair.key.b);
        h.add(static_cast<std::int64_t>(pair.key.zone));
        KindOf<decltype(rows)>::visit([&](const char*, const char*, auto field) { h.add(row.*field); });
        add(h);
      }
    });
  }
  MPI_Allreduce(MPI_IN_PLACE, sums, 3, MPI_UINT64_T, MPI_SUM, comm_.get());
  if (sums[2] == 0) {  // no body is a state too, and no hash of it would look like one that was never made
    ItemHash none;
    none.add(std::uint64_t{0});
    add(none);
  }
  return fmt::format("{:016x}{:016x}", sums[0], sums[1]);
}

FrameContacts Simulation::contacts() {
  // ghosts have the velocities that forces are computed with; their owners have been kicked since
  if (built_with::kRanks) {
    halo_->start_refresh(p_, times_);
    halo_->finish_refresh(p_, times_);
  }
  // Damping acts here with the velocities of the full step; what the step computed, with those that it had then, stays: loads of walls are
  // read from it.
  const std::vector<PairResult> kept = pairs_.results();
  FrameContacts out;
  evaluate_pairs(scene_, p_, walls_, pairs_.inner(), dt_, 0, step_, scratch_, pairs_, &out);
  evaluate_pairs(scene_, p_, walls_, pairs_.outer(), dt_, 0, step_, scratch_, pairs_, &out);
  pairs_.results() = kept;
  return out;
}

}  // namespace scree
