#include "solver/step/simulation.hpp"

#include "solver/built_with.hpp"

#include <algorithm>
#include <chrono>
#include <csignal>
#include <limits>

namespace scree {

namespace {

volatile std::sig_atomic_t g_signal = 0;

// Bodies may be this many steps outside before they are removed; the longest of it is a part of a contact's duration.
constexpr std::int64_t kReviewSteps = 16;
// The contacts are looked at this often, for a few percent of the time; only then may the step grow: after 128 quiet steps.
constexpr std::int64_t kContactReviewSteps = 128;

/// A study build refuses what was left out of it.
void check_built_with(const mpi::Communicator& comm, const SolverScene& scene) {
  const auto need = [](bool built, bool needed, const char* what) {
    if (!built && needed) throw UsageError("this build of the solver has no {}, which the scene needs; take scree-solver", what);
  };
  bool rotates = false, has_meshes = false;
  for (std::size_t b = 0; b < scene.source().bodies.size(); ++b) {
    rotates = rotates || !(scene.source().bodies.fixed[b] || scene.source().bodies.lock_rotation[b]);
    has_meshes = has_meshes || scene.shape(scene.source().bodies.shape[b]).kind != ShapeKind::sphere;
  }
  for (const WallZone& zone : scene.zones()) has_meshes = has_meshes || zone.kind == WallZone::Kind::mesh;
  need(built_with::kFriction, scene.law_choice().friction || scene.law_choice().rolling, "friction");
  need(built_with::kRotation, rotates, "rotation");
  need(built_with::kRanks, comm.size() > 1, "parallel ranks");
  need(built_with::kMeshes, has_meshes, "meshes");
}

extern "C" void note_signal(int number) { g_signal = number; }

}  // namespace

void catch_signals() {
  for (const int number : {SIGINT, SIGTERM, SIGUSR1}) std::signal(number, note_signal);
  std::signal(SIGXFSZ, SIG_IGN);  // a file over the limit of its size is an error of the write, told with its name
}

Simulation::Simulation(const mpi::Communicator& comm, const SolverScene& scene, const ParallelOptions& options)
    : comm_(comm),
      scene_(scene),
      options_(options),
      integrator_(scene.source().settings.integrator),
      agreement_(comm),
      balance_(comm.size()) {
  mpi::on_all(comm, [&] { check_built_with(comm, scene); });
  if (scene.source().settings.fluid) fluid_.emplace(scene.source());
  const Partition& partition = scene.source().partition;
  CutBoxes first_cut;
  if (partition.ranks == comm.size()) first_cut = {partition.lower, partition.upper};
  halo_ = std::make_unique<Halo>(comm, scene, options, std::move(first_cut));
  const BodyTable& bodies = scene.source().bodies;
  smallest_radius_ = bodies.size() == 0 ? 1 : 1e300;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    smallest_radius_ = std::min(smallest_radius_, bodies.scale[b] * scene.shape(bodies.shape[b]).radius);
  }
  sums_.resize(RunTotals::kFirstImpulse + 3 * scene.source().walls.size());
}

void Simulation::start_from_scene() {
  const BodyTable& bodies = scene_.source().bodies;
  // a scene that is cut for these ranks starts as it is cut; else bodies are dealt out in equal runs, to be cut at once
  const bool is_cut = scene_.source().partition.ranks == comm_.size();
  const auto ranks = static_cast<std::size_t>(comm_.size()), me = static_cast<std::size_t>(comm_.rank());
  std::vector<ParticleRecord> mine;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const std::size_t owner = is_cut ? static_cast<std::size_t>(bodies.owner[b]) : b * ranks / bodies.size();
    if (owner == me) mine.push_back(initial_record(scene_, b));
  }
  begin(mine, 0, 0, halo_->has_cut());
  // The forces of a checkpoint are those of its last step; only a fresh start computes them, with springs at rest.
  compute_forces(0, false);
  add_wall_totals(0.5 * dt_, sums_);  // the first kick is by half a step
  agree_on_failures();
}

void Simulation::start_from_records(const std::vector<ParticleRecord>& records, std::vector<WaitingState> state, std::int64_t step,
                                    double step_size, const RunTotals& totals) {
  pairs_.waiting() = std::move(state);
  max_overlap_ratio_ = totals.max_overlap_ratio;
  if (comm_.rank() == 0) sums_ = totals.sums;
  level_ = totals.level;
  begin(records, step, step_size, false);
}

void Simulation::begin(const std::vector<ParticleRecord>& records, std::int64_t step, double step_size, bool is_cut) {
  for (const ParticleRecord& r : records) append_record(p_, r, scene_);
  p_.owned = p_.size();
  std::fill(p_.work.begin(), p_.work.end(), 0.0);
  step_ = step;
  mpi::on_all(comm_, [&] { step_size_ = derive_step_size(comm_, scene_, p_); });
  if (step_size > 0) step_size_.step = step_size;  // a run keeps the step that it began with
  dt_ = std::ldexp(step_size_.step, -static_cast<int>(level_));
  set_walls(time());
  if (step == 0) choose_level(false);
  walls_listed_ = walls_;
  if (!is_cut && comm_.size() > 1) cut_anew(true);
  agreement_.start(look_at_lists(false, 0));
  rebuild_lists(agreement_.finish());
  fastest_ = std::numeric_limits<double>::infinity();  // forces are not known yet
  agree_on_failures();
}

void Simulation::set_walls(double time) {
  walls_.clear();
  for (const Wall& wall : scene_.source().walls) walls_.push_back(wall_state(wall, time, dt_));
}

void Simulation::compute_pairs(std::span<const std::int32_t> which, double friction_dt, Phase phase) {
  if (failure_ || which.empty()) return;  // after a failure the state means nothing; the messages go on until all ranks know
  const PhaseTimer timer(times_, phase);
  const WorkTimer work(balance_.computing(), balance_.weight_of(step_));
  try {
    max_overlap_ratio_ = std::max(max_overlap_ratio_, evaluate_pairs(scene_, p_, walls_, which, dt_, friction_dt, step_, scratch_, pairs_));
  } catch (const Error& e) {
    fail(e);
  }
}

void Simulation::add_ways(std::size_t begin, std::size_t end) {
  if (begin == end) return;
  const PhaseTimer timer(times_, Phase::contact);
  const WorkTimer work(balance_.computing(), balance_.weight_of(step_));
  pairs_.travel().add_motion(p_, scene_.periodicity(), begin, end);
}

void Simulation::compute_forces(double friction_dt, bool refresh) {
  const bool timed = built_with::kRanks && refresh && balance_.is_sample(step_);
  if (timed) scratch_.pair_seconds.assign(pairs_.pairs().size(), 0.0f);
  if (built_with::kRanks && refresh) halo_->start_refresh(p_, times_);
  if (built_with::kRanks && refresh && options_.strategy == HaloStrategy::blocking) halo_->finish_refresh(p_, times_);
  if (refresh) add_ways(0, p_.owned);
  compute_pairs(pairs_.inner(), friction_dt, Phase::contact);
  if (built_with::kRanks && refresh && options_.strategy == HaloStrategy::overlap) halo_->finish_refresh(p_, times_);
  if (refresh) add_ways(p_.owned, p_.size());
  if (built_with::kRanks) compute_pairs(pairs_.outer(), friction_dt, Phase::contact);
  if (built_with::kRanks) compute_pairs(pairs_.duplicated(), friction_dt, Phase::duplicated);
  if (timed) {
    balance_.add_sample(scratch_.pair_seconds, pairs_.pairs(), p_);
    scratch_.pair_seconds.clear();
  }
  const PhaseTimer timer(times_, Phase::sum);
  const WorkTimer work(balance_.computing(), balance_.weight_of(step_));
  pairs_.sum_onto_bodies(scene_.source().settings.gravity, p_);
  if (fluid_) fluid_->add_buoyancy(p_);
}

void Simulation::fail(const Error& error) {
  if (failure_) return;
  failure_ = std::make_unique<Error>(error);
  failure_step_ = step_;
}

void Simulation::agree_on_failures() {
  if (agreement_.is_under_way()) reports_ = agreement_.finish();
  // A failed rank goes on for a step or two with a state that means nothing, which others may stumble over: the first failure counts.
  const double none = 1e300;
  const double first = -comm_.max(failure_ ? -static_cast<double>(failure_step_) : -none);
  mpi::agree(comm_, failure_ && static_cast<double>(failure_step_) <= first ? failure_.get() : nullptr);
}

StepReport Simulation::agree_on_step(bool forced) {
  // what was asked for this step in the one before, when ranks looked ahead
  StepReport asked;
  if (reports_ || agreement_.is_under_way()) {
    const PhaseTimer timer(times_, Phase::agree);
    asked = reports_ ? *reports_ : agreement_.finish();
    reports_.reset();
    fastest_ = asked.fastest;
  }
  asked.fastest = fastest_;
  if (forced) asked.rebuild = 1;
  const bool rebuilt = asked.rebuild != 0, ahead = may_look_ahead(rebuilt ? list_skin(fastest_) : skin_);
  StepReport mine = look_at_lists(rebuilt, fastest_);
  if (ahead && lists_overrun_) {
    fail(RunInvalid("step {}: a body or wall went further in one step than all that moved before; use a step of at most {:.3g} s", step_,
                    0.5 * dt_));
  }
  mine.signal = g_signal;
  mine.failed = failure_ ? 1 : 0;
  mine.checkpoint = checkpoint_asked_;
  balance_.tell(mine);
  if (!built_with::kRanks || comm_.size() == 1) return mine;
  const PhaseTimer timer(times_, Phase::agree);
  agreement_.start(mine);
  if (ahead) return asked;
  StepReport now = agreement_.finish();
  fastest_ = now.fastest;
  now.rebuild = std::max(now.rebuild, asked.rebuild);
  now.signal = std::max(now.signal, asked.signal);
  now.failed = std::max(now.failed, asked.failed);
  now.checkpoint = std::max(now.checkpoint, asked.checkpoint);
  return now;
}

bool Simulation::review() {
  // Lists are rebuilt at other steps on other numbers of ranks and after a restart; what changes the result must not.
  const Domain& domain = scene_.source().settings.domain;
  const bool rebuild = std::exchange(level_changed_, false);  // lists are made for the step
  if (substep_ != 0 || step_ % kReviewSteps != 0 || !domain.bounded) return rebuild;
  if (domain.outside == Outside::stop && any_left_domain()) {
    try {
      check_domain();
    } catch (const Error& e) {
      fail(e);
    }
  }
  if (domain.outside != Outside::remove) return rebuild;
  removal_due_ = comm_.max(any_left_domain() ? 1.0 : 0.0) > 0;
  return rebuild || removal_due_;
}

void Simulation::advance() {
  const std::int64_t next = step_ + 1;
  while (step_ < next) advance_substep();
  if (step_ % kReviewSteps == 0) choose_level(step_ % kContactReviewSteps == 0);
}

void Simulation::advance_substep() {
  const double dt = dt_;
  {
    const PhaseTimer timer(times_, Phase::integrate);
    const WorkTimer work(balance_.computing(), balance_.weight_of(step_));
    begin_step(integrator_, p_, dt, fluid());
    if (scene_.periodicity().any()) wrap_positions(scene_.periodicity(), p_);
    if (++substep_ == std::int64_t{1} << level_) {
      substep_ = 0;
      ++step_;
    }
    check_displacement();
    if (scene_.has_driven_walls()) set_walls(time());
  }
  const bool forced = review();
  StepReport report = agree_on_step(forced);
  if (forced) report.rebuild = 1;
  signal_ = static_cast<int>(report.signal);
  checkpoint_heard_ = report.checkpoint;
  if (report.failed != 0) agree_on_failures();
  if (report.rebuild != 0) rebuild_lists(report);
  compute_forces(dt, report.rebuild == 0);
  const PhaseTimer timer(times_, Phase::integrate);
  const WorkTimer work(balance_.computing(), balance_.weight_of(step_));
  end_step(integrator_, p_, dt, fluid());
  add_wall_totals(dt, sums_);
  // The force of step n acts over a whole step around it, with the mean velocity of that step: that of the full step.
  const auto count = static_cast<std::ptrdiff_t>(p_.owned);
#pragma omp parallel for schedule(static)
  for (std::ptrdiff_t n = 0; n < count; ++n) {
    const auto i = static_cast<std::size_t>(n);
    if (p_.fixed[i]) continue;
    p_.dissipated[i] -= dt * (dot(p_.dissipative_force[i], p_.v[i]) + dot(p_.dissipative_torque[i], p_.w[i]));
  }
}

}  // namespace scree
