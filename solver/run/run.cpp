#include "solver/run/run.hpp"

#include <omp.h>
#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>

#include "core/base/progress.hpp"
#include "core/base/provenance.hpp"
#include "core/base/units.hpp"
#include "core/base/utf8.hpp"
#include "core/distance/triangle_distance.hpp"
#include "core/storage/collective_file.hpp"
#include "core/storage/h5.hpp"
#include "solver/run/checkpoint.hpp"
#include "solver/run/rank_log.hpp"
#include "solver/run/rest_watch.hpp"
#include "solver/run/run_folder.hpp"
#include "solver/run/run_log.hpp"
#include "solver/run/watchdog.hpp"
#include "solver/step/origin.hpp"

namespace scree {

namespace {

// The guard of the energy. A step above the critical one multiplies energy within tens of steps: a tenth of what there is tells
// it from the error of a coarse but stable step. Whatever the cause, a run in which half of all energy came from nowhere is worth nothing.
constexpr double kUnstableGain = 0.1, kAnyGain = 0.5;
// Damping and friction can only take. What they seem to give back at the turn of a contact is an error of the step, up to (omega h)^2 / 30
// of the energy: 5e-3 at 8 steps a contact. More than this of all that was in motion or stored is a force that works the wrong way.
constexpr double kMostReturned = 0.05;
constexpr double kEnergyRounding = 1e-12;  // of the potential energy, which cancels in the balance

/// How often things happen, in steps.
struct Schedule {
  std::int64_t last, frame, log, checkpoint;
};

/// in   longest_row   time that may lie between two rows of the log at most [s]
Schedule make_schedule(const Settings& settings, double dt, double longest_row) {
  const auto steps = [&](double interval) { return std::max<std::int64_t>(1, std::llround(interval / dt)); };
  Schedule s{};
  s.last = static_cast<std::int64_t>(std::ceil(settings.duration / dt - 1e-9));
  const double every = settings.output_every > 0 ? settings.output_every : settings.duration / 100;
  s.frame = every > 0 ? steps(every) : 1;
  constexpr std::int64_t kLogRowsPerFrame = 10;
  s.log = std::max<std::int64_t>(1, std::min(s.frame / kLogRowsPerFrame, static_cast<std::int64_t>(std::min(longest_row / dt, 0x1p53))));
  s.checkpoint = settings.checkpoint_every > 0 ? steps(settings.checkpoint_every) : 0;
  return s;
}

Frame make_frame(Simulation& simulation, const Energies& e, std::int64_t number, const nlohmann::json& provenance, int rank,
                 bool with_contacts, const Vec3& origin) {
  Frame frame;
  frame.number = number;
  frame.step = simulation.step();
  frame.time = simulation.time();
  frame.kinetic = e.translational + e.rotational;
  frame.potential = e.potential;
  frame.elastic = e.elastic + e.tangential_elastic;
  frame.dissipated = e.dissipated;
  frame.provenance = provenance;
  const ParticleSet& p = simulation.particles();
  for (std::size_t i = 0; i < p.owned; ++i) {
    frame.bodies.id.push_back(p.id[i]);
    frame.bodies.shape.push_back(p.shape[i]);
    frame.bodies.material.push_back(p.material[i]);
    frame.bodies.rank.push_back(rank);
    frame.bodies.scale.push_back(p.scale[i]);
    frame.bodies.position.push_back(p.x[i] + origin);
    frame.bodies.orientation.push_back(mesh_orientation(simulation.scene(), p.shape[i], p.q[i]));
    frame.bodies.velocity.push_back(p.v[i]);
    frame.bodies.angular_velocity.push_back(p.w[i]);
  }
  if (with_contacts) frame.contacts = simulation.contacts();
  for (Vec3& point : frame.contacts.point) point += origin;
  std::vector<WallLoad> loads = simulation.wall_loads();
  std::vector<WallState> walls = simulation.walls();
  move_loads_to_world(loads, walls, origin);
  for (std::size_t w = 0; w < loads.size(); ++w) {
    frame.walls.id.push_back(simulation.scene().source().walls[w].id);
    frame.walls.position.push_back(wall_position_in_world(simulation.scene().source().walls[w], simulation.walls()[w], origin));
    frame.walls.orientation.push_back(simulation.walls()[w].orientation);
    frame.walls.force.push_back(loads[w].force);
    frame.walls.torque.push_back(loads[w].torque);
  }
  return frame;
}

std::int64_t peak_memory() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::int64_t>(usage.ru_maxrss) * 1024;
}

/// Bytes held for a body and for a ghost, pairs and their candidates included.
nlohmann::json memory_json(const std::vector<RankMeasures>& ranks) {
  double bodies = 0, ghosts = 0, body_bytes = 0, ghost_bytes = 0;
  for (const RankMeasures& m : ranks) {
    bodies += static_cast<double>(m.bodies);
    ghosts += static_cast<double>(m.ghosts);
    body_bytes += static_cast<double>(m.body_bytes);
    ghost_bytes += static_cast<double>(m.ghost_bytes);
  }
  return {{"bytes_per_body", bodies > 0 ? body_bytes / bodies : 0.0}, {"bytes_per_ghost", ghosts > 0 ? ghost_bytes / ghosts : 0.0}};
}

}  // namespace

LoadedScene load_scene(const mpi::Communicator& comm, const std::string& path) {
  LoadedScene loaded;
  const auto read = [&] {
    loaded.scene = read_scene_file(path);
    loaded.sha256 = sha256_of_file(path);
    loaded.origin = choose_origin(loaded.scene);
    move_scene(loaded.scene, loaded.origin);
    loaded.prepared = std::make_unique<SolverScene>(loaded.scene);
  };
  mpi::on_root(comm, read);
  // each other rank reads for itself, perhaps on another machine: what fails there, or is another file, all must know of
  const std::string sha256 = broadcast_text(comm.get(), loaded.sha256);
  mpi::on_all(comm, [&] {
    if (comm.rank() == 0) return;
    try {
      read();
    } catch (const Error& e) {
      throw Error(e.code(), fmt::format("{} (rank {}; rank 0 can read it)", e.what(), comm.rank()));
    }
    if (loaded.sha256 != sha256)
      throw InputError("{}: rank {} finds another file of this name than rank 0; use a path that is the same everywhere", path,
                       comm.rank());
  });
  return loaded;
}

int run_scene(const mpi::Communicator& comm, const RunOptions& options) {
  catch_signals();
  const LoadedScene loaded = load_scene(comm, options.scene_path);
  const Scene& scene = loaded.scene;
  const std::string& scene_hash = loaded.sha256;
  const Settings& settings = scene.settings;
  const bool root = comm.rank() == 0;

  // Whatever refuses this run comes before its folder is touched: see open_run_folder() below.
  const bool newest = options.restart == "latest" || options.restart == "auto";
  std::unique_ptr<FolderLock> lock;
  std::int64_t complete = -1;
  mpi::on_root(comm, [&] {
    const auto look = [&] {
      check_run_folder(options.run_folder, options.scene_path, scene_hash, options.restart);
      if (!options.restart.empty()) complete = completed_at(options.run_folder).value_or(-1);
    };
    look();
    if (newest && complete >= 0) return;
    lock = std::make_unique<FolderLock>(options.run_folder);
    look();  // the solver that had the lock before may have gone on since
  });
  MPI_Bcast(&complete, 1, MPI_INT64_T, 0, comm.get());
  const auto nothing_left = [&] {
    if (root)
      std::fprintf(stderr, "scree-solver: %s: complete at step %lld; nothing is left to do, and nothing was changed\n",
                   options.run_folder.c_str(), static_cast<long long>(complete));
    return 0;
  };
  if (newest && complete >= 0) return nothing_left();

  bool restarted = !options.restart.empty();
  if (options.restart == "auto") {
    int found = 0;
    mpi::on_root(comm, [&] { found = list_checkpoints(options.run_folder).empty() ? 0 : 1; });
    MPI_Bcast(&found, 1, MPI_INT, 0, comm.get());
    restarted = found != 0;
  }
  Checkpoint checkpoint;
  if (restarted) {
    checkpoint = newest ? read_latest_checkpoint(comm, options.run_folder) : read_checkpoint(comm, options.restart);
  }
  mpi::on_root(comm, [&] {
    if (restarted && checkpoint.scene_sha256 != scene_hash) {
      throw InputError("--restart {}: was made from another scene than {}; give the scene it came from", checkpoint.path,
                       options.scene_path);
    }
    if (scene.partition.ranks > 0 && scene.partition.ranks != comm.size()) {
      warn_once("scree-solver",
                fmt::format("the scene is cut for {} ranks, this run has {}: it is cut again", scene.partition.ranks, comm.size()));
    }
    for (const std::string& gap : loaded.prepared->seam_gaps()) warn_once("scree-solver", gap);
  });
  if (restarted && checkpoint.step == complete) return nothing_left();

  Watchdog watchdog(comm, options.stall_limit, options.stalled);
  Simulation simulation(comm, *loaded.prepared, options.parallel);
  const std::string checkpoint_path = checkpoint.path;
  const RunRecord before = checkpoint.record;  // of the parts of this run before this one
  double max_ratio = before.max_overlap_ratio, kinetic_peak = before.kinetic_peak, worst_balance = before.energy_error;
  double reference = before.energy_reference, elastic_peak = before.elastic_peak, dissipated_peak = before.dissipated_peak;
  CriticalStep stiffest = before.stiffest;  // of all log rows
  if (restarted) {
    start_from_checkpoint(comm, simulation, std::move(checkpoint), loaded.origin);
  } else {
    simulation.start_from_scene();
  }
  const double dt = simulation.step_size().step;
  constexpr double kMostSteps = 0x1p53;  // counted exactly everywhere
  mpi::on_root(comm, [&] {
    if (settings.duration / dt < kMostSteps) return;
    throw InputError("{}: {:g} s in steps of {:.3g} s ({}) are more steps than can be counted; check density, stiffness and sizes",
                     options.scene_path, settings.duration, dt, simulation.step_size().limited_by);
  });
  const double unevenness = simulation.step_size().slowest_contact_time / std::max(simulation.step_size().contact_time, dt);
  if (unevenness > kUnevenContacts && comm.rank() == 0) {
    warn_once("scree-solver",
              fmt::format("{} sets the step, and the contact of the heaviest body lasts {:.0f} times as long: a mass ratio that "
                          "costs as many times the steps; a softer pair or a larger light body makes the run shorter",
                          simulation.step_size().limited_by, unevenness));
  }
  std::optional<RestWatch> watch;
  mpi::on_all(comm, [&] { watch.emplace(scene); });
  RestWatch& rest = *watch;
  const Schedule schedule = make_schedule(settings, dt, rest.row_interval());
  if (root && rest.is_active() && rest.walls_stop() >= settings.duration) {
    warn_once("scree-solver",
              fmt::format("time.stop_at_rest: a wall moves until the end ({}), so that nothing comes to rest before; give its motion a "
                          "stop, or leave stop_at_rest out",
                          format_quantity(settings.duration, Dimension::time)));
  }

  Provenance record;
  record.format = kFrameFormat;
  record.format_version = kFrameFormatVersion;
  record.tool = "scree-solver";
  record.command = options.command;
  record.inputs = {{options.scene_path, scene_hash, scene.provenance}};
  std::string checkpoint_hash;
  mpi::on_root(comm, [&] {
    if (restarted) checkpoint_hash = sha256_of_file(checkpoint_path);
  });
  if (restarted) record.inputs.push_back({checkpoint_path, checkpoint_hash, nullptr});
  record.seed = settings.seed;
  record.ranks = comm.size();
  record.threads = omp_get_max_threads();
  record.instruction_set = simd_target();
  const nlohmann::json provenance = provenance_record(record);

  std::vector<FrameEntry> frames;
  std::unique_ptr<RunLog> log;
  std::unique_ptr<RankLog> rank_log;
  const std::string log_path = options.run_folder + "/log.csv", ranks_path = options.run_folder + "/ranks.csv";
  const std::string removed_path = options.run_folder + "/removed.csv", steps_path = options.run_folder + "/steps.csv";
  const bool quantised = settings.step_control == StepControl::quantised;
  const bool removes = settings.domain.bounded && settings.domain.outside == Outside::remove;
  std::vector<std::string> tables{log_path, ranks_path};
  if (quantised) tables.push_back(steps_path);
  if (removes) tables.push_back(removed_path);
  mpi::on_root(comm, [&] {
    open_run_folder(options.run_folder, options.scene_path);
    frames = trim_run_folder(options.run_folder, {schedule.frame, schedule.last, dt}, restarted ? simulation.step() : -1);
    log = std::make_unique<RunLog>(log_path, scene, restarted ? simulation.step() : -1);
    rank_log = std::make_unique<RankLog>(ranks_path, comm.size(), restarted ? simulation.step() : -1);
    if (quantised) start_table(steps_path, step_header(), restarted ? simulation.step() : -1);
    if (restarted) rest.read_log(log_path);
    if (removes) start_table(removed_path, removed_header(), restarted ? simulation.step() : -1);
  });
  if (restarted) MPI_Bcast(&rest.last_busy(), 1, MPI_DOUBLE, 0, comm.get());
  if (root) {
    std::fprintf(stderr, "scree-solver: %zu bodies, %d ranks x %d threads, step %s (%s), %lld steps\n", scene.bodies.size(), comm.size(),
                 omp_get_max_threads(), format_quantity(dt, Dimension::time).c_str(),
                 simulation.step_size().given ? "given" : ("limited by " + simulation.step_size().limited_by).c_str(),
                 static_cast<long long>(schedule.last));
  }

  const auto start = std::chrono::steady_clock::now();
  auto interval_start = start;
  const std::int64_t first_step = simulation.step();
  std::int64_t interval_step = first_step;
  // after a restart the forces of the last step are not known before the next one
  Energies energies = before.log_rows > 0 ? before.energies : simulation.energies();
  if (!restarted) reference = energies.balance();
  double imbalance_sum = before.imbalance_sum;
  std::int64_t log_rows = before.log_rows;

  const auto seconds_since = [](std::chrono::steady_clock::time_point t) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - t).count();
  };
  const auto timed_output = [&](auto&& action) {
    const auto begin = std::chrono::steady_clock::now();
    action();
    watchdog.progress(simulation.step());
    simulation.times()[static_cast<std::size_t>(Phase::output)] += seconds_since(begin);
  };
  const auto record_so_far = [&] {  // collective
    RunRecord run = before;
    run.energy_reference = reference;
    run.kinetic_peak = kinetic_peak;
    run.elastic_peak = elastic_peak;
    run.dissipated_peak = dissipated_peak;
    run.energy_error = worst_balance;
    run.max_overlap_ratio = max_ratio;
    run.stiffest = stiffest;
    run.energies = energies;
    run.imbalance_sum = imbalance_sum;
    run.log_rows = log_rows;
    run.list_renewals += simulation.list_rebuilds();
    run.cuts += simulation.cuts();
    run.migrated += simulation.migrated();
    const RankMeasures mine = simulation.rank_measures();
    run.bytes_sent += comm.sum(mine.bytes + mine.rebuild_bytes);
    run.peak_memory = std::max(run.peak_memory, comm.sum(peak_memory()));
    run.wall_seconds += seconds_since(start);
    PhaseTimes times = simulation.times();
    MPI_Allreduce(MPI_IN_PLACE, times.data(), static_cast<int>(times.size()), MPI_DOUBLE, MPI_SUM, comm.get());
    for (std::size_t p = 0; p < times.size(); ++p) run.phases[p] += times[p] / comm.size();
    return run;
  };
  /// Measures as log.csv has them: since the start of the run. An earlier part counts with the mean of its ranks, which may have been
  /// others.
  const auto since_start = [&](std::vector<RankMeasures> ranks) {
    for (RankMeasures& m : ranks) {
      for (std::size_t p = 0; p < m.times.size(); ++p) m.times[p] += before.phases[p];
    }
    if (!ranks.empty()) ranks[0].bytes += before.bytes_sent;
    return ranks;
  };
  const auto write_events = [&] {
    if (quantised) {
      const std::string rows = step_rows(simulation.take_step_changes());
      mpi::on_root(comm, [&] { append_to_table(steps_path, rows); });
    }
    if (!removes) return;
    std::vector<RemovedBody> bodies = simulation.take_removed();
    for (RemovedBody& b : bodies) b.x += loaded.origin;
    mpi::on_root(comm, [&] { append_to_table(removed_path, removed_rows(bodies)); });
  };
  const auto guard_energy = [&](double error) {
    const double scale = std::max({kinetic_peak, energies.dissipated, elastic_peak, std::abs(energies.wall_work)}) +
                         kEnergyRounding * std::abs(energies.potential);
    // a fluid that streams gives energy as well
    const bool streams = settings.fluid && squared_length(settings.fluid->velocity) > 0;
    const double returned = streams ? 0 : dissipated_peak - energies.dissipated;
    if (returned > kMostReturned * scale)
      mpi::on_root(comm, [&] {
        throw RunInvalid(
            "step {}: damping and friction gave back {:.3g} J, {:.2g} of all that was in motion or stored; they can only take energy. "
            "The step {:.4g} s is too long for the damping of the contacts that there are: reduce the step, or raise the restitution",
            simulation.step(), returned, returned / scale, simulation.substep_size());
      });
    const bool unstable = simulation.substep_size() > stiffest.step && error > kUnstableGain * scale;
    const bool gains = error - simulation.shadow_energy_gap() > kAnyGain * scale;
    if (!unstable && !gains) return;
    const auto fastest = simulation.fastest_body();
    mpi::on_root(comm, [&] {
      throw RunInvalid(
          "step {}: energy grew by {:.3g} J, {:.2g} of all that was in motion or stored, without a cause; body {} has the most, {:.3g} J. "
          "The critical step of {} is {:.4g} s, the step is {:.4g} s{}",
          simulation.step(), error, error / scale, fastest.first, fastest.second, stiffest.name(), stiffest.step, simulation.substep_size(),
          unstable ? ": reduce the step or the stiffness" : "; see the integrator and the contact law");
    });
  };
  // before the first step, and whenever the run may end
  const auto look_for_rest = [&] {
    if (rest.is_active()) rest.look(comm.max(rest.busiest(simulation.particles())), simulation.body_count());
  };
  const auto write_log = [&] {
    simulation.agree_on_failures();
    write_events();
    energies = simulation.energies();
    const double kinetic = energies.translational + energies.rotational;
    kinetic_peak = std::max(kinetic_peak, kinetic);
    dissipated_peak = std::max(dissipated_peak, energies.dissipated);
    rest.add(simulation.time(), kinetic);
    elastic_peak = std::max(elastic_peak, energies.elastic + energies.tangential_elastic);
    const double error = energies.balance() - reference;
    worst_balance = std::max(worst_balance, std::abs(error));
    const double ratio = simulation.take_max_overlap_ratio(), imbalance = simulation.take_imbalance();
    max_ratio = std::max(max_ratio, ratio);
    imbalance_sum += imbalance;
    ++log_rows;
    const std::int64_t contacts = simulation.contact_count();
    std::vector<WallLoad> loads = simulation.wall_loads();
    std::vector<WallState> walls = simulation.walls();
    move_loads_to_world(loads, walls, loaded.origin);
    const std::string hash = simulation.state_hash();
    const std::vector<RankMeasures> ranks = gather_measures(comm, simulation.rank_measures());
    const RemovedTotals removed = simulation.removed();
    const CriticalStep critical = simulation.critical_step();
    if (critical.step < stiffest.step) stiffest = critical;
    const double elapsed = seconds_since(interval_start);
    const double rate = elapsed > 0 ? static_cast<double>(simulation.step() - interval_step) / elapsed : 0;
    interval_start = std::chrono::steady_clock::now();
    interval_step = simulation.step();
    mpi::on_root(comm, [&] {
      log->add_row(simulation.step(), simulation.time(), energies, error, contacts, ratio, imbalance, since_start(ranks), rate, removed,
                   critical.step, loads, walls, hash);
      rank_log->add_rows(simulation.step(), ranks, simulation.step() == schedule.last || rest.at_rest(simulation.time()));
      if (simulation.substep_size() > critical.step) {
        warn_once("scree-solver",
                  fmt::format("the step {:.4g} s is above the critical step of the contacts that there are; see critical_step in "
                              "log.csv; the run ends when their energy grows",
                              simulation.substep_size()));
      }
    });
    guard_energy(error);
  };
  const auto write_frame = [&](std::int64_t number, bool is_valid = true) {
    if (is_valid) simulation.agree_on_failures();
    const std::string path = options.run_folder + "/" + frame_name(number);
    const Frame frame =
        make_frame(simulation, simulation.energies(), number, provenance, comm.rank(), is_valid && settings.output_contacts, loaded.origin);
    mpi::on_all(comm, [&] { write_frame_file(comm.get(), path, frame); });
    mpi::on_root(comm, [&] {
      std::erase_if(frames, [&](const FrameEntry& entry) { return entry.path == path; });  // a run that became invalid after its last frame
      frames.push_back({path, simulation.time()});
      write_frame_series(options.run_folder, frames);
    });
  };
  auto last_checkpoint = start;
  const bool by_clock = settings.checkpoint_every == 0 && settings.checkpoint_by_clock && options.checkpoint_interval > 0;
  const auto save_state = [&] {
    simulation.agree_on_failures();
    write_events();
    // a restart keeps the rows up to its step: they must be on the disk before the checkpoint counts; frames are when they have their names
    mpi::on_root(comm, [&] {
      for (const std::string& table : tables) sync_table(table);
    });
    Checkpoint so_far;
    so_far.record = record_so_far();
    so_far.origin = loaded.origin;
    so_far.scene_sha256 = scene_hash;
    write_checkpoint(comm, simulation, options.run_folder, so_far, provenance);
    simulation.checkpoint_written();
    last_checkpoint = std::chrono::steady_clock::now();
  };
  const auto write_outcome = [&](const std::string& outcome, const std::string& message, int exit_code) {
    const std::string hash = simulation.state_hash();
    const RemovedTotals removed = simulation.removed();
    const std::int64_t bodies = simulation.body_count(), outside = simulation.bodies_outside();
    const RunRecord whole = record_so_far();
    const std::vector<RankMeasures> ranks = gather_measures(comm, simulation.rank_measures());
    mpi::on_root(comm, [&] {
      nlohmann::json run;
      run["format"] = "scree-run";
      run["format_version"] = 1;
      run["outcome"] = outcome;
      run["message"] = message;
      run["exit_code"] = exit_code;
      run["steps"] = simulation.step();
      run["step_size"] = dt;
      run["step_limited_by"] = simulation.step_size().limited_by;
      run["critical_step"] = std::isfinite(stiffest.step) ? nlohmann::json(stiffest.step) : nlohmann::json();
      run["critical_contact"] = stiffest.name();
      run["time"] = simulation.time();
      if (settings.stop_at_rest) run["came_to_rest"] = rest.at_rest(simulation.time());
      if (bodies == 0) run["no_body_left"] = true;
      run["state_hash"] = hash;
      run["ranks"] = comm.size();
      run["threads"] = omp_get_max_threads();
      run["bodies"] = bodies;
      run["removed_bodies"] = static_cast<std::int64_t>(removed.count);
      run["removed_mass"] = removed.mass;
      run["lost_bodies"] = static_cast<std::int64_t>(scene.bodies.size()) - bodies - static_cast<std::int64_t>(removed.count);
      run["bodies_outside_domain"] = outside;
      run["wall_seconds"] = whole.wall_seconds;
      for (std::size_t i = 0; i < whole.phases.size(); ++i) run["phases"][phase_name(static_cast<Phase>(i))] = whole.phases[i];
      run["max_depth_ratio"] = max_ratio;
      run["mean_imbalance"] = log_rows > 0 ? imbalance_sum / static_cast<double>(log_rows) : 1.0;
      run["list_renewals"] = whole.list_renewals;
      run["cuts"] = whole.cuts;
      run["migrated_bodies_rank_0"] = whole.migrated;
      const double scale = std::max(kinetic_peak, energies.dissipated);
      run["energy"] = {{"initial_balance", reference},
                       {"kinetic_peak", kinetic_peak},
                       {"kinetic_final", energies.translational + energies.rotational},
                       {"potential_final", energies.potential},
                       {"elastic_final", energies.elastic + energies.tangential_elastic},
                       {"dissipated", energies.dissipated},
                       {"wall_work", energies.wall_work},
                       {"removed", energies.removed},
                       {"error_max", worst_balance},
                       {"error_relative", scale > 0 ? worst_balance / scale : 0.0}};
      run["peak_rss_bytes"] = whole.peak_memory;
      run["memory"] = memory_json(ranks);
      run["parallel"] = {{"halo", options.parallel.strategy == HaloStrategy::overlap ? "overlap" : "blocking"},
                         {"send", options.parallel.selection == HaloSelection::all ? "all" : "selected"},
                         {"cut", cut_method_name(options.parallel.cut)}};
      Scene as_given = scene;
      move_scene(as_given, -loaded.origin);
      run["settings"] = settings_json(as_given);
      run["provenance"] = provenance;
      h5::write_text_file(options.run_folder + "/run.json", json_text(run, 1) + "\n");
    });
  };

  std::unique_ptr<Progress> progress;
  if (root) progress = std::make_unique<Progress>("solver", static_cast<double>(std::max<std::int64_t>(1, schedule.last)));
  if (!restarted) {
    timed_output(write_log);
    timed_output([&] { write_frame(0); });
  }
  try {
    const auto is_over = [&] {
      return simulation.step() >= schedule.last ||
             (simulation.step() % schedule.frame == 0 && (rest.at_rest(simulation.time()) || (rest.is_active() && rest.is_empty())));
    };
    look_for_rest();
    while (!is_over()) {
      if (by_clock && root && seconds_since(last_checkpoint) >= options.checkpoint_interval) simulation.ask_for_checkpoint();
      simulation.advance();
      watchdog.progress(simulation.step());
      const std::int64_t n = simulation.step();
      if (n % schedule.frame == 0 || n == schedule.last) look_for_rest();
      if (n % schedule.log == 0 || n == schedule.last) timed_output(write_log);
      // before the last checkpoint, after which only the outcome is missing
      if (n % schedule.frame == 0 || n == schedule.last) timed_output([&] { write_frame((n + schedule.frame - 1) / schedule.frame); });
      if (simulation.pending_signal() != 0) {
        save_state();
        max_ratio = std::max(max_ratio, simulation.take_max_overlap_ratio());
        const int code = static_cast<int>(ExitCode::signal_base) + simulation.pending_signal();
        write_outcome("interrupted", fmt::format("signal {} at step {}; continue with --restart latest", simulation.pending_signal(), n),
                      code);
        if (root) progress->finish(fmt::format("stopped by signal {} at step {}; a checkpoint was kept", simulation.pending_signal(), n));
        return code;
      }
      if ((schedule.checkpoint > 0 && n % schedule.checkpoint == 0) || simulation.is_checkpoint_asked() || is_over())
        timed_output(save_state);
      if (root) {
        progress->update(static_cast<double>(n),
                         fmt::format("t = {}, kinetic {:.3g} J", format_quantity(simulation.time(), Dimension::time),
                                     energies.translational + energies.rotational));
      }
    }
  } catch (const mpi::AgreedError& e) {
    // Every rank is here: keep the state and the reason.
    if (e.code() == ExitCode::run_invalid) {
      const double ratio = simulation.take_max_overlap_ratio();
      max_ratio = std::max(max_ratio, ratio);
      // the last state as a frame without contacts, to be looked at; a restart goes on from the checkpoint before it
      write_frame(simulation.step() / schedule.frame + 1, false);
      write_outcome("invalid", e.what(), static_cast<int>(e.code()));
    }
    throw;
  }
  const std::string nobody = simulation.body_count() > 0 ? ""
                             : scene.bodies.size() == 0  ? "the scene has no body"
                                                         : "no body is left: all left the domain";
  write_outcome("completed", nobody, 0);
  if (root) {
    const double elapsed = seconds_since(start);
    if (!nobody.empty()) std::fprintf(stderr, "scree-solver: %s\n", nobody.c_str());
    progress->finish(fmt::format(
        "{} steps, {:.0f} particle-steps/s, overlap/margin at most {:.3f}, energy balance to {:.2g}", simulation.step(),
        static_cast<double>(scene.bodies.size()) * static_cast<double>(simulation.step() - first_step) / std::max(elapsed, 1e-9), max_ratio,
        worst_balance / std::max({kinetic_peak, energies.dissipated, 1e-300})));
  }
  return 0;
}

}  // namespace scree
