// What a person would read of a scene, as one JSON text: settings, materials, pairs, walls. Writing comes first, then reading.
#include "core/storage/scene_settings.hpp"

#include "core/storage/json_object.hpp"

namespace scree {

namespace {

using nlohmann::json;

json to_json(const Vec3& v) { return json::array({v.x, v.y, v.z}); }
json to_json(const Quat& q) { return json::array({q.w, q.x, q.y, q.z}); }

json motion_json(const WallMotion& motion) {
  json j;
  j["kind"] = word_of(motion.kind);
  if (motion.kind == WallMotion::Kind::none) return j;
  j["axis"] = to_json(motion.axis);
  j["centre"] = to_json(motion.centre);
  j["rate"] = motion.rate;
  j["amplitude"] = motion.amplitude;
  j["frequency"] = motion.frequency;
  j["phase"] = motion.phase;
  j["start"] = motion.start;
  j["stop"] = motion.stop;
  j["table_time"] = motion.table_time;
  j["table_position"] = json::array();
  for (const Vec3& p : motion.table_position) j["table_position"].push_back(to_json(p));
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
  s.title = o.text("title");
  const json& seed = o.at("seed");
  if (!seed.is_number_unsigned()) throw InputError("{}.seed: {} found, a whole number >= 0 expected", o.where(), seed.dump());
  s.seed = seed.get<std::uint64_t>();
  s.gravity = o.vector("gravity");
  s.duration = o.at_least("duration", 0);
  s.steps_per_contact = o.positive("steps_per_contact");
  s.step = o.at_least("step", 0);
  if (o.has("stop_at_rest")) s.stop_at_rest = o.boolean("stop_at_rest");
  if (o.has("step_control")) s.step_control = o.word<StepControl>("step_control");
  const JsonObject domain = o.object("domain");
  s.domain.bounded = domain.boolean("bounded");
  if (s.domain.bounded) {
    s.domain.lower = domain.vector("min");
    s.domain.upper = domain.vector("max");
    for (int k = 0; k < 3; ++k) {
      if (!(s.domain.lower[k] < s.domain.upper[k])) throw InputError("{}: min is not below max", domain.where());
    }
  }
  const json& periodic = domain.at("periodic");
  if (!periodic.is_array() || periodic.size() != 3) throw InputError("{}.periodic: three values expected", domain.where());
  for (std::size_t k = 0; k < 3; ++k) {
    if (!periodic[k].is_boolean()) throw InputError("{}.periodic: true or false expected", domain.where());
    s.domain.periodic[k] = periodic[k].get<bool>();
  }
  s.domain.outside = domain.word<Outside>("outside");
  if (o.has("fluid")) {
    const JsonObject fluid = o.object("fluid");
    s.fluid = {fluid.positive("density"), fluid.positive("viscosity"), fluid.vector("velocity"), fluid.word<Drag>("drag")};
  }
  s.law = o.word<ContactLaw>("law");
  s.gather = o.word<Gathering>("gather");
  if (o.has("barrier")) s.barrier = o.at_least("barrier", 0);
  if (o.has("impact_speed")) s.impact_speed = o.at_least("impact_speed", 0);
  s.margin = o.at_least("margin", 0);
  s.integrator = o.word<Integrator>("integrator");
  s.output_every = o.at_least("output_every", 0);
  s.output_contacts = o.boolean("output_contacts");
  s.checkpoint_every = o.at_least("checkpoint_every", 0);
  if (o.has("checkpoint_by_clock")) s.checkpoint_by_clock = o.boolean("checkpoint_by_clock");  // added later
  return s;
}

WallMotion read_motion(const JsonObject& o) {
  WallMotion motion;
  motion.kind = o.word<WallMotion::Kind>("kind");
  if (motion.kind == WallMotion::Kind::none) return motion;
  motion.axis = o.unit_vector("axis");
  motion.centre = o.vector("centre");
  motion.rate = o.number("rate");
  motion.amplitude = o.number("amplitude");
  motion.frequency = o.number("frequency");
  motion.phase = o.number("phase");
  motion.start = o.number("start");
  motion.stop = o.number("stop");
  motion.table_time = o.numbers("table_time");
  motion.table_position = o.vectors("table_position");
  if (motion.table_time.size() != motion.table_position.size()) {
    throw InputError("{}: table_time has {} rows, table_position {}", o.where(), motion.table_time.size(), motion.table_position.size());
  }
  for (std::size_t i = 1; i < motion.table_time.size(); ++i) {
    if (!(motion.table_time[i - 1] < motion.table_time[i])) throw InputError("{}: table_time does not ascend at row {}", o.where(), i);
  }
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
  const Settings& s = scene.settings;
  json j;
  json& t = j["settings"];
  t["title"] = s.title;
  t["seed"] = s.seed;
  t["gravity"] = to_json(s.gravity);
  t["duration"] = s.duration;
  t["steps_per_contact"] = s.steps_per_contact;
  t["step"] = s.step;
  t["step_control"] = word_of(s.step_control);
  t["stop_at_rest"] = s.stop_at_rest;
  json& domain = t["domain"];
  domain["bounded"] = s.domain.bounded;
  if (s.domain.bounded) {
    domain["min"] = to_json(s.domain.lower);
    domain["max"] = to_json(s.domain.upper);
  }
  domain["periodic"] = s.domain.periodic;
  domain["outside"] = word_of(s.domain.outside);
  if (s.fluid) {
    t["fluid"] = {{"density", s.fluid->density},
                  {"viscosity", s.fluid->viscosity},
                  {"velocity", to_json(s.fluid->velocity)},
                  {"drag", word_of(s.fluid->drag)}};
  }
  t["law"] = word_of(s.law);
  t["gather"] = word_of(s.gather);
  t["impact_speed"] = s.impact_speed;
  t["barrier"] = s.barrier;
  t["margin"] = s.margin;
  t["integrator"] = word_of(s.integrator);
  t["output_every"] = s.output_every;
  t["output_contacts"] = s.output_contacts;
  t["checkpoint_every"] = s.checkpoint_every;
  if (!s.checkpoint_by_clock) t["checkpoint_by_clock"] = false;

  j["materials"] = json::array();
  for (const Material& m : scene.materials) {
    j["materials"].push_back({{"name", m.name}, {"density", m.density}, {"young", m.young}, {"poisson", m.poisson}});
  }
  j["pairs"] = json::array();
  for (const MaterialPair& p : scene.pairs) {
    j["pairs"].push_back({{"a", p.a},
                          {"b", p.b},
                          {"stiffness", p.stiffness},
                          {"restitution", p.restitution},
                          {"friction", p.friction},
                          {"friction_sliding", p.friction_sliding},
                          {"rolling_friction", p.rolling_friction},
                          {"torsional_friction", p.torsional_friction},
                          {"rolling_model", word_of(p.rolling_model)},
                          {"tangential_ratio", p.tangential_ratio},
                          {"tangential_damping", p.tangential_damping},
                          {"restitution_speed", p.restitution_speed},
                          {"contact_radius", p.contact_radius},
                          {"layer_modulus", p.layer_modulus}});
  }
  j["walls"] = json::array();
  for (const Wall& wall : scene.walls) j["walls"].push_back(wall_json(wall));
  return j;
}

void read_settings_json(const json& text, const std::string& where, Scene& scene) {
  const JsonObject all(text, where);
  scene.settings = read_settings(all.object("settings"));
  for (const JsonObject& o : all.objects("materials")) {
    scene.materials.push_back({o.text("name"), o.positive("density"), o.at_least("young", 0), o.number("poisson")});
  }
  const std::size_t material_count = scene.materials.size();
  for (const JsonObject& o : all.objects("pairs")) {
    MaterialPair p;
    p.a = o.index("a", material_count, "materials");
    p.b = o.index("b", material_count, "materials");
    // a Hertz contact and a layer have no stiffness of their own: it comes from the materials
    const bool no_stiffness = scene.settings.law == ContactLaw::hertz_mindlin || scene.settings.gather == Gathering::area;
    p.stiffness = no_stiffness ? o.at_least("stiffness", 0) : o.positive("stiffness");
    p.restitution = o.at_least("restitution", 0);
    if (p.restitution > 1) throw InputError("{}.restitution: {:g} found, a value from 0 to 1 expected", o.where(), p.restitution);
    p.friction = o.at_least("friction", 0);
    p.friction_sliding = o.number("friction_sliding");
    p.rolling_friction = o.at_least("rolling_friction", 0);
    // added later: files without them mean the defaults
    if (o.has("torsional_friction")) p.torsional_friction = o.at_least("torsional_friction", 0);
    if (o.has("rolling_model")) p.rolling_model = o.word<RollingModel>("rolling_model");
    if (o.has("tangential_ratio")) p.tangential_ratio = o.number("tangential_ratio");
    if (o.has("tangential_damping")) p.tangential_damping = o.at_least("tangential_damping", 0);
    if (o.has("restitution_speed")) p.restitution_speed = o.at_least("restitution_speed", 0);
    if (o.has("layer_modulus")) p.layer_modulus = o.at_least("layer_modulus", 0);
    if (o.has("contact_radius")) p.contact_radius = o.at_least("contact_radius", 0);
    scene.pairs.push_back(p);
  }
  for (const JsonObject& o : all.objects("walls")) scene.walls.push_back(read_wall(o, material_count, scene.shapes));
}

}  // namespace scree
