// How a scene is stored: what a person would read (settings, materials, pairs, walls) is one JSON text, what
// there are many of (shapes, bodies, cut boxes) are arrays. The reader checks everything that the solver
// relies on, so that a damaged file stops here with its name and not in a kernel.
#include "core/storage/scene_file.hpp"

#include <cmath>
#include <new>
#include <set>
#include <stdexcept>

#include "core/base/error.hpp"

namespace scree {

namespace {

using nlohmann::json;

// A quaternion may have lost digits on its way through text or single precision; beyond this it is damage.
constexpr double kUnitTolerance = 1e-6;

// What is unit to rounding keeps its bits, so that reading a file and writing it again changes nothing.
constexpr double kUnitRounding = 1e-15;

// ---- values to JSON ----

json to_json(const Vec3& v) { return json::array({v.x, v.y, v.z}); }
json to_json(const Quat& q) { return json::array({q.w, q.x, q.y, q.z}); }

const char* const kWallKinds[] = {"plane", "box_inside", "cylinder_inside", "sphere_inside", "mesh"};
const char* const kMotionKinds[] = {"none", "rotate", "translate", "oscillate", "table"};

json motion_json(const WallMotion& motion) {
  json j;
  j["kind"] = kMotionKinds[static_cast<int>(motion.kind)];
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
  j["kind"] = kWallKinds[static_cast<int>(wall.kind)];
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

// ---- JSON to values ----

/// One JSON object inside a file, with its place in it for messages.
class Object {
 public:
  Object(const json& value, std::string where) : value_(value), where_(std::move(where)) {
    if (!value_.is_object()) throw InputError("{}: an object was expected, found {}; the file is damaged", where_, value_.type_name());
  }
  const json& at(const char* key) const {
    const auto it = value_.find(key);
    if (it == value_.end()) throw InputError("{}: '{}' is missing; the file is damaged", where_, key);
    return *it;
  }
  bool has(const char* key) const { return value_.contains(key); }
  Object object(const char* key) const { return {at(key), where_ + "." + key}; }
  std::vector<Object> objects(const char* key) const {
    const json& list = at(key);
    if (!list.is_array()) throw wrong(key, "a list", list);
    std::vector<Object> result;
    for (std::size_t i = 0; i < list.size(); ++i) result.emplace_back(list[i], fmt::format("{}.{}[{}]", where_, key, i));
    return result;
  }
  double number(const char* key) const { return number_of(at(key), key); }
  double at_least(const char* key, double smallest) const {
    const double value = number(key);
    if (value < smallest) throw InputError("{}.{}: {:g} found, at least {:g} expected", where_, key, value, smallest);
    return value;
  }
  double positive(const char* key) const {
    const double value = number(key);
    if (!(value > 0)) throw InputError("{}.{}: {:g} found, a value > 0 expected", where_, key, value);
    return value;
  }
  std::int64_t integer(const char* key) const {
    const json& value = at(key);
    if (!value.is_number_integer()) throw wrong(key, "a whole number", value);
    return value.get<std::int64_t>();
  }
  std::int32_t index(const char* key, std::size_t count, const char* of) const {
    const std::int64_t value = integer(key);
    if (value < 0 || value >= static_cast<std::int64_t>(count)) {
      throw InputError("{}.{}: {} found, but there are {} {}", where_, key, value, count, of);
    }
    return static_cast<std::int32_t>(value);
  }
  bool boolean(const char* key) const {
    const json& value = at(key);
    if (!value.is_boolean()) throw wrong(key, "true or false", value);
    return value.get<bool>();
  }
  std::string text(const char* key) const {
    const json& value = at(key);
    if (!value.is_string()) throw wrong(key, "a text", value);
    return value.get<std::string>();
  }
  std::string one_of(const char* key, std::initializer_list<const char*> allowed) const {
    std::string value = text(key), list;
    for (const char* word : allowed) {
      if (value == word) return value;
      list += (list.empty() ? "" : ", ") + std::string(word);
    }
    throw InputError("{}.{}: '{}' found, expected one of {}", where_, key, value, list);
  }
  Vec3 vector(const char* key) const { return vector_of(at(key), key); }
  Vec3 unit_vector(const char* key) const {
    const Vec3 v = vector(key);
    if (std::abs(length(v) - 1) > kUnitTolerance) {
      throw InputError("{}.{}: length {:.9g} found, a unit vector expected", where_, key, length(v));
    }
    return std::abs(length(v) - 1) > kUnitRounding ? normalised(v) : v;
  }
  Quat quaternion(const char* key) const {
    const json& list = array_of(at(key), key, 4);
    const Quat q{number_of(list[0], key), number_of(list[1], key), number_of(list[2], key), number_of(list[3], key)};
    if (!(std::abs(norm(q) - 1) <= kUnitTolerance)) {
      throw InputError("{}.{}: norm {:.9g} found, a unit quaternion expected", where_, key, norm(q));
    }
    return std::abs(norm(q) - 1) > kUnitRounding ? normalised(q) : q;
  }
  std::vector<double> numbers(const char* key) const {
    std::vector<double> values;
    const json& list = at(key);
    if (!list.is_array()) throw wrong(key, "a list", list);
    for (const json& value : list) values.push_back(number_of(value, key));
    return values;
  }
  std::vector<Vec3> vectors(const char* key) const {
    std::vector<Vec3> values;
    const json& list = at(key);
    if (!list.is_array()) throw wrong(key, "a list", list);
    for (const json& value : list) values.push_back(vector_of(value, key));
    return values;
  }
  const std::string& where() const { return where_; }

 private:
  InputError wrong(const char* key, const char* expected, const json& found) const {
    return InputError("{}.{}: {} found, {} expected; the file is damaged", where_, key, found.dump(), expected);
  }
  double number_of(const json& value, const char* key) const {
    // JSON has no NaN or infinity: they were written as null
    if (!value.is_number()) throw wrong(key, "a finite number", value);
    return value.get<double>();
  }
  const json& array_of(const json& value, const char* key, std::size_t size) const {
    if (!value.is_array() || value.size() != size) throw wrong(key, size == 3 ? "three numbers" : "four numbers", value);
    return value;
  }
  Vec3 vector_of(const json& value, const char* key) const {
    const json& list = array_of(value, key, 3);
    return {number_of(list[0], key), number_of(list[1], key), number_of(list[2], key)};
  }

  const json& value_;
  std::string where_;
};

Settings read_settings(const Object& o) {
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
  if (o.has("step_control")) s.step_control = o.one_of("step_control", {"fixed", "quantised"});
  const Object domain = o.object("domain");
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
  s.domain.outside = domain.one_of("outside", {"stop", "remove", "keep"});
  s.law = o.one_of("law", {"linear", "hunt-crossley", "hertz-mindlin"});
  s.gather = o.one_of("gather", {"potential", "area", "pairs"});
  if (o.has("barrier")) s.barrier = o.at_least("barrier", 0);
  if (o.has("impact_speed")) s.impact_speed = o.at_least("impact_speed", 0);
  s.margin = o.at_least("margin", 0);
  s.integrator = o.one_of("integrator", {"kdk-dlm", "rig", "spiral", "midpoint", "euler"});
  s.distance_method = o.one_of("distance_method", {"brute-force", "penalty", "hybrid"});
  s.distance_precision = o.one_of("distance_precision", {"double", "mixed"});
  s.output_every = o.at_least("output_every", 0);
  s.output_contacts = o.boolean("output_contacts");
  s.checkpoint_every = o.at_least("checkpoint_every", 0);
  return s;
}

WallMotion read_motion(const Object& o) {
  WallMotion motion;
  const std::string kind = o.one_of("kind", {"none", "rotate", "translate", "oscillate", "table"});
  for (int k = 0; k < 5; ++k) {
    if (kind == kMotionKinds[k]) motion.kind = static_cast<WallMotion::Kind>(k);
  }
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

Wall read_wall(const Object& o, std::size_t material_count, const std::vector<Shape>& shapes) {
  Wall wall;
  wall.id = o.integer("id");
  wall.name = o.text("name");
  wall.material = o.index("material", material_count, "materials");
  const std::string kind = o.one_of("kind", {"plane", "box_inside", "cylinder_inside", "sphere_inside", "mesh"});
  for (int k = 0; k < 5; ++k) {
    if (kind == kWallKinds[k]) wall.kind = static_cast<WallKind>(k);
  }
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

json parse_text(const h5::Group& root, const char* name) {
  const std::string text = root.read_text(name);
  json value = json::parse(text, nullptr, false);
  if (value.is_discarded()) throw InputError("{}/{}: not valid JSON; the file is truncated or damaged, make it again", root.path(), name);
  return value;
}

// ---- bodies ----

void write_bodies(const h5::Group& group, const BodyTable& bodies) {
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
    if (!(b.scale[i] > 0) || !std::isfinite(b.scale[i])) throw wrong(fmt::format("scale {:g} found, a value > 0 expected", b.scale[i]));
    if (!is_finite(b.position[i])) throw wrong("the position is not a finite number");
    if (!is_finite(b.velocity[i]) || !is_finite(b.angular_velocity[i])) throw wrong("a velocity is not a finite number");
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

}  // namespace

const MaterialPair& Scene::pair(std::int32_t a, std::int32_t b) const {
  for (const MaterialPair& p : pairs) {
    if ((p.a == a && p.b == b) || (p.a == b && p.b == a)) return p;
  }
  const auto name = [&](std::int32_t m) {
    return m >= 0 && static_cast<std::size_t>(m) < materials.size() ? materials[static_cast<std::size_t>(m)].name : std::to_string(m);
  };
  throw InputError("the scene has no contact properties for the materials '{}' and '{}'; add [[pairs]] between = [\"{}\", \"{}\"]",
                   name(a), name(b), name(a), name(b));
}

double Scene::mass(std::size_t body) const {
  const double scale = bodies.scale[body];
  const auto shape = static_cast<std::size_t>(bodies.shape[body]), material = static_cast<std::size_t>(bodies.material[body]);
  return materials[material].density * shapes[shape].mass.volume * scale * scale * scale;
}

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
  t["step_control"] = s.step_control;
  t["stop_at_rest"] = s.stop_at_rest;
  json& domain = t["domain"];
  domain["bounded"] = s.domain.bounded;
  if (s.domain.bounded) {
    domain["min"] = to_json(s.domain.lower);
    domain["max"] = to_json(s.domain.upper);
  }
  domain["periodic"] = s.domain.periodic;
  domain["outside"] = s.domain.outside;
  t["law"] = s.law;
  t["gather"] = s.gather;
  t["impact_speed"] = s.impact_speed;
  t["barrier"] = s.barrier;
  t["margin"] = s.margin;
  t["integrator"] = s.integrator;
  t["distance_method"] = s.distance_method;
  t["distance_precision"] = s.distance_precision;
  t["output_every"] = s.output_every;
  t["output_contacts"] = s.output_contacts;
  t["checkpoint_every"] = s.checkpoint_every;

  j["materials"] = json::array();
  for (const Material& m : scene.materials) {
    j["materials"].push_back({{"name", m.name}, {"density", m.density}, {"young", m.young}, {"poisson", m.poisson}});
  }
  j["pairs"] = json::array();
  for (const MaterialPair& p : scene.pairs) {
    j["pairs"].push_back({{"a", p.a}, {"b", p.b}, {"stiffness", p.stiffness}, {"restitution", p.restitution},
                          {"friction", p.friction}, {"friction_sliding", p.friction_sliding},
                          {"rolling_friction", p.rolling_friction}, {"torsional_friction", p.torsional_friction},
                          {"rolling_model", p.rolling_model}, {"tangential_ratio", p.tangential_ratio},
                          {"tangential_damping", p.tangential_damping},
                          {"restitution_speed", p.restitution_speed}, {"contact_radius", p.contact_radius},
                          {"layer_modulus", p.layer_modulus}});
  }
  j["walls"] = json::array();
  for (const Wall& wall : scene.walls) j["walls"].push_back(wall_json(wall));
  return j;
}

double effective_modulus(const Material& a, const Material& b) {
  return 1 / ((1 - a.poisson * a.poisson) / a.young + (1 - b.poisson * b.poisson) / b.young);
}

double effective_shear_modulus(const Material& a, const Material& b) {
  return 1 / (2 * (2 - a.poisson) * (1 + a.poisson) / a.young + 2 * (2 - b.poisson) * (1 + b.poisson) / b.young);
}

double hertz_impact_depth(double modulus, double radius, double mass, double speed) {
  return std::pow(15 * mass * speed * speed / (16 * modulus * std::sqrt(radius)), 0.4);
}

void write_scene_file(const std::string& path, const Scene& scene) {
  h5::NewFile file(path);
  const h5::Group& root = file.root();
  root.write_attribute("format", kSceneFormat);
  root.write_attribute("format_version", kSceneFormatVersion);
  root.write_text("provenance", scene.provenance.dump());
  root.write_text("settings", settings_json(scene).dump(1));
  write_shapes(root.create_group("shapes"), scene.shapes);
  const h5::Group partition = root.create_group("partition");
  partition.write_attribute("ranks", scene.partition.ranks);
  partition.write_attribute("predicted_imbalance", scene.partition.predicted_imbalance);
  partition.write_attribute("method", scene.partition.method);
  if (scene.partition.ranks > 0 && scene.partition.method == "rcb") {
    partition.write_array("lower", scene.partition.lower, "m");
    partition.write_array("upper", scene.partition.upper, "m");
  }
  write_bodies(root.create_group("bodies"), scene.bodies);
  file.commit();
}

namespace {
Scene read_scene(const std::string& path) {
  const h5::File file(path);
  const h5::Group& root = file.root();
  check_format(root, kSceneFormat, kSceneFormatVersion);
  Scene scene;
  scene.provenance = parse_text(root, "provenance");
  scene.shapes = read_shapes(root.open_group("shapes"));

  const json text = parse_text(root, "settings");
  const Object all(text, root.path() + "/settings");
  scene.settings = read_settings(all.object("settings"));
  for (const Object& o : all.objects("materials")) {
    scene.materials.push_back({o.text("name"), o.positive("density"), o.at_least("young", 0), o.number("poisson")});
  }
  const std::size_t material_count = scene.materials.size();
  for (const Object& o : all.objects("pairs")) {
    MaterialPair p;
    p.a = o.index("a", material_count, "materials");
    p.b = o.index("b", material_count, "materials");
    // a Hertz contact and a layer have no stiffness of their own: it comes from the materials
    const bool no_stiffness = scene.settings.law == "hertz-mindlin" || scene.settings.gather == "area";
    p.stiffness = no_stiffness ? o.at_least("stiffness", 0) : o.positive("stiffness");
    p.restitution = o.positive("restitution");
    if (p.restitution > 1) throw InputError("{}.restitution: {:g} found, a value in (0, 1] expected", o.where(), p.restitution);
    p.friction = o.at_least("friction", 0);
    p.friction_sliding = o.number("friction_sliding");
    p.rolling_friction = o.at_least("rolling_friction", 0);
    // added later: files without them mean the defaults
    if (o.has("torsional_friction")) p.torsional_friction = o.at_least("torsional_friction", 0);
    if (o.has("rolling_model")) p.rolling_model = o.one_of("rolling_model", {"elastic-plastic", "constant"});
    if (o.has("tangential_ratio")) p.tangential_ratio = o.number("tangential_ratio");
    if (o.has("tangential_damping")) p.tangential_damping = o.at_least("tangential_damping", 0);
    if (o.has("restitution_speed")) p.restitution_speed = o.at_least("restitution_speed", 0);
    if (o.has("layer_modulus")) p.layer_modulus = o.at_least("layer_modulus", 0);
    if (o.has("contact_radius")) p.contact_radius = o.at_least("contact_radius", 0);
    scene.pairs.push_back(p);
  }
  for (const Object& o : all.objects("walls")) scene.walls.push_back(read_wall(o, material_count, scene.shapes));

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
