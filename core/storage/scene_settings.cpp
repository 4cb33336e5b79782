// What a person would read of a scene, as one JSON text: settings, materials, pairs, walls. Writing comes first, then reading.
#include "core/storage/scene_settings.hpp"

#include "core/storage/json_keys.hpp"
#include "core/storage/scene_keys.hpp"

namespace scree {

namespace {

using nlohmann::json;

/// Readers of the first versions ask for the members of every kind in each motion.
json unused_members() {
  const json zero = to_json(Vec3{});
  return {{"axis", to_json(Vec3{0, 0, 1})},
          {"centre", zero},
          {"rate", 0.0},
          {"amplitude", 0.0},
          {"frequency", 0.0},
          {"phase", 0.0},
          {"table_time", json::array()},
          {"table_position", json::array()}};
}

json motion_json(WallMotion motion) {
  json j;
  if (motion.is_prescribed()) {
    j = unused_members();
    JsonKeyWriter writer(j);
    std::visit([&](auto& kind) { kind.keys(writer); }, motion.kind);
    j["start"] = motion.start;
    j["stop"] = motion.stop;
  }
  j["kind"] = motion.word();
  return j;
}

json wall_json(const Wall& wall) {
  json j;
  j["id"] = wall.id;
  j["name"] = wall.name;
  j["kind"] = word_of(wall.kind);
  j["material"] = wall.material;
  switch (wall.kind) {
    case WallKind::plane:
      j["point"] = to_json(wall.point);
      j["normal"] = to_json(wall.normal);
      break;
    case WallKind::box_inside:
      j["lower"] = to_json(wall.lower);
      j["upper"] = to_json(wall.upper);
      break;
    case WallKind::cylinder_inside:
      j["axis_start"] = to_json(wall.axis_start);
      j["axis_end"] = to_json(wall.axis_end);
      j["radius"] = wall.radius;
      break;
    case WallKind::sphere_inside:
      j["point"] = to_json(wall.point);
      j["radius"] = wall.radius;
      break;
    case WallKind::mesh:
      j["shape"] = wall.shape;
      j["scale"] = wall.scale;
      j["cell_size"] = wall.cell_size;
      j["position"] = to_json(wall.position);
      j["orientation"] = to_json(wall.orientation);
      break;
  }
  j["motion"] = motion_json(wall.motion);
  return j;
}

Settings read_settings(const JsonObject& o) {
  Settings s;
  s.weights = VertexWeights::unit;  // of files that were written before there was a choice
  JsonKeyReader reader(o);
  run_keys(reader, s);
  time_keys(reader, s);
  contact_keys(reader, s);
  motion_keys(reader, s);
  output_keys(reader, s);
  if (o.has("checkpoint_by_clock")) s.checkpoint_by_clock = o.boolean("checkpoint_by_clock");
  const JsonObject domain = o.object("domain");
  s.domain.bounded = domain.boolean("bounded");
  JsonKeyReader domain_reader(domain);
  domain_keys(domain_reader, s.domain);
  for (int k = 0; k < 3; ++k) {
    if (s.domain.bounded && !(s.domain.lower[k] < s.domain.upper[k])) throw InputError("{}: min is not below max", domain.where());
  }
  if (o.has("fluid")) {
    const JsonObject fluid = o.object("fluid");
    JsonKeyReader fluid_reader(fluid);
    fluid_keys(fluid_reader, s.fluid.emplace());
  }
  return s;
}

WallMotion read_motion(const JsonObject& o) {
  WallMotion motion;
  const std::string word = o.text("kind");
  std::string known = Still::kWord;
  bool found = word == Still::kWord;
  for_each_motion([&](auto kind) {
    known += std::string(", ") + kind.kWord;
    if (word != kind.kWord) return;
    found = true;
    JsonKeyReader reader(o);
    kind.keys(reader);
    motion.kind = kind;
  });
  if (!found) throw InputError("{}.kind: '{}' found, expected one of {}", o.where(), word, known);
  if (!motion.is_prescribed()) return motion;
  motion.start = o.number("start");
  motion.stop = o.number("stop");
  if (const auto fault = motion.fault()) throw InputError("{}: {} {}", o.where(), fault->key, fault->text);
  return motion;
}

Wall read_wall(const JsonObject& o, std::size_t material_count, const std::vector<Shape>& shapes) {
  Wall wall;
  wall.id = o.integer("id");
  wall.name = o.text("name");
  wall.material = o.index("material", material_count, "materials");
  wall.kind = o.word<WallKind>("kind");
  switch (wall.kind) {
    case WallKind::plane:
      wall.point = o.vector("point");
      wall.normal = o.unit_vector("normal");
      break;
    case WallKind::box_inside:
      wall.lower = o.vector("lower");
      wall.upper = o.vector("upper");
      for (int k = 0; k < 3; ++k) {
        if (!(wall.lower[k] < wall.upper[k])) throw InputError("{}: lower is not below upper", o.where());
      }
      break;
    case WallKind::cylinder_inside:
      wall.axis_start = o.vector("axis_start");
      wall.axis_end = o.vector("axis_end");
      wall.radius = o.positive("radius");
      if (wall.axis_start == wall.axis_end) throw InputError("{}: the axis has no length", o.where());
      break;
    case WallKind::sphere_inside:
      wall.point = o.vector("point");
      wall.radius = o.positive("radius");
      break;
    case WallKind::mesh:
      wall.shape = o.index("shape", shapes.size(), "shapes");
      wall.scale = o.positive("scale");
      if (o.has("cell_size")) wall.cell_size = o.at_least("cell_size", 0);  // added later
      wall.position = o.vector("position");
      wall.orientation = o.quaternion("orientation");
      break;
  }
  wall.motion = read_motion(o.object("motion"));
  return wall;
}

}  // namespace

json settings_json(const Scene& scene) {
  // the writer visits members as if to change them, so it is given copies
  Settings s = scene.settings;
  json j;
  json& t = j["settings"];
  JsonKeyWriter writer(t);
  run_keys(writer, s);
  time_keys(writer, s);
  contact_keys(writer, s);
  motion_keys(writer, s);
  output_keys(writer, s);
  if (!s.checkpoint_by_clock) t["checkpoint_by_clock"] = false;
  json& domain = t["domain"];
  domain["bounded"] = s.domain.bounded;
  JsonKeyWriter domain_writer(domain);
  domain_keys(domain_writer, s.domain);
  if (s.fluid) {
    JsonKeyWriter fluid_writer(t["fluid"]);
    fluid_keys(fluid_writer, *s.fluid);
  }
  j["materials"] = json::array();
  for (Material m : scene.materials) {
    json& material = j["materials"].emplace_back();
    material["name"] = m.name;
    JsonKeyWriter material_writer(material);
    material_keys(material_writer, m);
  }
  j["pairs"] = json::array();
  for (MaterialPair p : scene.pairs) {
    json& pair = j["pairs"].emplace_back();
    pair["a"] = p.a;
    pair["b"] = p.b;
    JsonKeyWriter pair_writer(pair);
    pair_keys(pair_writer, p, s);
  }
  j["walls"] = json::array();
  for (const Wall& wall : scene.walls) j["walls"].push_back(wall_json(wall));
  return j;
}

void read_settings_json(const json& text, const std::string& where, Scene& scene) {
  const JsonObject all(text, where);
  scene.settings = read_settings(all.object("settings"));
  for (const JsonObject& o : all.objects("materials")) {
    Material& m = scene.materials.emplace_back();
    m.name = o.text("name");
    JsonKeyReader reader(o);
    material_keys(reader, m);
  }
  const std::size_t material_count = scene.materials.size();
  for (const JsonObject& o : all.objects("pairs")) {
    MaterialPair& p = scene.pairs.emplace_back();
    p.a = o.index("a", material_count, "materials");
    p.b = o.index("b", material_count, "materials");
    JsonKeyReader reader(o);
    pair_keys(reader, p, scene.settings);
  }
  for (const JsonObject& o : all.objects("walls")) scene.walls.push_back(read_wall(o, material_count, scene.shapes));
}

}  // namespace scree
