#include "solver/run/run_steps.hpp"

#include <omp.h>
#include <sys/resource.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/base/provenance.hpp"
#include "core/base/units.hpp"
#include "core/distance/triangle_distance.hpp"
#include "solver/run/idle_servos.hpp"
#include "solver/run/outcome.hpp"
#include "solver/scene/origin.hpp"

namespace scree {

namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point t) { return std::chrono::duration<double>(Clock::now() - t).count(); }

std::int64_t peak_memory() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::int64_t>(usage.ru_maxrss) * 1024;
}

/// Collective. Throws on every rank what RestWatch throws.
RestWatch make_rest_watch(const mpi::Communicator& comm, const Scene& scene) {
  std::optional<RestWatch> rest;
  mpi::on_all(comm, [&] { rest.emplace(scene); });
  if (comm.rank() == 0 && rest->is_active() && rest->walls_stop() >= scene.settings.duration) {
    warn_once("scree-solver",
              fmt::format("time.stop_at_rest: a wall moves until the end ({}), so that nothing comes to rest before; give its motion a "
                          "stop, or leave stop_at_rest out",
                          format_quantity(scene.settings.duration, Dimension::time)));
  }
  return std::move(*rest);
}

}  // namespace

nlohmann::json provenance_of_run(const mpi::Communicator& comm, const RunOptions& options, const LoadedScene& loaded,
                                 const std::string& checkpoint_path) {
  Provenance record;
  record.format = kFrameFormat;
  record.format_version = kFrameFormatVersion;
  record.tool = "scree-solver";
  record.command = options.command;
  record.inputs = {{options.scene_path, loaded.sha256, loaded.scene.provenance}};
  if (!checkpoint_path.empty()) {
    std::string hash;
    mpi::on_root(comm, [&] { hash = sha256_of_file(checkpoint_path); });
    record.inputs.push_back({checkpoint_path, hash, nullptr});
  }
  record.seed = loaded.scene.settings.seed;
  record.ranks = comm.size();
  record.threads = omp_get_max_threads();
  record.instruction_set = simd_target();
  return provenance_record(record);
}

RunSteps::RunSteps(const mpi::Communicator& comm, const RunOptions& options, const LoadedScene& loaded, Watchdog& watchdog,
                   Simulation& simulation, const std::string& checkpoint_path, const RunRecord& before)
    : comm_(comm),
      options_(options),
      loaded_(loaded),
      watchdog_(watchdog),
      simulation_(simulation),
      is_restart_(!checkpoint_path.empty()),
      before_(before),
      rest_(make_rest_watch(comm, loaded.scene)),
      schedule_(
          make_schedule(loaded.scene.settings, simulation.state().clock.size.step, rest_.row_interval(), options.checkpoint_interval)),
      writers_(comm, options, loaded, schedule_, provenance_of_run(comm, options, loaded, checkpoint_path), simulation, is_restart_),
      guard_(comm, *loaded.prepared, before),
      first_step_(simulation.step()),
      row_step_(simulation.step()) {
  if (is_restart_) {
    mpi::on_root(comm_, [&] { rest_.read_log(writers_.log_path()); });
    MPI_Bcast(&rest_.last_busy(), 1, MPI_DOUBLE, 0, comm_.get());
  }
  fit_threads(simulation_, options_.most_threads);
  if (talks()) announce();
  cores_.leave_out();
  start_ = row_time_ = checkpoint_time_ = Clock::now();
  guard_.begin(simulation_, !is_restart_);
  if (talks()) progress_ = std::make_unique<Progress>("solver", static_cast<double>(std::max<std::int64_t>(1, schedule_.last)));
}

void RunSteps::announce() const {
  const StepSize& step = simulation_.state().clock.size;
  std::fprintf(stderr, "scree-solver: %zu bodies, %d ranks x %d threads, step %s (%s), %lld steps\n", loaded_.scene.bodies.size(),
               comm_.size(), omp_get_max_threads(), format_quantity(step.step, Dimension::time).c_str(),
               step.given ? "given" : ("limited by " + step.limited_by).c_str(), static_cast<long long>(schedule_.last));
}

void RunSteps::begin() {
  if (!is_restart_) {
    timed_output([&] { write_row(); });
    timed_output([&] { write_frame(); });
  }
  keep_if_invalid([&] { check_for_end(); });
}

int RunSteps::step(std::int64_t most) {
  int code = 0;
  keep_if_invalid([&] { code = advance(most); });
  return code;
}

template <class Action>
void RunSteps::keep_if_invalid(Action&& action) {
  try {
    action();
  } catch (const mpi::AgreedError& error) {
    if (error.code() == ExitCode::run_invalid) keep_invalid_state(error);
    throw;
  }
}

int RunSteps::advance(std::int64_t most) {
  ask_for_checkpoint_by_clock();
  const std::int64_t before = simulation_.step();
  simulation_.advance(std::min(before + most, schedule_.next_output(before)));
  body_steps_ += static_cast<double>(simulation_.state().facts.count) * static_cast<double>(simulation_.step() - before);
  watchdog_.progress(simulation_.step());
  const std::int64_t step = simulation_.step();
  if (schedule_.is_frame_due(step)) check_for_end();
  const bool ends_here = schedule_.is_frame_due(step) && !end_of_effect_.empty();
  if (schedule_.is_row_due(step) || ends_here) timed_output([&] { write_row(); });
  // before the last checkpoint, after which only the outcome is missing
  if (schedule_.is_frame_due(step)) timed_output([&] { write_frame(); });
  if (simulation_.requests().pending_signal() != 0) return stop_by_signal();
  if (schedule_.is_checkpoint_due(step) || simulation_.requests().is_checkpoint_asked() || is_over()) timed_output([&] { save_state(); });
  show_progress();
  return 0;
}

bool RunSteps::is_over() const {
  if (simulation_.step() >= schedule_.last) return true;
  if (simulation_.step() % schedule_.frame != 0) return false;
  return is_empty_ || !end_of_effect_.empty() || rest_.at_rest(simulation_.time()) || (rest_.is_active() && rest_.is_empty());
}

/// Before the first step, and whenever the run may end.
void RunSteps::check_for_end() {
  const RunState& s = simulation_.state();
  if (rest_.is_active()) rest_.look(comm_.max(rest_.busiest(s.particles)), body_count(s));
  if (loaded_.scene.settings.stop_when_empty) is_empty_ = free_body_count(s) == 0;
  for (const std::unique_ptr<Effect>& effect : s.effects) {
    if (end_of_effect_.empty()) end_of_effect_ = effect->ends_run(s);
  }
}

void RunSteps::ask_for_checkpoint_by_clock() {
  if (schedule_.checkpoint_clock > 0 && is_root() && seconds_since(checkpoint_time_) >= schedule_.checkpoint_clock) {
    simulation_.requests().ask_for_checkpoint();
  }
}

/// A row of log.csv and, where due, of ranks.csv; ends the run when its energies cannot be trusted.
void RunSteps::write_row() {
  simulation_.agree_on_failures();
  writers_.write_events(simulation_);
  const LogRow row = take_row();
  writers_.write_row(row, before_, row.step == schedule_.last || is_empty_ || !end_of_effect_.empty() || rest_.at_rest(row.time));
  if (is_root() && simulation_.state().clock.dt > row.critical.step) {
    warn_once("scree-solver",
              fmt::format("the step {:.4g} s is above the critical step of the contacts that there are; see critical_step in "
                          "log.csv; the run ends when their energy grows",
                          simulation_.state().clock.dt));
  }
  if (is_root() && row.deep.contact_steps > 0 && !deep_is_told_) {
    deep_is_told_ = true;
    warn_once("scree-solver", "so far " + text_of(simulation_.state().scene, row.deep, simulation_.state().clock.size.step));
  }
  if (talks()) cores_.report_once();
  guard_.check(simulation_, row.energy_error);
}

/// Measures the present state, and hands it to the guard and the watch for rest.
LogRow RunSteps::take_row() {
  LogRow row;
  row.step = simulation_.step();
  row.time = simulation_.time();
  row.energies = energies_of(simulation_.state());
  row.max_overlap_ratio = simulation_.take_max_overlap_ratio();
  row.imbalance = simulation_.decomposition().take_imbalance();
  row.contacts = contact_count(simulation_.state());
  row.of_effects = columns_of_effects(simulation_.state(), row.energies);
  if (simulation_.state().scene.continues()) {
    row.deep_now = deep_pair_count(simulation_.state());
    row.deep = deep_of_all();
  }
  row.loads = wall_loads_of(simulation_.state());
  row.walls = simulation_.state().walls;
  row.drives = simulation_.state().drives;
  row.origin = loaded_.origin;
  move_loads_to_world(row.loads, row.walls, row.origin);
  row.state_hash = state_hash(simulation_.state());
  row.ranks = gather_measures(comm_, rank_measures(simulation_));
  row.removed = removed_totals(simulation_.state());
  row.has_program = options_.has_program;
  row.inserted = arrived_totals(simulation_.state());
  row.critical = simulation_.critical_step();
  row.energy_error = guard_.add_row(row.energies, row.max_overlap_ratio, row.imbalance, row.critical);
  rest_.add(row.time, kinetic_energy());
  const double elapsed = seconds_since(row_time_);
  row.steps_per_second = elapsed > 0 ? static_cast<double>(row.step - row_step_) / elapsed : 0;
  row_time_ = Clock::now();
  row_step_ = row.step;
  return row;
}

void RunSteps::write_frame() {
  simulation_.agree_on_failures();
  writers_.write_frame(simulation_, schedule_.frame_number(simulation_.step()), true);
}

void RunSteps::save_state() {
  simulation_.agree_on_failures();
  writers_.write_events(simulation_);
  writers_.write_checkpoint(simulation_, record_so_far());
  simulation_.requests().checkpoint_written();
  checkpoint_time_ = Clock::now();
}

int RunSteps::stop_by_signal() {
  save_state();
  guard_.add_overlap(simulation_.take_max_overlap_ratio());
  const int signal = simulation_.requests().pending_signal(), code = static_cast<int>(ExitCode::signal_base) + signal;
  write_outcome({"interrupted",
                 fmt::format("signal {} at step {}; continue with {}", signal, simulation_.step(), options_.words().restart("latest")),
                 code});
  if (progress_) progress_->finish(fmt::format("stopped by signal {} at step {}; a checkpoint was kept", signal, simulation_.step()));
  return code;
}

/// Every rank is here: keep the state and the reason.
void RunSteps::keep_invalid_state(const Error& error) {
  guard_.add_overlap(simulation_.take_max_overlap_ratio());
  // the last state as a frame without contacts, to be looked at; a restart goes on from the checkpoint before it
  writers_.write_frame(simulation_, simulation_.step() / schedule_.frame + 1, false);
  write_outcome({"invalid", error.what(), static_cast<int>(error.code())});
}

void RunSteps::leave() {
  if (is_over()) {
    finish();
    return;
  }
  timed_output([&] { save_state(); });
  write_outcome(
      {"interrupted", fmt::format("closed at step {}; continue with {}", simulation_.step(), options_.words().restart("latest")), 0});
}

void RunSteps::abandon(const std::string& reason) {
  write_outcome({"interrupted", "ended by an error: " + reason, static_cast<int>(ExitCode::usage)});
}

/// Whether no inlet has brought a body.
bool RunSteps::nothing_came() const {
  const std::vector<InletState>& inlets = simulation_.state().totals.inlets;
  return std::all_of(inlets.begin(), inlets.end(), [](const InletState& inlet) { return inlet.count == 0; });
}

void RunSteps::finish() {
  const std::string reason = is_empty_ && body_count(simulation_.state()) > 0                   ? "no body is left that is free to move"
                             : body_count(simulation_.state()) > 0                              ? end_of_effect_
                             : loaded_.scene.bodies.size() == 0 && loaded_.scene.inlets.empty() ? "the scene has no body"
                             : loaded_.scene.bodies.size() == 0 && nothing_came()               ? "no inlet brought a body"
                             : loaded_.scene.outlets.empty()                                    ? "no body is left: all left the domain"
                                                                                                : "no body is left: all left the run";
  write_outcome({"completed", reason, 0});
  const DeepTotals deep = deep_of_all();
  if (!talks()) return;
  if (deep.contact_steps > 0)
    std::fprintf(stderr, "scree-solver: %s\n", text_of(simulation_.state().scene, deep, simulation_.state().clock.size.step).c_str());
  cores_.report_once();
  for (const std::string& line : idle_servos(simulation_.state())) warn_once("scree-solver", line);
  for (const std::string& line : blocked_inlets(loaded_.scene, simulation_.state())) warn_once("scree-solver", line);
  if (!reason.empty()) std::fprintf(stderr, "scree-solver: %s\n", reason.c_str());
  const RunRecord& record = guard_.record();
  const std::string since = is_restart_ ? fmt::format(" ({} of them since the restart)", simulation_.step() - first_step_) : "";
  const Settings& settings = loaded_.scene.settings;
  const char* room = settings.margin <= 0 ? "radius" : loaded_.scene.balls_touch_beside_meshes() ? "maximum" : "margin";
  progress_->finish(fmt::format("{} steps{}, {:.0f} particle-steps/s, overlap/{} at most {:.3f}, energy balance to {:.2g}",
                                simulation_.step(), since, body_steps_ / std::max(seconds_since(start_), 1e-9), room,
                                record.max_overlap_ratio, relative_energy_error(record.energy_error, record.in_play(), loaded_.scene)));
}

/// Contacts deeper than their maximum overlap since the start.
DeepTotals RunSteps::deep_of_all() const {
  if (!simulation_.state().scene.continues()) return {};
  return over_ranks(comm_.get(), simulation_.state().totals.deep);
}

/// Rows so far, and the sums of the parts before this one with those of this one.
RunRecord RunSteps::record_so_far() const {
  RunRecord run = guard_.record();
  run.list_renewals += simulation_.lists().rebuilds();
  run.cuts += simulation_.decomposition().cuts();
  run.migrated += simulation_.decomposition().migrated();
  const RankMeasures mine = rank_measures(simulation_);
  run.bytes_sent += comm_.sum(mine.bytes + mine.rebuild_bytes);
  run.peak_memory = std::max(run.peak_memory, comm_.sum(peak_memory()));
  run.wall_seconds += seconds_since(start_);
  PhaseTimes times = mine.times;
  MPI_Allreduce(MPI_IN_PLACE, times.data(), static_cast<int>(times.size()), MPI_DOUBLE, MPI_SUM, comm_.get());
  for (std::size_t p = 0; p < times.size(); ++p) run.phases[p] += times[p] / comm_.size();
  return run;
}

void RunSteps::write_outcome(const Outcome& outcome) {
  Outcome with_pace = outcome;
  with_pace.slowdown = std::max(1.0, cores_.slowdown());
  scree::write_outcome(comm_, with_pace, options_, loaded_, simulation_, record_so_far(), rest_, writers_.provenance());
}

void RunSteps::show_progress() {
  if (!progress_) return;
  progress_->update(static_cast<double>(simulation_.step()),
                    fmt::format("t = {}, kinetic {:.3g} J", format_quantity(simulation_.time(), Dimension::time), kinetic_energy()));
}

template <class Action>
void RunSteps::timed_output(Action&& action) {
  const Clock::time_point begin = Clock::now();
  cores_.take_in();
  action();
  cores_.leave_out();
  fit_threads(simulation_, options_.most_threads);
  watchdog_.progress(simulation_.step());
  simulation_.times()[static_cast<std::size_t>(Phase::output)] += seconds_since(begin);
}

}  // namespace scree
