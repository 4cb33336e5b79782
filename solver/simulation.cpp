#include "solver/simulation.hpp"

#include <algorithm>
#include <chrono>
#include <csignal>

namespace scree {

namespace {

volatile std::sig_atomic_t g_signal = 0;

extern "C" void note_signal(int number) { g_signal = number; }

}  // namespace

void catch_signals() {
  for (const int number : {SIGINT, SIGTERM, SIGUSR1}) std::signal(number, note_signal);
}

Simulation::Simulation(const mpi::Communicator& comm, const SolverScene& scene, HaloStrategy strategy)
    : comm_(comm), scene_(scene), strategy_(strategy), integrator_(integrator_of(scene.source().settings.integrator)) {
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

void Simulation::compute_forces(double friction_dt, bool refresh) {
  if (refresh) {
    PhaseTimer timer(times_, Phase::halo);
    halo_->start_refresh(p_);
    if (strategy_ == HaloStrategy::blocking) halo_->finish_refresh(p_);
  }
  const auto start = std::chrono::steady_clock::now();
  try {
    PhaseTimer timer(times_, Phase::distance);
    evaluate_pairs(scene_, p_, walls_, pairs_.inner(), step_size_.step, friction_dt, step_, scratch_, pairs_);
  } catch (const Error& e) {
    failure_ = std::make_unique<Error>(e);
  }
  compute_time_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (refresh && strategy_ == HaloStrategy::overlap) {
    PhaseTimer timer(times_, Phase::halo);
    halo_->finish_refresh(p_);
  }
  const auto resume = std::chrono::steady_clock::now();
  try {
    PhaseTimer timer(times_, Phase::distance);
    if (!failure_) evaluate_pairs(scene_, p_, walls_, pairs_.outer(), step_size_.step, friction_dt, step_, scratch_, pairs_);
  } catch (const Error& e) {
    failure_ = std::make_unique<Error>(e);
  }
  PhaseTimer timer(times_, Phase::integrate);
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
    PhaseTimer timer(times_, Phase::integrate);
    add_wall_impulse(0.5 * dt);  // by the forces of the last step, in this step's first kick
    begin_step(integrator_, p_, dt);
    ++step_;
    if (scene_.has_driven_walls()) set_walls(time());
  }
  int flags[3] = {lists_used_up() ? 1 : 0, static_cast<int>(g_signal), failure_ ? 1 : 0};
  if (comm_.size() > 1) {
    PhaseTimer timer(times_, Phase::halo);
    MPI_Allreduce(MPI_IN_PLACE, flags, 3, MPI_INT, MPI_MAX, comm_.get());
  }
  signal_ = flags[1];
  if (flags[2] != 0) agree_on_failures();
  if (flags[0] != 0) renew_lists();
  compute_forces(dt, flags[0] == 0);
  PhaseTimer timer(times_, Phase::integrate);
  end_step(integrator_, p_, dt);
  add_wall_impulse(0.5 * dt);
  // The force of step n acts over a whole step around it, with the mean velocity of that step: that of the full step.
  for (std::size_t i = 0; i < p_.owned; ++i) {
    if (p_.fixed[i]) continue;
    p_.dissipated[i] -= dt * (dot(p_.lossy_force[i], p_.v[i]) + dot(p_.lossy_torque[i], p_.w[i]));
  }
}

}  // namespace scree
