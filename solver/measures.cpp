// What a simulation tells of itself: energies, loads, counts, the hash of its state. Every function is collective.
#include <sys/resource.h>

#include <algorithm>
#include <cstring>

#include "solver/motion.hpp"
#include "solver/simulation.hpp"

namespace scree {

namespace {

std::uint64_t mix(std::uint64_t h) {  // splitmix64: every input bit reaches every output bit
  h += 0x9E3779B97F4A7C15ull;
  h = (h ^ (h >> 30)) * 0xBF58476D1CE4E5B9ull;
  h = (h ^ (h >> 27)) * 0x94D049BB133111EBull;
  return h ^ (h >> 31);
}

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
  void add(const Vec3& v) {
    add(v.x);
    add(v.y);
    add(v.z);
  }
};

}  // namespace

Energies Simulation::energies() const {
  double e[7] = {};
  const Vec3& g = scene_.source().settings.gravity;
  for (std::size_t i = 0; i < p_.owned; ++i) {
    e[0] += translational_energy(p_, i);
    e[1] += rotational_energy(p_, i);
    if (!p_.fixed[i]) e[2] -= p_.mass[i] * dot(g, p_.x[i]);
    e[5] += p_.dissipated[i];
  }
  for (std::size_t k = 0; k < pairs_.pairs().size(); ++k) {
    const PairResult& r = pairs_.results()[k];
    if (!r.active || !counts_here(pairs_.pairs()[k], p_)) continue;
    e[3] += r.elastic;
    e[4] += r.tangential_elastic;
  }
  e[5] += wall_dissipated_;
  e[6] = wall_work_;
  MPI_Allreduce(MPI_IN_PLACE, e, 7, MPI_DOUBLE, MPI_SUM, comm_.get());
  // What friction took out of the motion is in part stored in its springs: that part is not lost.
  return {e[0], e[1], e[2], e[3], e[4], e[5] - e[4], e[6]};
}

std::vector<WallLoad> Simulation::wall_loads() const {
  std::vector<WallLoad> loads(wall_force_.size());
  for (std::size_t w = 0; w < loads.size(); ++w) loads[w] = {wall_force_[w], wall_torque_[w], wall_impulse_[w]};
  static_assert(sizeof(WallLoad) == 9 * sizeof(double));
  if (!loads.empty()) {
    MPI_Allreduce(MPI_IN_PLACE, loads.data(), static_cast<int>(9 * loads.size()), MPI_DOUBLE, MPI_SUM, comm_.get());
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

double Simulation::take_max_depth_ratio() {
  const double result = comm_.max(max_depth_ratio_);
  max_depth_ratio_ = 0;
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
  m.renewal_bytes = halo_->traffic().renewal_bytes;
  m.migrated = migrated_;
  const std::size_t row = p_.row_bytes();
  std::size_t own_pairs = 0, ghost_pairs = 0;
  for (const BodyPair& pair : pairs_.pairs()) {
    const bool with_ghost = static_cast<std::size_t>(pair.a) >= p_.owned || (pair.b >= 0 && static_cast<std::size_t>(pair.b) >= p_.owned);
    (with_ghost ? ghost_pairs : own_pairs) += memory_of(pair);
  }
  m.body_bytes = static_cast<std::int64_t>(p_.owned * row + own_pairs);
  m.ghost_bytes = static_cast<std::int64_t>(p_.ghost_count() * (row + 2 * sizeof(GhostState)) + ghost_pairs);  // sent there, received here
  for (std::size_t k = 0; k < pairs_.pairs().size(); ++k) {
    if (counts_here(pairs_.pairs()[k], p_) && pairs_.results()[k].active) m.contacts += pairs_.results()[k].contact_count;
  }
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  m.peak_rss = static_cast<std::int64_t>(usage.ru_maxrss) * 1024;
  return m;
}

std::int64_t Simulation::bodies_outside() const {
  const Domain& d = scene_.source().settings.domain;
  std::int64_t count = 0;
  for (std::size_t i = 0; d.bounded && i < p_.owned; ++i) {
    const Vec3& x = p_.x[i];
    if (x.x < d.lower.x || x.y < d.lower.y || x.z < d.lower.z || x.x > d.upper.x || x.y > d.upper.y || x.z > d.upper.z) ++count;
  }
  return comm_.sum(count);
}

std::string Simulation::state_hash() const {
  std::uint64_t sums[2] = {0, 0};
  const auto add = [&](const ItemHash& h) {
    sums[0] += h.a;  // a sum modulo 2^64 of item hashes: no order of bodies or ranks enters
    sums[1] += h.b;
  };
  for (std::size_t i = 0; i < p_.owned; ++i) {
    ItemHash h;
    h.add(static_cast<std::uint64_t>(p_.id[i]));
    h.add(p_.x[i]);
    h.add(p_.q[i].w);
    h.add(Vec3{p_.q[i].x, p_.q[i].y, p_.q[i].z});
    h.add(p_.v[i]);
    h.add(p_.L[i]);
    add(h);
  }
  for (const BodyPair& pair : pairs_.pairs()) {
    if (!counts_here(pair, p_)) continue;
    for (const FrictionSpring& s : pair.springs) {
      ItemHash h;
      h.add(static_cast<std::uint64_t>(pair.key.a));
      h.add(static_cast<std::uint64_t>(pair.key.b));
      h.add(static_cast<std::uint64_t>(pair.key.zone));
      h.add(static_cast<std::uint64_t>(s.key));
      h.add(s.force);
      h.add(s.stiffness);
      add(h);
    }
  }
  MPI_Allreduce(MPI_IN_PLACE, sums, 2, MPI_UINT64_T, MPI_SUM, comm_.get());
  return fmt::format("{:016x}{:016x}", sums[0], sums[1]);
}

FrameContacts Simulation::contacts() {
  FrameContacts out;
  evaluate_pairs(scene_, p_, walls_, pairs_.inner(), step_size_.step, 0, step_, scratch_, pairs_, &out);
  evaluate_pairs(scene_, p_, walls_, pairs_.outer(), step_size_.step, 0, step_, scratch_, pairs_, &out);
  return out;
}

}  // namespace scree
