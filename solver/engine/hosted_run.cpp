#include "solver/engine/hosted_run.hpp"

#include <omp.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <string_view>
#include <utility>

#include "solver/engine/hosted_run-inl.hpp"
#include "solver/run/measures.hpp"
#include "solver/scene/origin.hpp"

namespace scree {

namespace {

using Clock = std::chrono::steady_clock;

/// Numbers of functions of forces, each given once in a process: a state of one run is never taken for that of another.
std::atomic<int> g_last_force{0};

template <class Entry>
std::vector<std::int64_t> named_in(const std::vector<Entry>& mine) {
  std::vector<std::int64_t> ids;
  for (const Entry& entry : mine) ids.push_back(entry.id);
  return ids;
}

}  // namespace

void HostedRun::Inner::begin() {
  omp_set_num_threads(threads);
  const bool has_folder = !options.run_folder.empty();
  if (!has_folder && (options.restart == "latest" || options.restart == "auto"))
    throw UsageError(
        "restart = \"{}\": is the newest checkpoint of a run folder, and run is not given; give run, or the path of a checkpoint",
        options.restart);
  std::optional<Checkpoint> checkpoint;
  if (has_folder) {
    start = find_start(comm, options, loaded);
    if (start.is_complete)
      throw UsageError("run = \"{}\": this run is complete, and nothing is left to do; read its files, or give another folder",
                       options.run_folder);
    checkpoint = std::exchange(start.checkpoint, std::nullopt);
  } else if (!options.restart.empty()) {
    checkpoint = read_checkpoint(comm, options.restart);
    mpi::on_root(comm, [&] {
      if (checkpoint->scene_sha256 != loaded.sha256)
        throw InputError("restart = \"{}\": was made from another scene than {}; give the scene it came from", options.restart,
                         options.scene_path);
    });
  }
  watchdog.emplace(comm, 0.0, nullptr);
  simulation.emplace(comm, *loaded.prepared, options.parallel);
  fit_threads(loaded.scene, comm.size(), options.most_threads);
  if (has_folder) {  // the log has what the program does from its first row on
    simulation->outer_forces();
    if (auto* const heat = state().effect<HeatEffect>()) heat->outer();
  }
  std::string path;
  RunRecord before;
  if (checkpoint) {
    path = checkpoint->path;
    before = checkpoint->record;
    start_from_checkpoint(comm, *simulation, std::move(*checkpoint), loaded.origin);
  } else {
    simulation->start_from_scene(loaded.start);
  }
  check_step_size(comm, options, loaded.scene.settings, state().clock.size);
  if (!path.empty()) simulation->evaluate_contacts_at_rest();
  if (!has_folder) return;
  files.emplace(comm, options, loaded, *watchdog, *simulation, path, before);
  files->begin();
}

void HostedRun::Inner::check_goes_on(const char* what) const {
  if (!failed.empty())
    throw UsageError(
        "{}: the run has ended: {}. Its bodies are in the midst of a step; restore a saved state, or close the engine. "
        "write_frame shows them as they are, to find the cause",
        what, failed);
}

/// Bodies that wait to join are known by their ids already, and are in no state yet.
void HostedRun::Inner::check_joined(const char* what, const std::vector<std::int64_t>& mine) const {
  if (!simulation->bodies_wait()) return;
  std::vector<std::int64_t> waiting;
  for (const ParticleRecord& body : simulation->waiting_bodies()) waiting.push_back(body.id);
  waiting = comm.of_all(waiting);
  mpi::on_all(comm, [&] {
    for (const std::int64_t id : mine)
      if (std::find(waiting.begin(), waiting.end(), id) != waiting.end())
        throw UsageError("{}: body {} was inserted and joins in the next step; make a step first", what, id);
  });
}

/// Of a call that takes ids, or means all bodies.
void HostedRun::Inner::check_all_or_named(const char* what, bool is_named) const {
  const double all = is_named ? 0 : 1;
  if (comm.max(all) != -comm.max(-all))
    throw UsageError("{}: some ranks name bodies, others mean all; on every rank name bodies, perhaps none, or mean all", what);
}

void HostedRun::Inner::check_nobody_waits(const char* what) const {
  if (simulation->bodies_wait())
    throw UsageError("{}: bodies wait to join or to leave in the next step, and are in no state before; make a step first", what);
}

void HostedRun::Inner::check_moves(const char* what) const {
  check_goes_on(what);
  if (loaded.prepared->is_frozen()) throw UsageError("{}: heat.frozen keeps bodies as they are; leave it out of the case", what);
  if (loaded.scene.settings.cell)
    throw UsageError(
        "{}: the bodies of a periodic cell that deforms have no momentum together, and stay as many; leave [cell] out of the case", what);
}

HeatEffect& HostedRun::Inner::heat(const char* what) {
  check_goes_on(what);
  auto* const effect = state().effect<HeatEffect>();
  if (effect == nullptr)
    throw UsageError("{}: the scene has no heat, and its bodies no temperature; add a table [heat] to the case, and pack it again", what);
  return *effect;
}

void HostedRun::Inner::look_around() {
  if (!poll) return;
  const Clock::time_point now = Clock::now();
  if (std::chrono::duration<double>(now - polled).count() < poll_interval) return;
  polled = now;
  if (const int number = poll(); number != 0) simulation->requests().ask_to_stop(number);
}

/// One step or more.
int HostedRun::Inner::some_steps(std::int64_t most) {
  look_around();
  if (files && files->is_over())
    throw UsageError("step: the run in {} is over after {:g} s, the time.duration of its case; close it, and give a longer time.duration",
                     options.run_folder, simulation->time());
  guarded([&] {
    if (files)
      files->step(most);
    else
      simulation->advance(simulation->step() + most);
  });
  const int signal = simulation->requests().pending_signal();
  if (signal == 0) return 0;
  simulation->requests().stopped();
  return static_cast<int>(ExitCode::signal_base) + signal;
}

HostedRun::HostedRun(const std::string& scene, MPI_Comm comm, const Options& options) {
  in_ = std::make_unique<Inner>(scene, comm, options);
  in_->begin();
}

HostedRun::~HostedRun() = default;

void HostedRun::check(bool is_right, const char* text) const {
  mpi::on_all(in_->comm, [&] {
    if (!is_right) throw UsageError("{}", text);
  });
}

void HostedRun::close() {
  if (in_->files && in_->failed.empty()) in_->files->leave();
  if (in_->files && !in_->failed.empty() && !in_->is_told) in_->files->abandon(in_->failed);
  in_->files.reset();
}

int HostedRun::step(std::int64_t count) {
  if (count < 0) throw UsageError("step: {} steps: expected a number >= 0", count);
  in_->check_goes_on("step");
  int code = 0;
  // a run with files ends where its case ends; only a call that begins behind the end is an error
  const std::int64_t end = step_count() + count;
  for (bool is_first = true; step_count() < end && code == 0 && (is_first || !in_->files || !in_->files->is_over()); is_first = false)
    code = in_->some_steps(end - step_count());
  in_->guarded([&] { in_->simulation->agree_on_failures(); });
  if (!in_->files) in_->simulation->drop_events();
  return code;
}

int HostedRun::run_until(double until) {
  constexpr double kRounding = 1e-9;  // of a step
  constexpr double kMost = 0x1p53;
  const double steps = std::ceil((until - time()) / dt() - kRounding);
  if (!(std::abs(steps) < kMost)) throw UsageError("run_until: {:g} s is no time that can be reached in steps of {:.3g} s", until, dt());
  return step(std::max<std::int64_t>(0, static_cast<std::int64_t>(steps)));
}

void HostedRun::on_poll(std::function<int()> poll, double interval) {
  if (!(interval >= 0)) throw UsageError("poll: an interval of {:g} s: expected a time >= 0 s", interval);
  in_->poll = std::move(poll);
  in_->poll_interval = interval;
}

double HostedRun::time() const { return in_->simulation->time(); }
double HostedRun::dt() const { return in_->state().clock.size.step; }
std::int64_t HostedRun::step_count() const { return in_->simulation->step(); }
bool HostedRun::is_over() const {
  constexpr double kRounding = 1e-9;  // of a step
  return in_->files ? in_->files->is_over() : time() >= in_->loaded.scene.settings.duration - kRounding * dt();
}
const Scene& HostedRun::scene() const { return in_->loaded.scene; }
std::int64_t HostedRun::body_count() const { return static_cast<std::int64_t>(in_->state().particles.owned); }

const double* HostedRun::reals(const std::string& field) {
  in_->check_goes_on("bodies");
  return in_->fields.reals(in_->loaded, in_->state(), field);
}
const std::int64_t* HostedRun::integers(const std::string& field) {
  in_->check_goes_on("bodies");
  return in_->fields.integers(in_->state(), field);
}

void HostedRun::hold(const std::vector<WrenchOnBody>& mine) {
  in_->check_moves("set_wrench");
  in_->check_joined("set_wrench", named_in(mine));
  in_->simulation->outer_forces().hold(in_->change(), mine);
}

void HostedRun::release(const std::optional<std::vector<std::int64_t>>& mine) {
  in_->check_moves("clear_wrench");
  in_->check_all_or_named("clear_wrench", mine.has_value());
  if (mine) in_->check_joined("clear_wrench", *mine);
  in_->simulation->outer_forces().release(in_->change(), mine);
}

int HostedRun::add_force(const ForceFunction& function, std::int64_t every, const std::string& name) {
  in_->check_moves("add_force");
  const int number = ++g_last_force;
  const GivenFunction given{function, every, name.empty() ? fmt::format("number {}", number) : name};
  in_->forces.push_back({number, in_->simulation->outer_forces().add(in_->change(), given), given});
  return number;
}

void HostedRun::remove_force(int number) {
  const auto at = std::find_if(in_->forces.begin(), in_->forces.end(), [number](const auto& f) { return f.number == number; });
  if (at == in_->forces.end())
    throw UsageError("remove_force: no function has the number {}; it was removed before, or never added", number);
  // of a run that has ended, perhaps by this function, it is only forgotten
  if (in_->failed.empty()) in_->simulation->outer_forces().remove(in_->change(), at->number_of_effect);
  in_->forces.erase(at);
}

void HostedRun::hold_heat(const std::vector<SourceOfBody>& mine) {
  OuterHeat& outer = in_->heat("set_heat_source").outer();
  in_->check_joined("set_heat_source", named_in(mine));
  outer.hold(in_->state(), mine);
}

void HostedRun::hold_heat(const std::vector<MediumOfBody>& mine) {
  OuterHeat& outer = in_->heat("set_medium").outer();
  in_->check_joined("set_medium", named_in(mine));
  outer.hold(in_->state(), mine);
}

void HostedRun::release_heat(const std::optional<std::vector<std::int64_t>>& mine) {
  OuterHeat& outer = in_->heat("clear_heat").outer();
  in_->check_all_or_named("clear_heat", mine.has_value());
  if (mine) in_->check_joined("clear_heat", *mine);
  outer.release(in_->state(), mine);
}

std::vector<double> HostedRun::take_medium_heat(const std::vector<std::int64_t>& mine) {
  OuterHeat& outer = in_->heat("take_medium_heat").outer();
  in_->check_joined("take_medium_heat", mine);
  return outer.take(in_->state(), mine);
}

HeatMeasures HostedRun::heat() { return in_->heat("heat").measure(in_->state()); }

std::vector<std::array<double, 6>> HostedRun::wall_loads() {
  in_->check_goes_on("loads of walls");
  std::vector<WallLoad> loads = wall_loads_of(in_->state());
  std::vector<WallState> walls = in_->state().walls;
  move_loads_to_world(loads, walls, in_->loaded.origin);
  std::vector<std::array<double, 6>> numbers;
  for (const WallLoad& load : loads)
    numbers.push_back({load.force.x, load.force.y, load.force.z, load.torque.x, load.torque.y, load.torque.z});
  return numbers;
}

std::array<double, 13> HostedRun::wall_state(std::size_t wall) const {
  in_->check_goes_on("walls");
  const WallState& w = in_->state().walls[wall];
  const Vec3 at = wall_position_in_world(in_->loaded.scene.walls[wall], w, in_->loaded.origin);
  return {at.x,         at.y,         at.z,         w.orientation.w,      w.orientation.x,      w.orientation.y,     w.orientation.z,
          w.velocity.x, w.velocity.y, w.velocity.z, w.angular_velocity.x, w.angular_velocity.y, w.angular_velocity.z};
}

void HostedRun::drive_wall(std::size_t wall, double rate) {
  in_->check_moves("drive");
  check(std::isfinite(rate), "drive: the rate is not a finite number; check what it is computed from");
  const double others = in_->comm.max(rate), least = -in_->comm.max(-rate);
  if (others != least)
    throw UsageError("drive: ranks give wall '{}' different rates, {:g} and {:g}; give the same on every rank", scene().walls[wall].name,
                     least, others);
  in_->simulation->drive_wall(wall, rate);
}

std::pair<double, double> HostedRun::wall_way(std::size_t wall) const {
  in_->check_goes_on("way");
  const std::vector<DriveState>& drives = in_->state().drives;
  if (in_->loaded.prepared->drive(wall) == nullptr)
    throw UsageError("way: wall '{}' does not move by force or from outside; its place is its position", scene().walls[wall].name);
  return {drives[wall].way, drives[wall].rate};
}

Energies HostedRun::energies() {
  in_->check_goes_on("energies");
  return energies_of(in_->state());
}
std::string HostedRun::state_hash() {
  in_->check_goes_on("state_hash");
  return scree::state_hash(in_->state());
}
double HostedRun::critical_step() {
  in_->check_goes_on("critical_step");
  return in_->simulation->critical_step().step;
}

const FrameContacts& HostedRun::collect_contacts() {
  in_->check_goes_on("contacts");
  in_->contacts = in_->simulation->contacts();
  for (Vec3& point : in_->contacts.point) point += in_->loaded.origin;
  return in_->contacts;
}

}  // namespace scree
