// What a person would read of a scene, as one JSON text: settings, materials, pairs, walls. Writing comes first, then reading.
#include "core/storage/scene_settings.hpp"

#include <nlohmann/json.hpp>

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
  if (const auto* several = std::get_if<Several>(&motion.kind)) {
    for (const WallMotion& part : several->parts) j["parts"].push_back(motion_json(part));
  }
  j["kind"] = motion.word();
  return j;
}

/// What gives a wall, or a region, its place.
void write_place(const Wall& wall, json& j) {
  j["kind"] = word_of(wall.kind);
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
}

json wall_json(const Wall& wall) {
  json j;
  j["id"] = wall.id;
  j["name"] = wall.name;
  j["material"] = wall.material;
  write_place(wall, j);
  j["motion"] = motion_json(wall.motion);
  if (wall.surface.is_given()) j["surface"] = motion_json(wall.surface.motion);
  if (wall.load_map) j["load_map"] = true;
  if (wall.wear > 0) j["wear"] = {{"coefficient", wall.wear}, {"every", wall.wear_every}};
  if (wall.heat.kind != WallHeatKind::adiabatic) {
    j["heat"] = {{"kind", word_of(wall.heat.kind)},
                 {"temperature", wall.heat.temperature.json()},
                 {"flux", wall.heat.flux.json()},
                 {"coefficient", wall.heat.coefficient}};
  }
  return j;
}

json region_json(const RegionShape& region) {
  json j;
  write_place(region, j);
  return j;
}

json inlet_json(const Inlet& inlet) {
  json j;
  j["name"] = inlet.name;
  j["region"] = region_json(inlet.region);
  for (const Inlet::Share& s : inlet.shares) j["shares"].push_back({{"shape", s.shape}, {"share", s.share}});
  j["material"] = inlet.material;
  if (inlet.size) {
    const SizeDistribution& d = *inlet.size;
    j["size"] = {{"distribution", word_of(d.kind)},
                 {"first", d.first},
                 {"second", d.second},
                 {"min", d.min},
                 {"max", d.max},
                 {"by_mass", d.by_mass},
                 {"sieve", d.sieve},
                 {"passing", d.passing}};
  }
  const BodyOrientation& o = inlet.orientation;
  json& turned = j["orientation"];
  turned["kind"] = o.kind == BodyOrientation::Kind::random ? "random" : o.kind == BodyOrientation::Kind::given ? "given" : "aligned";
  if (o.kind == BodyOrientation::Kind::given) turned["given"] = to_json(o.given);
  if (o.kind == BodyOrientation::Kind::aligned) {
    turned["align"] = to_json(o.direction);
    turned["scatter"] = o.scatter;
    if (o.axis == BodyOrientation::Axis::given)
      turned["body_axis"] = to_json(o.body_axis);
    else
      turned["axis"] = word_of(o.axis);
  }
  j["velocity"] = to_json(inlet.velocity);
  j["angular_velocity"] = to_json(inlet.angular_velocity);
  if (inlet.temperature > 0) j["temperature"] = inlet.temperature;
  j["rate"] = {{"of", inlet.rate.by_number ? "number" : "mass"}, {"time", inlet.rate.rate.time}, {"rate", inlet.rate.rate.value}};
  j["start"] = inlet.start;
  j["stop"] = inlet.stop;
  j["limit"] = inlet.limit;
  j["count"] = inlet.count;
  j["when_full"] = word_of(inlet.when_full);
  return j;
}

CellControl read_cell(const JsonObject& o, const Settings& s) {
  CellControl cell;
  const JsonObject rates = o.object("strain_rate"), stress = o.object("stress");
  for (std::size_t k = 0; k < kUpperNames.size(); ++k) {
    if (rates.has(kUpperNames[k])) cell.strain_rate[k] = TimeTable::read(rates, kUpperNames[k], "rates");
    // versions without a target of 0 wrote all, with 0 where none was asked for
    cell.is_stress_asked[k] =
        o.has("asked") ? stress.has(kUpperNames[k]) : stress.has(kUpperNames[k]) && stress.number(kUpperNames[k]) != 0;
    if (cell.is_stress_asked[k]) cell.stress[static_cast<int>(k)] = stress.number(kUpperNames[k]);
  }
  const JsonObject stop = o.object("stop_when");
  JsonKeyReader reader(stop);
  cell_stop_keys(reader, cell);
  if (const CellBlocker blocker = cell_blocker(s); blocker.key != nullptr)
    throw InputError("{}: does not go with {}: {}; the file is damaged", o.where(), blocker.key, blocker.why);
  return cell;
}

Settings read_settings(const JsonObject& o) {
  Settings s;
  // of files that were written before there was a choice
  s.weights = VertexWeights::unit;
  s.surface = TouchAt::outside;
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
  if (domain.has("shear")) {
    s.domain.shear = domain.vector("shear");
    const auto& periodic = s.domain.periodic;
    const bool across_z = s.domain.shear.x != 0 || s.domain.shear.y != 0;
    if (!s.domain.bounded || !periodic[0] || !periodic[1] || (across_z && !periodic[2]))
      throw InputError("{}: has a shear with an axis that is not periodic", domain.where());
  }
  if (o.has("fluid")) {
    const JsonObject fluid = o.object("fluid");
    JsonKeyReader fluid_reader(fluid);
    fluid_keys(fluid_reader, s.fluid.emplace());
  }
  if (o.has("heat")) {  // added later
    const JsonObject heat = o.object("heat");
    JsonKeyReader heat_reader(heat);
    heat_keys(heat_reader, s.heat.emplace());
    if (heat.has("source_tables")) {  // added later
      for (const JsonObject& table : heat.objects("source_tables"))
        s.heat->source_tables.push_back(TimeTable::read(table, "power", "powers"));
    }
  }
  if (o.has("cell")) s.cell = read_cell(o.object("cell"), s);  // added later
  return s;
}

WallMotion read_motion(const JsonObject& o) {
  WallMotion motion;
  const std::string word = o.text("kind");
  if (word == Several::kWord) {  // added later
    Several several;
    for (const JsonObject& part : o.objects("parts")) several.parts.push_back(read_motion(part));
    motion.kind = several;
    if (several.parts.empty()) throw InputError("{}: several motions without any; the file is damaged", o.where());
    if (const auto fault = motion.fault()) throw InputError("{}: {} {}", o.where(), fault->key, fault->text);
    return motion;
  }
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

void read_place(const JsonObject& o, const std::vector<Shape>& shapes, Wall& wall) {
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
}

Wall read_wall(const JsonObject& o, std::size_t material_count, const std::vector<Shape>& shapes) {
  Wall wall;
  wall.id = o.integer("id");
  wall.name = o.text("name");
  wall.material = o.index("material", material_count, "materials");
  read_place(o, shapes, wall);
  wall.motion = read_motion(o.object("motion"));
  if (o.has("surface")) {  // added later
    const JsonObject surface = o.object("surface");
    wall.surface.motion = read_motion(surface);
    const MotionKind& kind = wall.surface.motion.kind;
    if (!std::holds_alternative<Translate>(kind) && !std::holds_alternative<Rotate>(kind)) {
      throw InputError("{}.kind: '{}' found, expected {} or {}", surface.where(), wall.surface.motion.word(), Translate::kWord,
                       Rotate::kWord);
    }
  }
  if (o.has("load_map")) wall.load_map = o.boolean("load_map");  // added later
  if (wall.load_map && (wall.kind != WallKind::mesh || shapes[static_cast<std::size_t>(wall.shape)].mesh.triangles.empty()))
    throw InputError("{}: load_map of a wall without triangles; the file is damaged", o.where());
  if (o.has("wear")) {  // added later
    const JsonObject wear = o.object("wear");
    wall.wear = wear.positive("coefficient");
    wall.wear_every = wear.positive("every");
    if (!wall.load_map) throw InputError("{}: wear of a wall without a load map; the file is damaged", o.where());
  }
  if (o.has("heat")) {  // added later
    const JsonObject heat = o.object("heat");
    wall.heat.kind = heat.word<WallHeatKind>("kind");
    wall.heat.temperature = TimeTable::read(heat, "temperature", "temperatures");
    if (wall.heat.has_temperature() && !(wall.heat.temperature.least() > 0))
      throw InputError("{}.temperature: {:g} found, a value > 0 expected", heat.where(), wall.heat.temperature.least());
    wall.heat.flux = TimeTable::read(heat, "flux", "powers");
    wall.heat.coefficient = wall.heat.kind == WallHeatKind::exchange ? heat.positive("coefficient") : heat.at_least("coefficient", 0);
  }
  return wall;
}

RegionShape read_region(const JsonObject& o, const std::vector<Shape>& shapes) {
  RegionShape region;
  read_place(o, shapes, region);
  if (region.kind == WallKind::plane) throw InputError("{}: a plane holds nothing; the file is damaged", o.where());
  if (region.kind == WallKind::mesh && shapes[static_cast<std::size_t>(region.shape)].kind == ShapeKind::sphere) {
    throw InputError("{}: shape {} is no mesh; the file is damaged", o.where(), region.shape);
  }
  return region;
}

BodyOrientation read_orientation(const JsonObject& o) {
  BodyOrientation turned;
  const std::string kind = o.text("kind");
  if (kind == "given") {
    turned.kind = BodyOrientation::Kind::given;
    turned.given = o.quaternion("given");
  } else if (kind == "aligned") {
    turned.kind = BodyOrientation::Kind::aligned;
    turned.direction = o.unit_vector("align");
    turned.scatter = o.at_least("scatter", 0);
    if (o.has("body_axis")) {
      turned.axis = BodyOrientation::Axis::given;
      turned.body_axis = o.unit_vector("body_axis");
    } else {
      turned.axis = o.word<BodyOrientation::Axis>("axis");
    }
  } else if (kind != "random") {
    throw InputError("{}.kind: '{}' found, expected one of random, given, aligned", o.where(), kind);
  }
  return turned;
}

SizeDistribution read_size(const JsonObject& o) {
  SizeDistribution d;
  d.kind = o.word<SizeDistribution::Kind>("distribution");
  d.first = o.number("first");
  d.second = o.number("second");
  d.min = o.positive("min");
  d.max = o.at_least("max", d.min);
  d.by_mass = o.boolean("by_mass");
  d.sieve = o.numbers("sieve");
  d.passing = o.numbers("passing");
  if (d.sieve.size() != d.passing.size() || (d.kind == SizeDistribution::Kind::sieve && d.sieve.size() < 2)) {
    throw InputError("{}: {} sieves and {} shares; the file is damaged", o.where(), d.sieve.size(), d.passing.size());
  }
  return d;
}

Inlet read_inlet(const JsonObject& o, const Scene& scene) {
  Inlet inlet;
  inlet.name = o.text("name");
  inlet.region = read_region(o.object("region"), scene.shapes);
  for (const JsonObject& s : o.objects("shares")) {
    inlet.shares.push_back({s.index("shape", scene.shapes.size(), "shapes"), s.positive("share")});
    if (scene.shapes[static_cast<std::size_t>(inlet.shares.back().shape)].kind == ShapeKind::surface) {
      throw InputError("{}: shape {} is a wall surface without mass", s.where(), inlet.shares.back().shape);
    }
  }
  if (inlet.shares.empty()) throw InputError("{}.shares: empty; the file is damaged", o.where());
  inlet.material = o.index("material", scene.materials.size(), "materials");
  if (o.has("size")) inlet.size = read_size(o.object("size"));
  inlet.orientation = read_orientation(o.object("orientation"));
  inlet.velocity = o.vector("velocity");
  inlet.angular_velocity = o.vector("angular_velocity");
  if (o.has("temperature")) inlet.temperature = o.positive("temperature");  // added later
  if (scene.settings.heat) {
    const Material& material = scene.materials[static_cast<std::size_t>(inlet.material)];
    if (!(inlet.temperature > 0) || !material.has_heat())
      throw InputError(
          "{}: a scene with heat needs a temperature, and a heat_capacity and a conductivity of the material \"{}\"; the file is damaged",
          o.where(), material.name);
  }
  const JsonObject rate = o.object("rate");
  inlet.rate = {rate.text("of") == "number", {rate.numbers("time"), rate.numbers("rate")}};
  if (const auto fault = inlet.rate.fault()) throw InputError("{}: {}", rate.where(), *fault);
  inlet.start = o.number("start");
  inlet.stop = o.number("stop");
  inlet.limit = o.positive("limit");
  inlet.count = o.integer("count");
  inlet.when_full = o.word<WhenFull>("when_full");
  return inlet;
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
  if (!(s.domain.shear == Vec3{})) domain["shear"] = to_json(s.domain.shear);
  if (s.fluid) {
    JsonKeyWriter fluid_writer(t["fluid"]);
    fluid_keys(fluid_writer, *s.fluid);
  }
  if (s.heat) {
    JsonKeyWriter heat_writer(t["heat"]);
    heat_keys(heat_writer, *s.heat);
    for (const TimeTable& table : s.heat->source_tables) t["heat"]["source_tables"].push_back({{"power", table.json()}});
  }
  if (s.cell) {
    json& cell = t["cell"];
    const auto write = [&](const char* name, void (*keys)(KeyVisitor&, CellControl&)) {
      JsonKeyWriter part_writer(cell[name] = json::object());
      keys(part_writer, *s.cell);
    };
    cell["asked"] = true;
    for (const char* part : {"strain_rate", "stress"}) cell[part] = json::object();
    for (std::size_t k = 0; k < kUpperNames.size(); ++k) {
      if (!s.cell->strain_rate[k].value.empty()) cell["strain_rate"][kUpperNames[k]] = s.cell->strain_rate[k].json();
      if (s.cell->is_stress_asked[k]) cell["stress"][kUpperNames[k]] = s.cell->stress[static_cast<int>(k)];
    }
    write("stop_when", cell_stop_keys);
  }
  j["materials"] = json::array();
  for (Material m : scene.materials) {
    json& material = j["materials"].emplace_back();
    material["name"] = m.name;
    JsonKeyWriter material_writer(material);
    material_keys(material_writer, m);
    if (s.heat) material_heat_keys(material_writer, m);
  }
  j["pairs"] = json::array();
  for (MaterialPair p : scene.pairs) {
    json& pair = j["pairs"].emplace_back();
    pair["a"] = p.a;
    pair["b"] = p.b;
    JsonKeyWriter pair_writer(pair);
    pair_keys(pair_writer, p, s);
    if (s.heat) pair_heat_keys(pair_writer, p);
  }
  j["walls"] = json::array();
  for (const Wall& wall : scene.walls) j["walls"].push_back(wall_json(wall));
  for (const Inlet& inlet : scene.inlets) j["inlets"].push_back(inlet_json(inlet));
  for (const Outlet& outlet : scene.outlets) {
    json& o = j["outlets"].emplace_back();
    o["name"] = outlet.name;
    o["region"] = region_json(outlet.region);
    if (outlet.to >= 0) o["to"] = outlet.to;
  }
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
    if (scene.settings.heat) material_heat_keys(reader, m);
  }
  const std::size_t material_count = scene.materials.size();
  for (const JsonObject& o : all.objects("pairs")) {
    MaterialPair& p = scene.pairs.emplace_back();
    p.a = o.index("a", material_count, "materials");
    p.b = o.index("b", material_count, "materials");
    JsonKeyReader reader(o);
    pair_keys(reader, p, scene.settings);
    if (scene.settings.heat) pair_heat_keys(reader, p);
  }
  for (const JsonObject& o : all.objects("walls")) scene.walls.push_back(read_wall(o, material_count, scene.shapes));
  if (all.has("inlets")) {
    for (const JsonObject& o : all.objects("inlets")) scene.inlets.push_back(read_inlet(o, scene));
  }
  if (!all.has("outlets")) return;
  for (const JsonObject& o : all.objects("outlets")) {
    Outlet outlet{o.text("name"), read_region(o.object("region"), scene.shapes)};
    if (o.has("to")) outlet.to = o.index("to", scene.inlets.size(), "inlets");
    scene.outlets.push_back(std::move(outlet));
  }
}

}  // namespace scree
