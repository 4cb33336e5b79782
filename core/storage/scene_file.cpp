// How a scene is stored: what a person would read (settings, materials, pairs, walls) is one JSON text, what
// there are many of (shapes, bodies, cut boxes) are arrays. The reader checks everything that the solver
// relies on, so that a damaged file stops here with its name and not in a kernel.
#include "core/storage/scene_file.hpp"

#include <algorithm>
#include <cmath>
#include <new>
#include <nlohmann/json.hpp>
#include <set>
#include <stdexcept>

#include "core/base/error.hpp"
#include "core/base/utf8.hpp"
#include "core/storage/json_object.hpp"
#include "core/storage/scene_settings.hpp"
#include "core/storage/start_state.hpp"

namespace scree {

namespace {

using nlohmann::json;

// The file does not say how many there are, and post names them all; no case has so many tables.
constexpr std::int32_t kMostPopulations = 1000000;

json parse_text(const h5::Group& root, const char* name) {
  const std::string text = root.read_text(name);
  json value = json::parse(text, nullptr, false);
  if (value.is_discarded()) throw InputError("{}/{}: not valid JSON; the file is truncated or damaged, make it again", root.path(), name);
  return value;
}

void write_bodies(const h5::Group& group, const BodyTable& bodies, bool has_heat) {
  group.write_array("id", bodies.id, 1, "");
  group.write_array("shape", bodies.shape, 1, "");
  group.write_array("material", bodies.material, 1, "");
  group.write_array("scale", bodies.scale, 1, "");
  group.write_array("position", bodies.position, "m");
  group.write_array("orientation", bodies.orientation, "");
  group.write_array("velocity", bodies.velocity, "m/s");
  group.write_array("angular_velocity", bodies.angular_velocity, "rad/s");
  group.write_array("fixed", bodies.fixed, 1, "");
  group.write_array("lock_rotation", bodies.lock_rotation, 1, "");
  group.write_array("population", bodies.population, 1, "");
  if (has_heat) {
    group.write_array("temperature", bodies.temperature, 1, "K");
    group.write_array("heat_source", bodies.heat_source, 1, "W");
    const auto has_table = [](std::int32_t table) { return table >= 0; };
    if (std::any_of(bodies.heat_table.begin(), bodies.heat_table.end(), has_table))
      group.write_array("heat_table", bodies.heat_table, 1, "");
  }
  if (!bodies.owner.empty()) group.write_array("owner", bodies.owner, 1, "");
}

BodyTable read_bodies(const h5::Group& group, const Scene& scene) {
  BodyTable b;
  b.id = group.read_array<std::int64_t>("id", 1);
  b.shape = group.read_array<std::int32_t>("shape", 1);
  b.material = group.read_array<std::int32_t>("material", 1);
  b.scale = group.read_array<double>("scale", 1);
  b.position = group.read_vectors("position");
  b.orientation = group.read_quaternions("orientation");
  b.velocity = group.read_vectors("velocity");
  b.angular_velocity = group.read_vectors("angular_velocity");
  b.fixed = group.read_array<std::uint8_t>("fixed", 1);
  b.lock_rotation = group.read_array<std::uint8_t>("lock_rotation", 1);
  b.population = group.read_array<std::int32_t>("population", 1);
  if (scene.partition.ranks > 0) b.owner = group.read_array<std::int32_t>("owner", 1);
  if (scene.settings.heat) {
    b.temperature = group.read_array<double>("temperature", 1);
    b.heat_source = group.read_array<double>("heat_source", 1);
    b.heat_table = group.has("heat_table") ? group.read_array<std::int32_t>("heat_table", 1) : std::vector<std::int32_t>(b.id.size(), -1);
  }

  const std::size_t n = b.id.size();
  const auto demand_rows = [&](std::size_t rows, const char* name) {
    if (rows != n) throw InputError("{}/{}: {} rows found, {} expected (as many as ids)", group.path(), name, rows, n);
  };
  demand_rows(b.shape.size(), "shape");
  demand_rows(b.material.size(), "material");
  demand_rows(b.scale.size(), "scale");
  demand_rows(b.position.size(), "position");
  demand_rows(b.orientation.size(), "orientation");
  demand_rows(b.velocity.size(), "velocity");
  demand_rows(b.angular_velocity.size(), "angular_velocity");
  demand_rows(b.fixed.size(), "fixed");
  demand_rows(b.lock_rotation.size(), "lock_rotation");
  demand_rows(b.population.size(), "population");
  if (scene.partition.ranks > 0) demand_rows(b.owner.size(), "owner");
  if (scene.settings.heat) {
    demand_rows(b.temperature.size(), "temperature");
    demand_rows(b.heat_source.size(), "heat_source");
    demand_rows(b.heat_table.size(), "heat_table");
  }

  for (std::size_t i = 0; i < n; ++i) {
    const auto wrong = [&](const std::string& what) { return InputError("{}: body {} (row {}): {}", group.path(), b.id[i], i, what); };
    if (b.shape[i] < 0 || static_cast<std::size_t>(b.shape[i]) >= scene.shapes.size()) {
      throw wrong(fmt::format("shape {} found, but there are {} shapes", b.shape[i], scene.shapes.size()));
    }
    if (scene.shapes[static_cast<std::size_t>(b.shape[i])].kind == ShapeKind::surface) {
      throw wrong(fmt::format("shape {} is a wall surface without mass", b.shape[i]));
    }
    if (b.material[i] < 0 || static_cast<std::size_t>(b.material[i]) >= scene.materials.size()) {
      throw wrong(fmt::format("material {} found, but there are {} materials", b.material[i], scene.materials.size()));
    }
    if (b.population[i] < -1 || b.population[i] >= kMostPopulations)
      throw wrong(fmt::format("population {} found, -1 or the number of a table [[populations]] of the case expected", b.population[i]));
    if (!(b.scale[i] > 0) || !std::isfinite(b.scale[i])) throw wrong(fmt::format("scale {:g} found, a value > 0 expected", b.scale[i]));
    if (!is_finite(b.position[i])) throw wrong("the position is not a finite number");
    if (!is_finite(b.velocity[i]) || !is_finite(b.angular_velocity[i])) throw wrong("a velocity is not a finite number");
    if (scene.settings.heat) {
      if (!(b.temperature[i] > 0) || !std::isfinite(b.temperature[i]))
        throw wrong(fmt::format("temperature {:g} found, a value > 0 [K] expected", b.temperature[i]));
      if (!std::isfinite(b.heat_source[i])) throw wrong("the heat source is not a finite number");
      const std::size_t tables = scene.settings.heat->source_tables.size();
      if (b.heat_table[i] < -1 || b.heat_table[i] >= static_cast<std::int32_t>(tables))
        throw wrong(fmt::format("heat_table {} found, but there are {} tables of heat sources", b.heat_table[i], tables));
      if (!scene.materials[static_cast<std::size_t>(b.material[i])].has_heat())
        throw wrong("its material lacks heat_capacity or conductivity, which a scene with heat needs");
    }
    const double q = norm(b.orientation[i]);
    if (!(std::abs(q - 1) <= kUnitTolerance)) {
      throw wrong(fmt::format("the orientation has norm {:.9g}, a unit quaternion w x y z is expected", q));
    }
    if (std::abs(q - 1) > kUnitRounding) b.orientation[i] = normalised(b.orientation[i]);
    if (scene.partition.ranks > 0 && (b.owner[i] < 0 || b.owner[i] >= scene.partition.ranks)) {
      throw wrong(fmt::format("owner {} found, but the scene is cut for {} ranks", b.owner[i], scene.partition.ranks));
    }
  }
  std::set<std::int64_t> ids(b.id.begin(), b.id.end());
  if (ids.size() != n) throw InputError("{}/id: {} ids for {} bodies; ids must be unique", group.path(), ids.size(), n);
  for (const Wall& wall : scene.walls) {
    if (!ids.insert(wall.id).second) throw InputError("{}/id: id {} is used twice (wall '{}')", group.path(), wall.id, wall.name);
  }
  return b;
}

void write_forces(const h5::Group& group, const std::vector<BodyForce>& forces) {
  std::vector<std::int64_t> ids;
  std::vector<Vec3> values;
  for (const BodyForce& f : forces) {
    ids.push_back(f.id);
    values.push_back(f.force);
  }
  group.write_array("body", ids, 1, "");
  group.write_array("force", values, "N");
}

std::vector<BodyForce> read_forces(const h5::Group& group) {
  const auto ids = group.read_array<std::int64_t>("body", 1);
  const std::vector<Vec3> values = group.read_vectors("force");
  if (ids.size() != values.size()) throw InputError("{}: {} forces for {} bodies", group.path(), values.size(), ids.size());
  std::vector<BodyForce> forces;
  for (std::size_t i = 0; i < ids.size(); ++i) {
    if (!is_finite(values[i])) throw InputError("{}: the force on body {} is not a finite number", group.path(), ids[i]);
    forces.push_back({ids[i], values[i]});
  }
  return forces;
}

/// Forces and bonds name bodies of the scene.
void check_ids(const Scene& scene, const std::string& path) {
  if (scene.forces.empty() && scene.bonds.empty()) return;
  const std::set<std::int64_t> ids(scene.bodies.id.begin(), scene.bodies.id.end());
  const auto expect = [&](std::int64_t id, const char* what) {
    if (!ids.contains(id)) throw InputError("{}: a {} names body {}, which is not in the scene", path, what, id);
  };
  for (const BodyForce& f : scene.forces) expect(f.id, "force");
  for (const Bond& bond : scene.bonds) {
    expect(bond.a, "bond");
    expect(bond.b, "bond");
  }
}

}  // namespace

void write_scene_file(const std::string& path, const Scene& scene) { write_scene_file(path, scene, {}); }

void write_scene_file(const std::string& path, const Scene& scene, const std::optional<StartState>& start) {
  h5::NewFile file(path);
  const h5::Group& root = file.root();
  root.write_attribute("format", kSceneFormat);
  root.write_attribute("format_version", start ? kSceneFormatVersionWithStart : kSceneFormatVersion);
  root.write_text("provenance", json_text(scene.provenance));
  root.write_text("settings", json_text(settings_json(scene), 1));
  write_shapes(root.create_group("shapes"), scene.shapes);
  const h5::Group partition = root.create_group("partition");
  partition.write_attribute("ranks", scene.partition.ranks);
  partition.write_attribute("predicted_imbalance", scene.partition.predicted_imbalance);
  partition.write_attribute("method", scene.partition.method);
  if (scene.partition.ranks > 0 && scene.partition.method == "rcb") {
    partition.write_array("lower", scene.partition.lower, "m");
    partition.write_array("upper", scene.partition.upper, "m");
  }
  write_bodies(root.create_group("bodies"), scene.bodies, scene.settings.heat.has_value());
  if (!scene.forces.empty()) write_forces(root.create_group("forces"), scene.forces);
  if (!scene.bonds.empty()) write_bonds(root.create_group("bonds"), scene.bonds);
  if (start) write_start_state(root.create_group("start"), *start);
  file.commit();
}

namespace {
Scene read_scene(const std::string& path) {
  const h5::File file(path);
  const h5::Group& root = file.root();
  check_format(root, kSceneFormat, kSceneFormatVersionWithStart);
  Scene scene;
  scene.provenance = parse_text(root, "provenance");
  scene.shapes = read_shapes(root.open_group("shapes"));

  read_settings_json(parse_text(root, "settings"), root.path() + "/settings", scene);

  const h5::Group partition = root.open_group("partition");
  const std::int64_t ranks = partition.read_integer_attribute("ranks");
  if (ranks < 0 || ranks > 100000000) throw InputError("{}: {} ranks cannot be right", partition.path(), ranks);
  scene.partition.ranks = static_cast<std::int32_t>(ranks);
  scene.partition.predicted_imbalance = partition.read_double_attribute("predicted_imbalance");
  if (partition.has_attribute("method")) scene.partition.method = partition.read_text_attribute("method");
  if (ranks > 0 && scene.partition.method == "rcb") {
    scene.partition.lower = partition.read_vectors("lower");
    scene.partition.upper = partition.read_vectors("upper");
    for (const auto* side : {&scene.partition.lower, &scene.partition.upper}) {
      if (side->size() != static_cast<std::size_t>(ranks)) {
        throw InputError("{}: {} boxes found, {} expected (one for each rank)", partition.path(), side->size(), ranks);
      }
      for (const Vec3& corner : *side) {
        if (!is_finite(corner)) throw InputError("{}: a cut is not a finite number", partition.path());
      }
    }
  }
  scene.bodies = read_bodies(root.open_group("bodies"), scene);
  if (root.has("forces")) scene.forces = read_forces(root.open_group("forces"));
  if (root.has("bonds")) scene.bonds = read_bonds(root.open_group("bonds"));
  check_ids(scene, root.path());
  return scene;
}
}  // namespace

Scene read_scene_file(const std::string& path) {
  try {
    return read_scene(path);
  } catch (const std::bad_alloc&) {
    // a flipped bit in the size of a dataset asks for more memory than there is
    throw InputError("{}: its arrays do not fit into memory; the file is damaged, or this machine is too small for it", path);
  } catch (const std::length_error&) {
    throw InputError("{}: the size of an array in it cannot be right; the file is damaged", path);
  }
}

}  // namespace scree
