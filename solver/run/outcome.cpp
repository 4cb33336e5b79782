#include "solver/run/outcome.hpp"

#include <omp.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>

#include "core/base/utf8.hpp"
#include "core/storage/h5.hpp"
#include "solver/effects/outer_forces/outer_forces.hpp"
#include "solver/effects/wear/wear.hpp"
#include "solver/run/guard.hpp"
#include "solver/run/idle_servos.hpp"
#include "solver/run/inflow.hpp"
#include "solver/scene/origin.hpp"

namespace scree {

namespace {

nlohmann::json energy_json(const RunRecord& record, const Scene& scene) {
  const Energies& e = record.energies;
  nlohmann::json j{{"initial_balance", record.energy_reference},
                   {"kinetic_peak", record.kinetic_peak},
                   {"kinetic_final", e.translational + e.rotational},
                   {"potential_final", e.potential},
                   {"elastic_final", e.elastic + e.tangential_elastic},
                   {"dissipated", e.dissipated},
                   {"wall_work", e.wall_work},
                   {"removed", e.removed},
                   {"error_max", record.energy_error},
                   {"error_relative", relative_energy_error(record.energy_error, record.in_play(), scene)}};
  if (e.arrived != 0) j["inserted"] = e.arrived;
  if (e.outer_work != 0) j["outer_work"] = e.outer_work;
  if (e.cell_work != 0) j["cell_work"] = e.cell_work;
  return j;
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

/// What an inlet was to bring in by its rate, count and limit, in the unit of its rate. A limit in the other unit is converted by the mean
/// mass of what has come in, or of what is to come.
double owed_at(const Scene& scene, const Inlet& inlet, const InletState& state, double time) {
  const double mean = state.count > 0 ? state.mass / static_cast<double>(state.count) : mean_mass(scene, inlet);
  const double number = inflow_by(inlet, mean, time);
  return inlet.rate.by_number ? number : number * mean;
}

/// Of that, what has found no room. To one body the rate is met: only what found no room is missing.
double shortfall_of(const Inlet& inlet, const InletState& state, double owed) {
  const double had = inlet.rate.by_number ? static_cast<double>(state.count) : state.mass;
  return state.is_blocked != 0 ? std::max(0.0, owed - had) : 0.0;
}

nlohmann::json inlet_json(const Scene& scene, const Inlet& inlet, const InletState& state, double time) {
  const double owed = owed_at(scene, inlet, state, time);
  nlohmann::json j;
  j["name"] = inlet.name;
  j["bodies"] = state.count;
  j["mass"] = state.mass;
  j["owed"] = owed;
  j["shortfall"] = shortfall_of(inlet, state, owed);
  j["came_in_again"] = state.returned;
  j["in_transit"] = state.queue.size();
  j["times_blocked"] = state.blocked_looks;
  j["first_blocked"] = state.first_blocked < 0 ? nlohmann::json() : nlohmann::json(state.first_blocked);
  return j;
}

/// Of the walls that wear; each is written as a shape, as it is at the end.
nlohmann::json worn_walls(const Scene& scene, const std::vector<WornWall>& worn, const std::string& folder,
                          const nlohmann::json& provenance) {
  nlohmann::json walls;
  for (const WornWall& w : worn) {
    const Wall& wall = scene.walls[w.wall];
    const std::string file = fmt::format("wall{}_worn.shape.h5", wall.id);
    write_shape_file(folder + "/" + file, {make_surface(wall.name, w.mesh)}, provenance);
    walls.push_back({{"wall", wall.id}, {"name", wall.name}, {"volume", w.volume}, {"depth", w.depth}, {"file", file}});
    if (w.fault.empty()) continue;
    walls.back()["fault"] = w.fault;
    warn_once(
        "scree-solver",
        fmt::format("the file of wall '{}' is without what slid on it since it was last worn, which run.json counts: {}; give its wear a "
                    "shorter `every`",
                    wall.name, w.fault));
  }
  return walls;
}

/// What the columns wallID_... of log.csv are of.
nlohmann::json walls_json(const Scene& scene) {
  nlohmann::json walls = nlohmann::json::array();
  for (const Wall& wall : scene.walls) walls.push_back({{"wall", wall.id}, {"name", wall.name}});
  return walls;
}

/// Contacts deeper than their maximum overlap, which the run went on with.
nlohmann::json deep_json(const RunState& s, const DeepTotals& t, const Vec3& origin) {
  const double step = s.clock.size.step;
  nlohmann::json j{{"contacts", t.contacts}, {"contact_steps", t.contact_steps}};
  if (t.contact_steps == 0) return j;
  j["first"] = static_cast<double>(t.first_step) * step;
  j["last"] = static_cast<double>(t.last_step) * step;
  const Vec3 place = t.place + origin;
  nlohmann::json deepest{{"overlap", t.overlap},
                         {"excess", t.excess},
                         {"time", static_cast<double>(t.step) * step},
                         {"place", {place.x, place.y, place.z}},
                         {"body", t.key.a}};
  if (t.key.zone < 0)
    deepest["other_body"] = t.key.b;
  else
    deepest["wall"] = s.scene.source().walls[static_cast<std::size_t>(s.scene.zones()[static_cast<std::size_t>(t.key.zone)].wall)].name;
  j["deepest"] = std::move(deepest);
  j["text"] = text_of(s.scene, t, step);
  return j;
}

/// What was measured while it ran.
void add_measures(nlohmann::json& run, const RunRecord& record) {
  run["wall_seconds"] = record.wall_seconds;
  for (std::size_t i = 0; i < record.phases.size(); ++i) run["phases"][phase_name(static_cast<Phase>(i))] = record.phases[i];
  run["max_depth_ratio"] = record.max_overlap_ratio;
  run["mean_imbalance"] = record.log_rows > 0 ? record.imbalance_sum / static_cast<double>(record.log_rows) : 1.0;
  run["list_renewals"] = record.list_renewals;
  run["cuts"] = record.cuts;
  run["migrated_bodies_rank_0"] = record.migrated;
  run["peak_rss_bytes"] = record.peak_memory;
}

}  // namespace

std::vector<std::string> blocked_inlets(const Scene& scene, const RunState& state) {
  std::vector<std::string> lines;
  for (std::size_t k = 0; k < scene.inlets.size(); ++k) {
    const Inlet& inlet = scene.inlets[k];
    const InletState& now = state.totals.inlets[k];
    const double owed = owed_at(scene, inlet, now, state.clock.time()), missing = shortfall_of(inlet, now, owed);
    if (missing > 0)
      lines.push_back(fmt::format("inlet '{}': {:.4g} of {:.4g} {} did not come in: the inlet was blocked to the end", inlet.name, missing,
                                  owed, inlet.rate.by_number ? "bodies" : "kg"));
  }
  return lines;
}

void write_outcome(const mpi::Communicator& comm, const Outcome& outcome, const RunOptions& options, const LoadedScene& loaded,
                   Simulation& simulation, const RunRecord& record, const RestWatch& rest, const nlohmann::json& provenance) {
  const std::string hash = state_hash(simulation.state());
  const RemovedTotals removed = removed_totals(simulation.state());
  const std::vector<RemovedTotals> by_outlet = outlet_totals(simulation.state());
  const RemovedTotals arrived = arrived_totals(simulation.state());
  const std::int64_t bodies = body_count(simulation.state()), outside = bodies_outside(simulation.state());
  const std::int64_t free = free_body_count(simulation.state());
  const auto* const outer = simulation.state().effect<OuterForces>();
  const std::int64_t held = outer == nullptr ? 0 : outer->held_count(simulation.state());
  const bool continues = simulation.state().scene.continues();
  const DeepTotals deep = continues ? over_ranks(comm.get(), simulation.state().totals.deep) : DeepTotals{};
  const auto* const wear = simulation.state().effect<Wear>();
  const std::vector<WornWall> worn = wear == nullptr ? std::vector<WornWall>{} : wear->at_end(simulation.state());
  const std::vector<RankMeasures> ranks = gather_measures(comm, rank_measures(simulation));
  mpi::on_root(comm, [&] {
    nlohmann::json run;
    run["format"] = "scree-run";
    run["format_version"] = 1;
    run["outcome"] = outcome.outcome;
    run["message"] = outcome.message;
    run["exit_code"] = outcome.exit_code;
    run["steps"] = simulation.step();
    run["step_size"] = simulation.state().clock.size.step;
    run["step_limited_by"] = simulation.state().clock.size.limited_by;
    run["critical_step"] = std::isfinite(record.stiffest.step) ? nlohmann::json(record.stiffest.step) : nlohmann::json();
    run["critical_contact"] = name_of(record.stiffest, *loaded.prepared);
    run["time"] = simulation.time();
    if (loaded.scene.settings.stop_at_rest) run["came_to_rest"] = rest.at_rest(simulation.time());
    if (bodies == 0 || (loaded.scene.settings.stop_when_empty && free == 0)) run["no_body_left"] = true;
    run["state_hash"] = hash;
    run["ranks"] = comm.size();
    run["threads"] = omp_get_max_threads();
    run["slowdown"] = outcome.slowdown;
    run["bodies"] = bodies;
    run["walls"] = walls_json(loaded.scene);
    run["removed_bodies"] = static_cast<std::int64_t>(removed.count);
    run["removed_mass"] = removed.mass;
    for (std::size_t k = 0; k < by_outlet.size(); ++k) {
      run["outlets"].push_back(
          {{"name", loaded.scene.outlets[k].name}, {"bodies", static_cast<std::int64_t>(by_outlet[k].count)}, {"mass", by_outlet[k].mass}});
    }
    if (!loaded.scene.inlets.empty() || options.has_program) {
      run["inserted_bodies"] = static_cast<std::int64_t>(arrived.count);
      run["inserted_mass"] = arrived.mass;
    }
    if (options.has_program && outer != nullptr) run["program"] = {{"force_functions", outer->function_names()}, {"held_bodies", held}};
    for (std::size_t k = 0; k < loaded.scene.inlets.size(); ++k)
      run["inlets"].push_back(inlet_json(loaded.scene, loaded.scene.inlets[k], simulation.state().totals.inlets[k], simulation.time()));
    if (continues) run["deep_contacts"] = deep_json(simulation.state(), deep, loaded.origin);
    if (nlohmann::json drives = drives_json(simulation.state()); !drives.empty()) run["drives"] = std::move(drives);
    if (!worn.empty()) run["wear"] = worn_walls(simulation.state().scene.source(), worn, options.run_folder, provenance);
    run["lost_bodies"] = static_cast<std::int64_t>(loaded.scene.bodies.size()) + static_cast<std::int64_t>(arrived.count) - bodies -
                         static_cast<std::int64_t>(removed.count);
    run["bodies_outside_domain"] = outside;
    add_measures(run, record);
    run["energy"] = energy_json(record, loaded.scene);
    run["memory"] = memory_json(ranks);
    run["parallel"] = {{"halo", options.parallel.strategy == HaloStrategy::overlap ? "overlap" : "blocking"},
                       {"send", options.parallel.selection == HaloSelection::all ? "all" : "selected"},
                       {"cut", cut_method_name(options.parallel.cut)}};
    Scene as_given = loaded.scene;
    move_scene(as_given, -loaded.origin);
    run["settings"] = settings_json(as_given);
    if (loaded.start) run["start"] = start_json(*loaded.start);
    run["provenance"] = provenance;
    h5::write_text_file(options.run_folder + "/run.json", json_text(run, 1) + "\n");
  });
}

}  // namespace scree
