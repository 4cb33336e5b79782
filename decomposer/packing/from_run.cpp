#include "decomposer/packing/from_run.hpp"

#include <mpi.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <filesystem>
#include <map>
#include <numeric>
#include <set>
#include <tuple>

#include "core/base/error.hpp"
#include "core/placing/placed_body.hpp"
#include "core/storage/collective_file.hpp"
#include "core/storage/frame_check.hpp"
#include "core/storage/frame_file.hpp"
#include "core/storage/run_files.hpp"
#include "core/storage/wall_state.hpp"
#include "core/storage/wall_zones.hpp"
#include "decomposer/packing/cell_of_run.hpp"

namespace scree {

namespace {

namespace fs = std::filesystem;

/// The materials of the run as those of the case, -1 where the case has none.
std::vector<std::int32_t> materials_in_case(const Case& c, const Scene& run) {
  std::vector<std::string> names;
  for (const Material& m : run.materials) names.push_back(m.name);
  for (const auto& [there, here] : c.start->materials) {
    if (std::find(names.begin(), names.end(), there) != names.end()) continue;
    throw UsageError("{}.materials.{} = \"{}\": {} has no such material; it has {}", c.start->where, there, here, c.start->run,
                     fmt::join(names, ", "));
  }
  std::vector<std::int32_t> indices;
  for (std::string name : names) {
    for (const auto& [there, here] : c.start->materials) {
      if (name == there) {
        name = here;
        break;
      }
    }
    const auto found = std::find_if(c.materials.begin(), c.materials.end(), [&](const Material& m) { return m.name == name; });
    indices.push_back(found == c.materials.end() ? -1 : static_cast<std::int32_t>(found - c.materials.begin()));
  }
  return indices;
}

class RunReader {
 public:
  explicit RunReader(const Case& c) : case_(c), start_(*c.start) {}

  FromRun read() {
    const std::string scene_path = (fs::path(start_.run) / kSceneOfRun).string();
    if (!fs::is_directory(start_.run))
      throw InputError("{}.run: there is no folder {}; name the folder of a run", start_.where, start_.run);
    if (!fs::exists(scene_path))
      throw InputError("{}.run: {} is no folder of a run: it holds no {}", start_.where, start_.run, kSceneOfRun);
    from_.scene = read_scene_file(scene_path);
    if (const std::optional<StartState> earlier = read_start_state(scene_path, from_.scene.bodies.size()))
      from_.clock_of_run = earlier->clock;
    scene_hash_ = sha256_of_file(scene_path);
    from_.inputs.push_back({scene_path, scene_hash_, from_.scene.provenance});
    for (const std::int64_t id : from_.scene.bodies.id) use(id);
    for (const Wall& wall : from_.scene.walls) use(wall.id);
    materials_ = materials_in_case(case_, from_.scene);
    for (std::size_t i = 0; i < from_.scene.bodies.size(); ++i) {
      population_[from_.scene.bodies.id[i]] = from_.scene.bodies.population[i];
      came_in_ = std::max(came_in_, from_.scene.bodies.population[i] + 1);
    }
    if (start_.frame >= 0)
      read_frame();
    else
      read_checkpoint();
    if (from_.bodies.empty()) throw InputError("{}.run: {} holds no body any more at {:g} s", start_.where, start_.run, from_.start.time);
    from_.start.run = start_.run;
    from_.start.bodies = static_cast<std::int64_t>(from_.bodies.size());
    return std::move(from_);
  }

 private:
  /// Of which population a body was, -1: of [[bodies]]; what came in through inlets, or a program put in, counts as one more.
  std::int32_t population_of(std::int64_t id) const {
    const auto found = population_.find(id);
    return found != population_.end() ? found->second : came_in_;
  }

  void use(std::int64_t id) { from_.first_free_id = std::max(from_.first_free_id, id + 1); }

  void add(BodyRow row) {
    const auto count = [](const auto& list) { return static_cast<std::int32_t>(list.size()); };
    if (row.shape < 0 || row.shape >= count(from_.scene.shapes) || row.material < 0 || row.material >= count(from_.scene.materials))
      throw InputError("{}: body {} has a shape or a material that the scene of the run does not have", from_.start.file, row.id);
    const std::string& name = from_.scene.materials[static_cast<std::size_t>(row.material)].name;
    row.material = materials_[static_cast<std::size_t>(row.material)];
    if (row.material < 0) {
      throw UsageError(
          "{}: bodies of {} are of the material \"{}\", which this case does not have; add [materials.\"{}\"], or say which it is with "
          "materials = {{ \"{}\" = \"...\" }}",
          start_.where, start_.run, name, name, name);
    }
    take_temperature(row);
    use(row.id);
    from_.bodies.push_back(row);
  }

  /// A body keeps its temperature; that of a run without heat takes the one of the case.
  void take_temperature(BodyRow& row) const {
    if (!case_.settings.heat) {
      row.temperature = 0;
      return;
    }
    if (!(row.temperature > 0)) row.temperature = case_.settings.heat->temperature;
    if (!(row.temperature > 0))
      throw UsageError("{}: the bodies of {} have no temperature; give one for them as temperature in [heat]", start_.where, start_.run);
    const Material& material = case_.materials[static_cast<std::size_t>(row.material)];
    if (!material.has_heat())
      throw UsageError(
          "{}: with [heat] the material \"{}\" of bodies of {} needs heat_capacity and conductivity; add them to [materials.{}]",
          start_.where, material.name, start_.run, material.name);
  }

  /// in   state   of a wall that answers to force
  void stood(std::size_t wall, const Vec3& position, const Quat& orientation) {
    const Wall& placed = from_.scene.walls[wall];
    if (placed.kind != WallKind::mesh && !(orientation == placed.orientation)) return;  // friction springs are kept in its frame
    from_.driven[wall] = {wall_standing_at(placed, position, orientation), position - placed.position};
  }

  void take_input(const std::string& path, nlohmann::json history) {
    from_.start.file = fs::path(path).filename().string();
    from_.inputs.push_back({path, sha256_of_file(path), std::move(history)});
  }

  void read_frame() {
    const std::string path = (fs::path(start_.run) / frame_name(start_.frame)).string();
    if (!fs::exists(path)) {
      const std::vector<FrameEntry> frames = list_frames(start_.run);
      throw InputError(
          "{}.frame = {}: {} holds no {}{}", start_.where, start_.frame, start_.run, fs::path(path).filename().string(),
          frames.empty() ? "; it holds no frame" : fmt::format("; its last is {}", fs::path(frames.back().path).filename().string()));
    }
    Frame frame = read_frame_file(path);
    check_frame(from_.scene, frame, path);
    take_input(path, std::move(frame.provenance));
    from_.start.time = frame.time;
    from_.cell = cell_of(frame, case_);
    for (std::size_t w = 0; w < from_.scene.walls.size() && w < frame.walls.size(); ++w) {
      if (from_.scene.walls[w].motion.drive()) stood(w, frame.walls.position[w], frame.walls.orientation[w]);
    }
    std::map<std::int64_t, std::size_t> row_of;
    for (std::size_t i = 0; i < from_.scene.bodies.size(); ++i) row_of[from_.scene.bodies.id[i]] = i;
    const FrameBodies& b = frame.bodies;
    for (std::size_t i = 0; i < b.size(); ++i) {
      const auto known = row_of.find(b.id[i]);
      const bool fixed = known != row_of.end() && from_.scene.bodies.fixed[known->second] != 0;
      const bool locked = known != row_of.end() && from_.scene.bodies.lock_rotation[known->second] != 0;
      add({b.id[i], b.shape[i], b.material[i], b.scale[i], b.position[i], b.orientation[i], b.velocity[i], b.angular_velocity[i], fixed,
           locked, population_of(b.id[i]), b.temperature[i]});
    }
  }

  std::string checkpoint_path() const {
    const std::vector<std::string> all = list_checkpoints(start_.run);
    if (all.empty()) {
      throw InputError("{}.run: {} holds no checkpoint; run it to its end, or give frame = N, from which contacts start without springs",
                       start_.where, start_.run);
    }
    if (start_.checkpoint < 0) return all.back();
    std::string there;
    for (const std::string& path : all) {
      const std::int64_t step = checkpoint_step_of(fs::path(path).filename().string()).value_or(-1);
      if (step == start_.checkpoint) return path;
      there += (there.empty() ? "" : ", ") + std::to_string(step);
    }
    throw InputError("{}.checkpoint = {}: {} holds no checkpoint of that step; it holds those of {}", start_.where, start_.checkpoint,
                     start_.run, there);
  }

  void read_checkpoint() {
    const std::string path = checkpoint_path();
    try {
      check_checksum(MPI_COMM_SELF, path);
    } catch (const InputError& error) {
      throw InputError("{}.run: {}; give checkpoint = N for another one, or frame = N", start_.where, error.what());
    }
    const h5::File file(path);
    const h5::Group& root = file.root();
    check_format(root, kCheckpointFormat, kCheckpointFormatVersion);
    if (root.read_text_attribute("scene_sha256") != scene_hash_)
      throw InputError("{}.run: {} was not made from the {} beside it", start_.where, path, kSceneOfRun);
    take_input(path, nlohmann::json::parse(root.read_text("provenance"), nullptr, false));
    from_.start.time = static_cast<double>(root.read_integer_attribute("step")) * root.read_double_attribute("step_size");
    if (root.has_attribute("largest_id")) use(root.read_integer_attribute("largest_id"));
    from_.cell = cell_of(root, from_.scene, case_);
    read_bodies(root);
    if (root.has("drives")) {
      const auto way = root.open_group("drives").read_array<double>("way", 1);
      for (std::size_t w = 0; w < from_.scene.walls.size() && w < way.size(); ++w) {
        const Wall& wall = from_.scene.walls[w];
        if (!wall.motion.drive()) continue;
        DriveState drive;
        drive.way = way[w];
        const WallState state = wall_state(wall, from_.start.time, 0, &drive);
        stood(w, state.position, state.orientation);
        if (const auto found = from_.driven.find(w); found != from_.driven.end()) found->second.way = drive.way;
      }
    }
    if (root.has("transit")) from_.in_transit = root.open_group("transit").row_count("id");
    from_.start.pairs = read_pair_tables(root);
  }

  void read_bodies(const h5::Group& root) {
    Vec3 origin;
    if (root.has_attribute("origin_x"))
      origin = {root.read_double_attribute("origin_x"), root.read_double_attribute("origin_y"), root.read_double_attribute("origin_z")};
    const h5::Group group = root.open_group("bodies");
    const auto id = group.read_array<std::int64_t>("id", 1);
    const auto shape = group.read_array<std::int32_t>("shape", 1), material = group.read_array<std::int32_t>("material", 1);
    const auto fixed = group.read_array<std::uint8_t>("fixed", 1), locked = group.read_array<std::uint8_t>("lock_rotation", 1);
    const auto scale = group.read_array<double>("scale", 1);
    const auto x = group.read_vectors("x"), x_remainder = group.read_vectors("x_remainder"), v = group.read_vectors("v"),
               w = group.read_vectors("w");
    const auto q = group.read_quaternions("q_principal"), q_remainder = group.read_quaternions("q_remainder");
    for (const std::size_t rows : {shape.size(), material.size(), fixed.size(), locked.size(), scale.size(), x.size(), x_remainder.size(),
                                   v.size(), w.size(), q.size(), q_remainder.size()}) {
      if (rows != id.size()) throw InputError("{}: columns of {} and of {} rows; the file is damaged", group.path(), id.size(), rows);
    }
    const auto temperature = group.has("temperature") ? group.read_array<double>("temperature", 1) : std::vector<double>(id.size(), 0.0);
    if (temperature.size() != id.size())
      throw InputError("{}: columns of {} and of {} rows; the file is damaged", group.path(), id.size(), temperature.size());
    std::vector<std::size_t> order(id.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::sort(order.begin(), order.end(), [&](std::size_t i, std::size_t j) { return id[i] < id[j]; });
    for (const std::size_t i : order) {
      // what the sum rounds off goes to the remainder
      const Vec3 place = x[i] + origin, part = place - x[i], lost = (x[i] - (place - part)) + (origin - part);
      BodyRow row{id[i],         shape[i],       material[i],          scale[i],      place, {}, v[i], w[i],
                  fixed[i] != 0, locked[i] != 0, population_of(id[i]), temperature[i]};
      if (shape[i] >= 0 && static_cast<std::size_t>(shape[i]) < from_.scene.shapes.size())
        row.orientation = normalised(q[i] * conjugate(from_.scene.shapes[static_cast<std::size_t>(shape[i])].mass.body_from_principal));
      add(row);
      from_.start.x_remainder.push_back(x_remainder[i] + lost);
      from_.start.q_principal.push_back(q[i]);
      from_.start.q_remainder.push_back(q_remainder[i]);
    }
  }

  const Case& case_;
  const CaseStart& start_;
  FromRun from_;
  std::string scene_hash_;
  std::vector<std::int32_t> materials_;  // of the run, in the case
  std::map<std::int64_t, std::int32_t> population_;
  std::int32_t came_in_ = 0;
};

/// The wall as it stands at a time of the run; nothing for a box_inside that is turned then.
std::optional<Wall> wall_at(Wall wall, double time) {
  wall.motion.advance_clock(time);
  try {
    return wall_at_start(wall);
  } catch (const UsageError&) {
    return {};
  }
}

/// Whether they are the same surface, no further from each other than this.
bool are_the_same(const Wall& a, const Shape* shape_a, const Wall& b, const Shape* shape_b, double apart) {
  if (a.kind != b.kind) return false;
  const auto near = [&](const Vec3& p, const Vec3& q) { return length(p - q) <= apart; };
  switch (a.kind) {
    case WallKind::plane:
      return near(a.point, b.point) && a.normal == b.normal;
    case WallKind::box_inside:
      return near(a.lower, b.lower) && near(a.upper, b.upper);
    case WallKind::cylinder_inside:
      return near(a.axis_start, b.axis_start) && near(a.axis_end, b.axis_end) && a.radius == b.radius;
    case WallKind::sphere_inside:
      return near(a.point, b.point) && a.radius == b.radius;
    case WallKind::mesh: {
      if (!(a.scale == b.scale && a.cell_size == b.cell_size && near(a.position, b.position) &&
            shape_a->mesh.vertices == shape_b->mesh.vertices && shape_a->mesh.triangles == shape_b->mesh.triangles))
        return false;
      if (a.orientation == b.orientation) return true;
      return std::all_of(shape_a->mesh.vertices.begin(), shape_a->mesh.vertices.end(), [&](const Vec3& p) {
        return near(a.position + rotate(a.orientation, a.scale * p), b.position + rotate(b.orientation, b.scale * p));
      });
    }
  }
  return false;
}

/// The zones of the case for those of the run, -1 where there is none.
std::vector<std::int32_t> zones_in_case(const FromRun& from, const Scene& scene, const std::vector<std::int32_t>& partner) {
  const auto zones_of = [](const Scene& s) {
    std::vector<std::string> dropped;
    return wall_zones(s.walls, periodicity_of(s.settings.domain), dropped);
  };
  std::map<std::pair<std::int32_t, std::int32_t>, std::int32_t> here;  // of the run's wall and its zone
  const std::vector<WallZone> zones = zones_of(scene);
  for (std::size_t z = 0; z < zones.size(); ++z) {
    const std::int32_t wall = partner[static_cast<std::size_t>(zones[z].wall)];
    if (wall >= 0) here.emplace(std::pair(wall, zones[z].zone), static_cast<std::int32_t>(z));
  }
  std::vector<std::int32_t> result;
  for (const WallZone& zone : zones_of(from.scene)) {
    const auto found = here.find({zone.wall, zone.zone});
    result.push_back(found == here.end() ? -1 : found->second);
  }
  return result;
}

}  // namespace

std::string FromRun::name_of(std::int64_t id) const { return fmt::format("body {} of {}", id, start.run); }

std::size_t FromRun::wall_named(const std::string& name) const {
  const auto found = std::find_if(scene.walls.begin(), scene.walls.end(), [&](const Wall& wall) { return wall.name == name; });
  return static_cast<std::size_t>(found - scene.walls.begin());
}

std::string FromRun::where_it_stood(const std::string& wall) const {
  for (const auto& [w, stood] : driven) {
    const Wall& placed = scene.walls[w];
    if (placed.name != wall) continue;
    if (placed.kind != WallKind::mesh)
      return fmt::format("in {} wall '{}' had moved by [{}, {}, {}] from where its case placed it", start.run, wall, stood.displacement.x,
                         stood.displacement.y, stood.displacement.z);
    const Vec3& p = stood.standing.position;
    const Quat& q = stood.standing.orientation;
    return fmt::format("in {} wall '{}' stood at position = [{}, {}, {}]{}", start.run, wall, p.x, p.y, p.z,
                       q == placed.orientation ? "" : fmt::format(", orientation = [{}, {}, {}, {}]", q.w, q.x, q.y, q.z));
  }
  return "";
}

FromRun read_run(const Case& c) { return RunReader(c).read(); }

std::vector<MaterialUse> uses_of(const FromRun& from, const Case& c) {
  std::vector<MaterialUse> uses(c.materials.size());
  for (std::size_t m = 0; m < uses.size(); ++m) {
    uses[m].material = static_cast<std::int32_t>(m);
    uses[m].where = "the bodies of " + c.start->run;
  }
  for (const BodyRow& row : from.bodies) {
    MaterialUse& use = uses[static_cast<std::size_t>(row.material)];
    if (row.fixed)
      use.has_fixed = true;
    else
      use.movers += 1;
  }
  std::erase_if(uses, [](const MaterialUse& use) { return use.movers == 0 && !use.has_fixed; });
  return uses;
}

std::vector<std::int32_t> partners_of_walls(const FromRun& from, const std::vector<Wall>& walls, const std::vector<Shape>& shapes) {
  std::vector<std::int32_t> partner(walls.size(), -1);
  std::vector<bool> taken(from.scene.walls.size(), false);
  // nearer than bodies that touch are told from those that do not: places are written in decimals
  double apart = 1e300;
  for (const BodyRow& row : from.bodies) {
    const Shape& shape = from.scene.shapes[static_cast<std::size_t>(row.shape)];
    apart = std::min(apart, kTouch * 0.5 * row.scale * shape.equivalent_diameter());
  }
  const auto shape_of = [](const std::vector<Shape>& of, const Wall& wall) {
    return wall.kind == WallKind::mesh ? &of[static_cast<std::size_t>(wall.shape)] : nullptr;
  };
  for (std::size_t k = 0; k < from.scene.walls.size(); ++k) {
    const Wall& wall = from.scene.walls[k];
    if (wall.wear > 0) continue;  // how it was worn then is not in the scene
    std::optional<Wall> there;
    if (const auto driven = from.driven.find(k); driven != from.driven.end()) {
      there = driven->second.standing;
    } else if (!wall.motion.drive()) {
      // its frame must not be turned: friction springs are kept in frames
      if (!(wall_state(wall, from.start.time).orientation == wall.orientation) && wall.kind != WallKind::mesh) continue;
      there = wall_at(wall, from.start.time);
    }
    for (std::size_t i = 0; there && i < walls.size(); ++i) {
      if (partner[i] >= 0 || taken[k]) continue;
      if (!are_the_same(*there, shape_of(from.scene.shapes, wall), walls[i], shape_of(shapes, walls[i]), apart)) continue;
      partner[i] = static_cast<std::int32_t>(k);
      taken[k] = true;
    }
  }
  return partner;
}

StartState start_of(const FromRun& from, const Scene& scene, const std::vector<std::int32_t>& partner) {
  StartState start = from.start;
  const bool gathered_alike = from.scene.settings.gather == scene.settings.gather;
  const std::vector<std::int32_t> zones = zones_in_case(from, scene, partner);
  std::map<std::int64_t, std::int64_t> wall_ids;  // of the run, here
  for (std::size_t i = 0; i < partner.size(); ++i) {
    if (partner[i] >= 0) wall_ids[from.scene.walls[static_cast<std::size_t>(partner[i])].id] = scene.walls[i].id;
  }
  std::set<std::tuple<std::int64_t, std::int64_t, std::int64_t>> left;
  for (PairTable& table : start.pairs) {
    std::vector<std::size_t> rows;
    for (std::size_t n = 0; n < table.size(); ++n) {
      const std::int64_t zone = table.zone[n];
      const bool has_partner = zone < 0 || (zone < static_cast<std::int64_t>(zones.size()) && zones[static_cast<std::size_t>(zone)] >= 0 &&
                                            wall_ids.contains(table.b[n]));
      if (!gathered_alike || !has_partner) {
        left.emplace(table.a[n], table.b[n], zone);
        continue;
      }
      if (zone >= 0) {
        table.b[n] = wall_ids.at(table.b[n]);
        table.zone[n] = zones[static_cast<std::size_t>(zone)];
      }
      rows.push_back(n);
    }
    table.take(rows);
  }
  start.left = static_cast<std::int64_t>(left.size());
  return start;
}

}  // namespace scree
