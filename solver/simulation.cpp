#include "solver/simulation.hpp"

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstring>

#include "solver/motion.hpp"

namespace scree {

namespace {

volatile std::sig_atomic_t g_signal = 0;

extern "C" void note_signal(int number) { g_signal = number; }

/// Adds the time of its scope to a phase.
class Timer {
 public:
  Timer(PhaseTimes& times, Phase phase) : slot_(times[static_cast<std::size_t>(phase)]), start_(Clock::now()) {}
  ~Timer() { slot_ += std::chrono::duration<double>(Clock::now() - start_).count(); }
  Timer(const Timer&) = delete;
  Timer& operator=(const Timer&) = delete;

 private:
  using Clock = std::chrono::steady_clock;
  double& slot_;
  Clock::time_point start_;
};

// Body lists last about this many steps at the speed of the fastest body; a longer skin means fewer renewals but
// more pairs. It never changes a result.
constexpr double kListSteps = 40;
constexpr double kSmallestListSkin = 0.02, kLargestListSkin = 0.5;  // of the smallest radius
// A cut costs about as much as tens of steps: not more often than this, and only for a real gain.
constexpr std::int64_t kStepsBetweenCuts = 500;
constexpr double kCutThreshold = 1.10;

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

const char* phase_name(Phase phase) {
  switch (phase) {
    case Phase::search: return "search";
    case Phase::distance: return "contact";
    case Phase::integrate: return "integrate";
    case Phase::halo: return "halo";
    case Phase::migrate: return "migrate";
    case Phase::output: return "output";
    case Phase::count: break;
  }
  return "unknown";
}

void catch_signals() {
  for (const int number : {SIGINT, SIGTERM, SIGUSR1}) std::signal(number, note_signal);
}

Simulation::Simulation(const mpi::Communicator& comm, const SolverScene& scene, HaloStrategy strategy)
    : comm_(comm), scene_(scene), strategy_(strategy) {
  const Partition& partition = scene.source().partition;
  CutBoxes regions;
  if (partition.ranks == comm.size()) regions = {partition.lower, partition.upper};
  halo_ = std::make_unique<Halo>(comm, std::move(regions));
  const std::size_t walls = scene.source().walls.size();
  wall_force_.resize(walls);
  wall_torque_.resize(walls);
  wall_impulse_.resize(walls);
}

void Simulation::start_from_scene() {
  const BodyTable& bodies = scene_.source().bodies;
  // without regions the bodies are dealt out in equal runs; the first renewal cuts and sends them home
  const auto ranks = static_cast<std::size_t>(comm_.size()), me = static_cast<std::size_t>(comm_.rank());
  std::vector<ParticleRecord> mine;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const bool own = halo_->has_regions() ? halo_->regions().rank_of(bodies.position[b]) == comm_.rank()
                                          : b * ranks / bodies.size() == me;
    if (own) mine.push_back(initial_record(scene_, b));
  }
  start_from_records(mine, {}, 0, 0, 0, {});
}

void Simulation::start_from_records(const std::vector<ParticleRecord>& records, std::vector<PendingSprings> springs,
                                    std::int64_t step, double wall_work, double wall_dissipated,
                                    const std::vector<Vec3>& wall_impulse) {
  for (const ParticleRecord& r : records) append_record(p_, r, scene_);
  p_.owned = p_.size();
  pairs_.pending() = std::move(springs);
  step_ = step;
  if (comm_.rank() == 0) {
    wall_work_ = wall_work;
    wall_dissipated_ = wall_dissipated;
    if (wall_impulse.size() == wall_impulse_.size()) wall_impulse_ = wall_impulse;
  }
  step_size_ = derive_step_size(comm_, scene_, p_);
  set_walls(time());
  if (!halo_->has_regions() || comm_.size() > 1) halo_->rebalance(p_);
  renew_lists();
  last_cut_step_ = step_;
  // The forces of a checkpoint are those of its last step; only a fresh start computes them, with springs at rest.
  if (step == 0) compute_forces(0, false);
  agree_on_failures();
}

void Simulation::set_walls(double time) {
  walls_.clear();
  for (const Wall& wall : scene_.source().walls) walls_.push_back(wall_state(wall, time));
}

bool Simulation::lists_used_up() const {
  double limit = 0.5 * skin_;
  double walls_moved = 0;
  if (scene_.has_driven_walls()) {
    double farthest = 0;
    for (std::size_t i = 0; i < p_.owned; ++i) {
      for (const WallState& w : walls_) farthest = std::max(farthest, length(p_.x[i] - w.position) + p_.radius[i]);
    }
    for (std::size_t k = 0; k < walls_.size(); ++k) {
      const Quat turn = conjugate(walls_listed_[k].orientation) * walls_[k].orientation;
      const double chord = 2 * std::sqrt(turn.x * turn.x + turn.y * turn.y + turn.z * turn.z);
      walls_moved = std::max(walls_moved, length(walls_[k].position - walls_listed_[k].position) + chord * farthest);
    }
  }
  if (walls_moved > limit) return true;
  bool used = false;
  const auto count = static_cast<std::ptrdiff_t>(p_.owned);
#pragma omp parallel for schedule(static) reduction(|| : used)
  for (std::ptrdiff_t n = 0; n < count; ++n) {
    const auto i = static_cast<std::size_t>(n);
    // written so that a NaN position counts as used up, and is then found by the guard
    if (!(squared_length(p_.x[i] - p_.x_listed[i]) <= limit * limit)) used = true;
  }
  return used;
}

void Simulation::check_domain() {
  const Domain& domain = scene_.source().settings.domain;
  for (std::size_t i = 0; i < p_.owned; ++i) {
    if (!is_finite(p_.x[i]) || !is_finite(p_.v[i]) || !is_finite(p_.L[i])) {
      throw RunInvalid("step {}: the state of body {} is not a finite number; the step is too large or the contact too stiff",
                       step_, p_.id[i]);
    }
    if (!domain.bounded || domain.outside != "stop") continue;
    const Vec3& x = p_.x[i];
    if (x.x < domain.lower.x || x.y < domain.lower.y || x.z < domain.lower.z || x.x > domain.upper.x ||
        x.y > domain.upper.y || x.z > domain.upper.z) {
      throw RunInvalid("step {}: body {} left the domain at ({:g}, {:g}, {:g}) m; widen domain or set outside = \"keep\"",
                       step_, p_.id[i], x.x, x.y, x.z);
    }
  }
}

void Simulation::renew_lists() {
  {
    Timer timer(times_, Phase::migrate);
    std::unique_ptr<Error> error = std::move(failure_);
    try {
      if (!error) check_domain();
    } catch (const Error& e) {
      error = std::make_unique<Error>(e);
    }
    mpi::agree(comm_, error.get());
    if (comm_.size() > 1) {
      // measured work of a body: what its pairs keep and look at
      std::fill(p_.work.begin(), p_.work.end(), 1.0);
      for (const BodyPair& pair : pairs_.pairs()) {
        const double work = 0.5 + 0.02 * static_cast<double>(pair.lists.corners_a.size() + pair.lists.corners_b.size() +
                                                             2 * pair.lists.edges.size());
        p_.work[static_cast<std::size_t>(pair.a)] += work;
        if (pair.b >= 0) p_.work[static_cast<std::size_t>(pair.b)] += work;
      }
      double mine = 0;
      for (std::size_t i = 0; i < p_.owned; ++i) mine += p_.work[i];
      const double mean = comm_.sum(mine) / comm_.size();
      const double largest = comm_.max(mine);
      const bool due = step_ - last_cut_step_ >= kStepsBetweenCuts && largest > kCutThreshold * mean;
      if (due) {
        halo_->rebalance(p_);
        last_cut_step_ = step_;
        ++cuts_;
      }
    }
    migrated_ += halo_->migrate(scene_, p_, pairs_);
    double fastest = 0, smallest = 1e300;
    for (std::size_t i = 0; i < p_.owned; ++i) {
      fastest = std::max(fastest, length(p_.v[i]));
      smallest = std::min(smallest, p_.radius[i]);
    }
    for (const WallState& w : walls_) fastest = std::max(fastest, length(w.velocity));
    fastest = comm_.max(fastest);
    smallest = -comm_.max(-smallest);
    skin_ = std::clamp(2 * kListSteps * fastest * step_size_.step, kSmallestListSkin * smallest, kLargestListSkin * smallest);
    halo_->make_ghosts(scene_, p_, skin_);
  }
  Timer timer(times_, Phase::search);
  pairs_.rebuild(scene_, p_, walls_, skin_);
  wall_pairs_.clear();
  for (std::size_t k = 0; k < pairs_.pairs().size(); ++k) {
    if (pairs_.pairs()[k].key.zone >= 0) wall_pairs_.push_back(static_cast<std::int32_t>(k));
  }
  std::copy(p_.x.begin(), p_.x.end(), p_.x_listed.begin());
  walls_listed_ = walls_;
  ++renewals_;
}

void Simulation::compute_forces(double dt, bool refresh) {
  if (refresh) {
    Timer timer(times_, Phase::halo);
    halo_->start_refresh(p_);
    if (strategy_ == HaloStrategy::blocking) halo_->finish_refresh(p_);
  }
  const auto start = std::chrono::steady_clock::now();
  try {
    Timer timer(times_, Phase::distance);
    evaluate_pairs(scene_, p_, walls_, pairs_.inner(), dt, step_, scratch_, pairs_);
  } catch (const Error& e) {
    failure_ = std::make_unique<Error>(e);
  }
  compute_time_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (refresh && strategy_ == HaloStrategy::overlap) {
    Timer timer(times_, Phase::halo);
    halo_->finish_refresh(p_);
  }
  const auto resume = std::chrono::steady_clock::now();
  try {
    Timer timer(times_, Phase::distance);
    if (!failure_) evaluate_pairs(scene_, p_, walls_, pairs_.outer(), dt, step_, scratch_, pairs_);
  } catch (const Error& e) {
    failure_ = std::make_unique<Error>(e);
  }
  Timer timer(times_, Phase::integrate);
  pairs_.gather(scene_.source().settings.gravity, p_);
  compute_time_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - resume).count();
  for (const PairResult& r : pairs_.results()) {
    if (r.active) max_depth_ratio_ = std::max(max_depth_ratio_, r.depth_ratio);
  }
}

void Simulation::add_wall_impulse(double dt) {
  std::fill(wall_force_.begin(), wall_force_.end(), Vec3{});
  std::fill(wall_torque_.begin(), wall_torque_.end(), Vec3{});
  for (const std::int32_t k : wall_pairs_) {
    const PairResult& r = pairs_.results()[static_cast<std::size_t>(k)];
    if (!r.active) continue;
    const BodyPair& pair = pairs_.pairs()[static_cast<std::size_t>(k)];
    const auto w = static_cast<std::size_t>(scene_.zones()[static_cast<std::size_t>(pair.key.zone)].wall);
    const Vec3 on_wall = -r.force_a;
    // torque on A about its centre turns into minus torque on the wall about any point, plus the lever
    const Vec3 torque_origin = cross(p_.x[static_cast<std::size_t>(pair.a)], on_wall) - r.torque_a;
    wall_force_[w] += on_wall;
    wall_torque_[w] += torque_origin;
    wall_impulse_[w] += dt * on_wall;
    const WallState& state = walls_[w];
    const Vec3 torque_wall = torque_origin - cross(state.position, on_wall);
    wall_work_ -= dt * (dot(on_wall, state.velocity) + dot(torque_wall, state.angular_velocity));
    // Damping and friction take force times sliding velocity: the bodies' part is counted with them, this is the walls'.
    const Vec3 lossy = -r.lossy_force_a;
    const Vec3 lossy_torque = cross(p_.x[static_cast<std::size_t>(pair.a)] - state.position, lossy) - r.lossy_torque_a;
    wall_dissipated_ -= dt * (dot(lossy, state.velocity) + dot(lossy_torque, state.angular_velocity));
  }
}

void Simulation::advance() {
  const double dt = step_size_.step;
  {
    Timer timer(times_, Phase::integrate);
    add_wall_impulse(0.5 * dt);  // by the forces of the last step, in this step's first kick
    kick(p_, 0.5 * dt);
    drift(p_, dt);
    ++step_;
    if (scene_.has_driven_walls()) set_walls(time());
  }
  int flags[3] = {lists_used_up() ? 1 : 0, static_cast<int>(g_signal), failure_ ? 1 : 0};
  if (comm_.size() > 1) {
    Timer timer(times_, Phase::halo);
    MPI_Allreduce(MPI_IN_PLACE, flags, 3, MPI_INT, MPI_MAX, comm_.get());
  }
  signal_ = flags[1];
  if (flags[2] != 0) agree_on_failures();
  if (flags[0] != 0) renew_lists();
  compute_forces(dt, flags[0] == 0);
  Timer timer(times_, Phase::integrate);
  kick(p_, 0.5 * dt);
  add_wall_impulse(0.5 * dt);
  // The force of step n acts over a whole step around it, with the mean velocity of that step: that of the full step.
  for (std::size_t i = 0; i < p_.owned; ++i) {
    if (p_.fixed[i]) continue;
    p_.dissipated[i] -= dt * (dot(p_.lossy_force[i], p_.v[i]) + dot(p_.lossy_torque[i], p_.w[i]));
  }
}

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
  const double mean = comm_.sum(compute_time_) / comm_.size(), largest = comm_.max(compute_time_);
  compute_time_ = 0;
  return mean > 0 ? largest / mean : 1;
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
  evaluate_pairs(scene_, p_, walls_, pairs_.inner(), 0, step_, scratch_, pairs_, &out);
  evaluate_pairs(scene_, p_, walls_, pairs_.outer(), 0, step_, scratch_, pairs_, &out);
  return out;
}

}  // namespace scree
