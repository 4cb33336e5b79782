#include "solver/run/run_log.hpp"

#include <algorithm>
#include <string_view>

#include "core/storage/wall_axis.hpp"

namespace scree {

namespace {

void add_vector(std::vector<Column>& columns, std::string_view name, const char* unit, const Vec3& v) {
  for (int k = 0; k < 3; ++k) columns.push_back({fmt::format("{}_{}", name, "xyz"[k]), unit, exact(v[k])});
}

double mean_time(const std::vector<RankMeasures>& ranks, std::size_t phase) {
  double sum = 0;
  for (const RankMeasures& m : ranks) sum += m.times[phase];
  return sum / static_cast<double>(std::max<std::size_t>(1, ranks.size()));
}

}  // namespace

bool can_remove(const Scene& scene) {
  const Domain& domain = scene.settings.domain;
  return (domain.bounded && domain.outside == Outside::remove) || !scene.outlets.empty();
}

std::vector<Column> log_columns(const Scene& scene, const LogRow& row) {
  const Energies& e = row.energies;
  double longest_wait = 0;
  std::int64_t ghosts = 0, bytes = 0;
  for (const RankMeasures& m : row.ranks) {
    longest_wait = std::max(longest_wait, m.times[static_cast<std::size_t>(Phase::wait)]);
    ghosts += m.ghosts;
    bytes += m.bytes + m.rebuild_bytes;
  }
  std::vector<Column> columns{{"step", "-", fmt::format("{}", row.step)},
                              {"time", "s", exact(row.time)},
                              {"kinetic_translational", "J", exact(e.translational)},
                              {"kinetic_rotational", "J", exact(e.rotational)},
                              {"potential", "J", exact(e.potential)},
                              {"elastic", "J", exact(e.elastic)},
                              {"elastic_tangential", "J", exact(e.tangential_elastic)},
                              {"dissipated", "J", exact(e.dissipated)},
                              {"wall_work", "J", exact(e.wall_work)},
                              {"energy_error", "J", fmt::format("{:.9g}", row.energy_error)},
                              {"contacts", "-", fmt::format("{}", row.contacts)},
                              {"max_depth_ratio", "-", fmt::format("{:.9g}", row.max_overlap_ratio)},
                              {"imbalance", "-", fmt::format("{:.6g}", row.imbalance)}};
  for (std::size_t p = 0; p < static_cast<std::size_t>(Phase::count); ++p) {
    columns.push_back({std::string("t_") + phase_name(static_cast<Phase>(p)), "s", fmt::format("{:.6g}", mean_time(row.ranks, p))});
  }
  columns.push_back({"t_wait_longest", "s", fmt::format("{:.6g}", longest_wait)});
  columns.push_back({"ghosts", "-", fmt::format("{}", ghosts)});
  columns.push_back({"bytes_sent", "B", fmt::format("{}", bytes)});
  columns.push_back({"steps_per_second", "1/s", fmt::format("{:.6g}", row.steps_per_second)});
  columns.push_back({"removed_bodies", "-", fmt::format("{:.0f}", row.removed.count)});
  columns.push_back({"removed_mass", "kg", exact(row.removed.mass)});
  if (can_remove(scene) || row.has_program) columns.push_back({"removed", "J", exact(e.removed)});
  if (!scene.inlets.empty() || row.has_program) {
    columns.push_back({"inserted_bodies", "-", fmt::format("{:.0f}", row.inserted.count)});
    columns.push_back({"inserted_mass", "kg", exact(row.inserted.mass)});
    columns.push_back({"inserted", "J", exact(e.arrived)});
  }
  columns.insert(columns.end(), row.of_effects.begin(), row.of_effects.end());
  if (scene.settings.on_overlap == OnOverlap::proceed) {
    columns.push_back({"deep_contacts", "-", fmt::format("{}", row.deep_now)});
    columns.push_back({"deep_contact_steps", "-", fmt::format("{}", row.deep.contact_steps)});
    columns.push_back({"deepest_excess", "m", exact(row.deep.excess)});
  }
  columns.push_back({"critical_step", "s", fmt::format("{:.6g}", row.critical.step)});
  columns.push_back({"state_hash", "-", row.state_hash});
  for (std::size_t w = 0; w < scene.walls.size(); ++w) {
    const std::string wall = fmt::format("wall{}", scene.walls[w].id);
    const bool is_known = w < row.loads.size();
    const WallLoad load = is_known ? row.loads[w] : WallLoad{};
    add_vector(columns, wall + "_force", "N", load.force);
    add_vector(columns, wall + "_torque", "N m", load.torque);
    add_vector(columns, wall + "_impulse", "N s", load.impulse);
    columns.push_back({wall + "_power", "W", exact(is_known ? load.power(row.walls[w]) : 0)});
    if (const std::optional<Drive> drive = scene.walls[w].motion.drive()) {
      const DriveState at = w < row.drives.size() ? row.drives[w] : DriveState{};
      columns.push_back({wall + "_way", drive->guide.turns ? "rad" : "m", exact(at.way)});
      columns.push_back({wall + "_rate", drive->guide.turns ? "rad/s" : "m/s", exact(at.rate)});
    }
  }
  // after all older columns, which keep their places
  for (std::size_t w = 0; w < scene.walls.size(); ++w) {
    std::optional<TurnAxis> axis = own_axis(scene.walls[w], row.time);
    if (!axis) continue;
    axis->point += row.origin;
    const WallLoad load = w < row.loads.size() ? row.loads[w] : WallLoad{};
    columns.push_back({fmt::format("wall{}_axis_torque", scene.walls[w].id), "N m", exact(axis_torque(*axis, load.force, load.torque))});
  }
  return columns;
}

std::vector<Column> step_columns(const StepChange& change) {
  return {{"step", "-", fmt::format("{}", change.step)},
          {"time", "s", exact(change.time)},
          {"step_size", "s", exact(change.step_size)},
          {"reason", "-", change.reason}};
}

std::vector<Column> removed_columns(const Scene& scene, const RemovedBody& body, bool has_program) {
  std::vector<Column> columns{{"step", "-", fmt::format("{}", body.step)},
                              {"time", "s", exact(body.time)},
                              {"id", "-", fmt::format("{}", body.id)},
                              {"mass", "kg", exact(body.mass)}};
  for (int k = 0; k < 3; ++k) columns.push_back({std::string(1, "xyz"[k]), "m", exact(body.x[k])});
  add_vector(columns, "velocity", "m/s", body.v);
  columns.push_back({"residence_time", "s", exact(body.time - body.entered)});
  columns.push_back({"outlet", "-", body.outlet < 0 ? "" : scene.outlets[static_cast<std::size_t>(body.outlet)].name});
  if (has_program)
    columns.push_back({"removed_by", "-", body.outlet == kTakenOut ? "program" : body.outlet == kLeftDomain ? "domain" : "outlet"});
  return columns;
}

std::vector<Column> inserted_columns(const Scene& scene, const InsertedBody& body, bool has_program) {
  std::vector<Column> columns{{"step", "-", fmt::format("{}", body.step)},
                              {"time", "s", exact(body.time)},
                              {"id", "-", fmt::format("{}", body.id)},
                              {"mass", "kg", exact(body.mass)},
                              {"diameter", "m", exact(body.diameter)}};
  for (int k = 0; k < 3; ++k) columns.push_back({std::string(1, "xyz"[k]), "m", exact(body.x[k])});
  columns.push_back({"shape", "-", body.shape < 0 ? "" : scene.shapes[static_cast<std::size_t>(body.shape)].name});
  columns.push_back({"inlet", "-", body.inlet < 0 ? "" : scene.inlets[static_cast<std::size_t>(body.inlet)].name});
  if (has_program)
    columns.push_back({"material", "-", body.shape < 0 ? "" : scene.materials[static_cast<std::size_t>(body.material)].name});
  return columns;
}

}  // namespace scree
