#include "solver/engine/hosted_run.hpp"

#include <fmt/ranges.h>
#include <omp.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <string_view>
#include <utility>

#include "core/base/nearest_name.hpp"
#include "solver/engine/body_fields.hpp"
#include "solver/run/make_frame.hpp"
#include "solver/run/measures.hpp"
#include "solver/run/run_steps.hpp"
#include "solver/run/start.hpp"
#include "solver/scene/origin.hpp"

namespace scree {

namespace {

using Clock = std::chrono::steady_clock;

int threads_at_start(const HostedRun::Options& options) { return options.threads > 0 ? options.threads : omp_get_max_threads(); }

std::int32_t index_of(const std::vector<std::string>& names, const std::string& name, const char* kind) {
  const auto at = std::find(names.begin(), names.end(), name);
  if (at != names.end()) return static_cast<std::int32_t>(at - names.begin());
  const std::string near = nearest_name(name, names);
  throw UsageError("insert: the scene has no {} '{}'; {}", kind, name,
                   near.empty() ? fmt::format("there are: {}", fmt::join(names, ", ")) : fmt::format("did you mean '{}'?", near));
}

template <class Items>
std::vector<std::string> names_of(const Items& items) {
  std::vector<std::string> names;
  for (const auto& item : items) names.push_back(item.name);
  return names;
}

}  // namespace

struct HostedRun::Inner {
  mpi::Communicator comm;
  RunOptions options;
  int threads;
  LoadedScene loaded;  // its prepared part points into it: it stays where it is made
  RunStart start;
  std::optional<Watchdog> watchdog;
  std::optional<Simulation> simulation;
  std::optional<RunSteps> files;  // of a run with a folder
  std::function<int()> poll;
  double poll_interval = 0;
  Clock::time_point polled = Clock::now();
  std::string failed;  // what ended the run; "": it goes on
  struct Force {
    int number, number_of_effect;
    ForceFunction function;
    std::int64_t every;
  };
  std::vector<Force> forces;
  int last_force = 0;
  BodyFields fields;
  FrameContacts contacts;

  Inner(const std::string& scene, MPI_Comm c, const Options& o) : comm(c), threads(threads_at_start(o)), loaded(load_scene(comm, scene)) {
    options.scene_path = scene;
    options.run_folder = o.run_folder;
    options.restart = o.restart;
    options.command = {kEngineCommand, scene};
    options.is_quiet = true;
    options.stall_limit = 0;  // the program that steps may wait for as long as it likes
    options.most_threads = o.threads > 0 || std::getenv("OMP_NUM_THREADS") != nullptr ? 0 : threads;
  }

  const RunState& state() const { return simulation->state(); }
  RunState& change() { return simulation->changeable_state(); }
  void begin();
  void check_goes_on(const char* what) const;
  void check_moves(const char* what) const;
  template <class Action>
  void guarded(Action&& action);
  int one_step();
  void look_around();
  int stopped();
};

void HostedRun::Inner::begin() {
  omp_set_num_threads(threads);
  const bool has_folder = !options.run_folder.empty();
  if (!has_folder && (options.restart == "latest" || options.restart == "auto"))
    throw UsageError("restart = '{}' is of a run folder: give one, or the path of a checkpoint", options.restart);
  std::optional<Checkpoint> checkpoint;
  if (has_folder) {
    start = find_start(comm, options, loaded);
    if (start.is_complete)
      throw UsageError("{}: this run is complete; open it with scree.open, or give another folder", options.run_folder);
    checkpoint = std::exchange(start.checkpoint, std::nullopt);
  } else if (!options.restart.empty()) {
    checkpoint = read_checkpoint(comm, options.restart);
    mpi::on_root(comm, [&] {
      if (checkpoint->scene_sha256 != loaded.sha256)
        throw InputError("restart {}: was made from another scene than {}; give the scene it came from", options.restart,
                         options.scene_path);
    });
  }
  watchdog.emplace(comm, 0.0, nullptr);
  simulation.emplace(comm, *loaded.prepared, options.parallel);
  fit_threads(loaded.scene, comm.size(), options.most_threads);
  if (has_folder) simulation->outer_forces();  // the log has their work from its first row on
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
  if (!has_folder) return;
  files.emplace(comm, options, loaded, *watchdog, *simulation, path, before);
  files->begin();
}

void HostedRun::Inner::check_goes_on(const char* what) const {
  if (!failed.empty()) throw UsageError("{}: the run has ended: {}. Restore a saved state, or close the engine", what, failed);
}

void HostedRun::Inner::check_moves(const char* what) const {
  check_goes_on(what);
  if (loaded.prepared->is_frozen()) throw UsageError("{}: heat.frozen keeps bodies as they are; leave it out of the case", what);
}

/// What makes the state meaningless is remembered.
template <class Action>
void HostedRun::Inner::guarded(Action&& action) {
  try {
    action();
  } catch (const std::exception& error) {
    failed = error.what();
    throw;
  }
}

void HostedRun::Inner::look_around() {
  if (!poll) return;
  const Clock::time_point now = Clock::now();
  if (std::chrono::duration<double>(now - polled).count() < poll_interval) return;
  polled = now;
  if (const int number = poll(); number != 0) simulation->requests().ask_to_stop(number);
}

int HostedRun::Inner::stopped() {
  const int code = static_cast<int>(ExitCode::signal_base) + simulation->requests().pending_signal();
  simulation->requests().stopped();
  return code;
}

int HostedRun::Inner::one_step() {
  look_around();
  if (files) {
    if (files->is_over())
      throw UsageError("step: the run in {} is over after {:g} s; a longer time.duration goes on", options.run_folder, simulation->time());
    int code = 0;
    guarded([&] { code = files->step(); });
    if (code != 0) simulation->requests().stopped();
    return code;
  }
  guarded([&] { simulation->advance(); });
  return simulation->requests().pending_signal() != 0 ? stopped() : 0;
}

HostedRun::HostedRun(const std::string& scene, MPI_Comm comm, const Options& options) {
  if (options.threads < 0)
    throw UsageError("threads = {}: expected a number >= 1, or 0 for a choice by the number of bodies", options.threads);
  in_ = std::make_unique<Inner>(scene, comm, options);
  in_->begin();
}

HostedRun::~HostedRun() = default;

void HostedRun::close() {
  if (in_->files && in_->failed.empty()) in_->files->leave();
  in_->files.reset();
}

int HostedRun::step(std::int64_t count) {
  if (count < 0) throw UsageError("step: {} steps: expected a number >= 0", count);
  in_->check_goes_on("step");
  int code = 0;
  for (std::int64_t k = 0; k < count && code == 0; ++k) code = in_->one_step();
  in_->guarded([&] { in_->simulation->agree_on_failures(); });
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
bool HostedRun::is_over() const { return in_->files && in_->files->is_over(); }
const Scene& HostedRun::scene() const { return in_->loaded.scene; }
std::int64_t HostedRun::body_count() const { return static_cast<std::int64_t>(in_->state().particles.owned); }

const double* HostedRun::reals(const std::string& field) { return in_->fields.reals(in_->loaded, in_->state(), field); }
const std::int64_t* HostedRun::integers(const std::string& field) { return in_->fields.integers(in_->state(), field); }

void HostedRun::hold(const std::vector<WrenchOnBody>& mine) {
  in_->check_moves("set_wrench");
  in_->simulation->outer_forces().hold(in_->change(), mine);
}

void HostedRun::release(const std::optional<std::vector<std::int64_t>>& mine) {
  in_->check_moves("clear_wrench");
  in_->simulation->outer_forces().release(in_->change(), mine);
}

int HostedRun::add_force(const ForceFunction& function, std::int64_t every) {
  in_->check_moves("add_force");
  const int number = in_->simulation->outer_forces().add(in_->change(), function, every);
  in_->forces.push_back({++in_->last_force, number, function, every});
  return in_->last_force;
}

void HostedRun::remove_force(int number) {
  in_->check_goes_on("remove_force");
  const auto at = std::find_if(in_->forces.begin(), in_->forces.end(), [number](const auto& f) { return f.number == number; });
  if (at == in_->forces.end())
    throw UsageError("remove_force: no function has the number {}; it was removed before, or never added", number);
  in_->simulation->outer_forces().remove(in_->change(), at->number_of_effect);
  in_->forces.erase(at);
}

std::vector<std::array<double, 6>> HostedRun::wall_loads() {
  std::vector<WallLoad> loads = wall_loads_of(in_->state());
  std::vector<WallState> walls = in_->state().walls;
  move_loads_to_world(loads, walls, in_->loaded.origin);
  std::vector<std::array<double, 6>> numbers;
  for (const WallLoad& load : loads)
    numbers.push_back({load.force.x, load.force.y, load.force.z, load.torque.x, load.torque.y, load.torque.z});
  return numbers;
}

std::array<double, 13> HostedRun::wall_state(std::size_t wall) const {
  const WallState& w = in_->state().walls[wall];
  const Vec3 at = wall_position_in_world(in_->loaded.scene.walls[wall], w, in_->loaded.origin);
  return {at.x,         at.y,         at.z,         w.orientation.w,      w.orientation.x,      w.orientation.y,     w.orientation.z,
          w.velocity.x, w.velocity.y, w.velocity.z, w.angular_velocity.x, w.angular_velocity.y, w.angular_velocity.z};
}

void HostedRun::drive_wall(std::size_t wall, double rate) {
  in_->check_moves("drive");
  const double others = in_->comm.max(rate), least = -in_->comm.max(-rate);
  if (others != least)
    throw UsageError("drive: ranks give wall '{}' different rates, {:g} and {:g}; give the same on every rank", scene().walls[wall].name,
                     least, others);
  in_->simulation->drive_wall(wall, rate);
}

std::pair<double, double> HostedRun::wall_way(std::size_t wall) const {
  const std::vector<DriveState>& drives = in_->state().drives;
  if (in_->loaded.prepared->drive(wall) == nullptr)
    throw UsageError("way: wall '{}' does not move by force or from outside; its place is its position", scene().walls[wall].name);
  return {drives[wall].way, drives[wall].rate};
}

Energies HostedRun::energies() { return energies_of(in_->state()); }
std::string HostedRun::state_hash() { return scree::state_hash(in_->state()); }
double HostedRun::critical_step() { return in_->simulation->critical_step().step; }

const FrameContacts& HostedRun::collect_contacts() {
  in_->contacts = in_->simulation->contacts();
  for (Vec3& point : in_->contacts.point) point += in_->loaded.origin;
  return in_->contacts;
}

std::shared_ptr<const HostedRun::State> HostedRun::save() {
  in_->check_goes_on("save");
  auto state = std::make_shared<State>();
  state->checkpoint = present_state(in_->comm, *in_->simulation);
  state->checkpoint.scene_sha256 = in_->loaded.sha256;
  state->checkpoint.step_limited_by = in_->state().clock.size.limited_by;
  for (const Inner::Force& f : in_->forces) {
    state->functions.push_back(f.number);
    if (f.every > 1) state->latest.emplace_back(f.number, in_->simulation->outer_forces().latest_of(f.number_of_effect));
  }
  return state;
}

void HostedRun::restore(const State& state) {
  if (in_->files)
    throw UsageError("restore: the engine writes a run folder, whose files would not be those of one run; open it without run");
  if (state.checkpoint.scene_sha256 != in_->loaded.sha256) throw UsageError("restore: the state is of another scene");
  in_->failed.clear();
  in_->guarded([&] {
    // a simulation starts once: another one takes its place
    in_->simulation.emplace(in_->comm, *in_->loaded.prepared, in_->options.parallel);
    Checkpoint copy = state.checkpoint;
    in_->simulation->start_from_records(copy.bodies, std::move(copy.states), copy.step, copy.step_size, copy.step_limited_by, copy.totals);
    const auto acted = [&](const Inner::Force& f) {
      return std::find(state.functions.begin(), state.functions.end(), f.number) != state.functions.end();
    };
    for (Inner::Force& f : in_->forces) {
      if (!acted(f)) continue;
      const auto latest = std::find_if(state.latest.begin(), state.latest.end(), [&](const auto& l) { return l.first == f.number; });
      f.number_of_effect = in_->simulation->outer_forces().add_restored(in_->change(), f.function, f.every,
                                                                        latest == state.latest.end() ? WrenchTable{} : latest->second);
    }
    for (Inner::Force& f : in_->forces)
      if (!acted(f)) f.number_of_effect = in_->simulation->outer_forces().add(in_->change(), f.function, f.every);
  });
}

void HostedRun::write_checkpoint(const std::string& folder) {
  in_->check_goes_on("write_checkpoint");
  Checkpoint so_far;
  so_far.origin = in_->loaded.origin;
  so_far.scene_sha256 = in_->loaded.sha256;
  const nlohmann::json provenance = provenance_of_run(in_->comm, in_->options, in_->loaded, "");
  scree::write_checkpoint(in_->comm, *in_->simulation, folder, so_far, provenance);
}

void HostedRun::write_frame(const std::string& path) {
  const bool with_contacts = in_->loaded.scene.settings.output_contacts && in_->failed.empty();
  Frame frame = make_frame(*in_->simulation, energies_of(in_->state()), in_->comm.rank(), with_contacts, in_->loaded.origin);
  frame.number = 0;
  frame.provenance = provenance_of_run(in_->comm, in_->options, in_->loaded, "");
  mpi::on_all(in_->comm, [&] { write_frame_file(in_->comm.get(), path, frame); });
}

std::vector<std::int64_t> HostedRun::insert(const std::vector<NewBody>& mine) {
  in_->check_moves("insert");
  const RunState& s = in_->state();
  std::vector<ParticleRecord> records;
  std::vector<std::int64_t> ids;
  std::int64_t before = 0, count = static_cast<std::int64_t>(mine.size());
  MPI_Exscan(&count, &before, 1, MPI_INT64_T, MPI_SUM, in_->comm.get());
  if (in_->comm.rank() == 0) before = 0;
  mpi::on_all(in_->comm, [&] {
    const Scene& scene = in_->loaded.scene;
    if (scene.settings.heat) throw UsageError("insert: a scene with heat takes bodies in by its inlets only");
    const std::vector<std::string> shapes = names_of(scene.shapes), materials = names_of(scene.materials);
    for (const NewBody& body : mine) {
      BodyAtStart b{};
      b.id = s.largest_id + 1 + before + static_cast<std::int64_t>(ids.size());
      b.shape = index_of(shapes, body.shape, "shape");
      b.material = index_of(materials, body.material, "material");
      b.scale = body.scale;
      b.position = body.position - in_->loaded.origin;
      b.orientation = body.orientation;
      b.velocity = body.velocity;
      b.angular_velocity = body.angular_velocity;
      const Quat& q = body.orientation;
      const double norm = q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z;
      if (!is_finite(b.position) || !is_finite(b.velocity) || !is_finite(b.angular_velocity) || !std::isfinite(norm))
        throw UsageError("insert: body {} of this call has a number that is not finite; check what it is computed from", ids.size());
      if (!(norm > 0))
        throw UsageError("insert: the quaternion of body {} of this call is 0; without a rotation it is 1 0 0 0", ids.size());
      if (!(b.scale > 0) || !std::isfinite(b.scale))
        throw UsageError("insert: body {} of this call has a scale of {:g}; expected a number > 0", ids.size(), b.scale);
      records.push_back(make_record(*in_->loaded.prepared, b));
      ids.push_back(b.id);
    }
  });
  in_->simulation->add_bodies(records);
  return ids;
}

void HostedRun::remove(const std::vector<std::int64_t>& mine) {
  in_->check_moves("remove");
  in_->simulation->remove_bodies(mine);
}

}  // namespace scree
