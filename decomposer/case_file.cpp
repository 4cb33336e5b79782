#include "decomposer/case_file.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <sstream>
#include <tuple>

#include "decomposer/case_settings.hpp"
#include "decomposer/case_table.hpp"

namespace scree {

namespace {

// A quaternion typed by hand has few digits; a wrong one is off by far more.
constexpr double kTypedQuaternionTolerance = 1e-3;

std::string resolved(const std::string& folder, const std::string& file) {
  const std::filesystem::path path(file);
  return path.is_absolute() || folder.empty() ? file : (std::filesystem::path(folder) / path).lexically_normal().string();
}

Quat read_orientation(const CaseTable& t) {
  if (!t.has("orientation")) return {};
  const std::vector<double> q = t.numbers("orientation", Dimension::none);
  if (q.size() != 4) throw t.error("orientation", "expected a unit quaternion [w, x, y, z]");
  const Quat found{q[0], q[1], q[2], q[3]};
  if (!(std::abs(norm(found) - 1) < kTypedQuaternionTolerance)) {
    throw t.error("orientation", fmt::format("has norm {:.6g}; expected a unit quaternion [w, x, y, z]", norm(found)));
  }
  return normalised(found);
}

void read_settings(const CaseTable& top, Case& c) {
  Settings& s = c.settings;
  s.title = top.has("title") ? top.text("title") : std::filesystem::path(c.path).stem().string();
  s.seed = top.has("seed") ? static_cast<std::uint64_t>(top.integer("seed", 0)) : 0;
  s.gravity = top.vector_or("gravity", Dimension::acceleration, {0, 0, -9.81});

  const CaseTable time = top.table("time", {"duration", "steps_per_contact", "step", "step_control"});
  s.duration = time.number("duration", Dimension::time, Range::not_negative);
  s.steps_per_contact = time.number_or("steps_per_contact", Dimension::none, 30, Range::positive);
  s.step = time.number_or("step", Dimension::time, 0, Range::positive);
  s.step_control = time.word_or("step_control", s.step_control, {"fixed", "quantised"}, {"fixed", "quantised"});
  if (time.has("step") && time.has("steps_per_contact")) {
    throw time.error("step", "the step is given twice; give either step or steps_per_contact");
  }

  if (top.has("domain")) {
    const CaseTable domain = top.table("domain", {"min", "max", "periodic", "outside"});
    if (domain.has("periodic")) {
      for (const std::string& axis : domain.texts("periodic")) {
        if (axis != "x" && axis != "y" && axis != "z") throw domain.error("periodic", "\"" + axis + "\": expected \"x\", \"y\" or \"z\"");
        s.domain.periodic[static_cast<std::size_t>(axis[0] - 'x')] = true;
      }
      if (!domain.has("min")) throw domain.error("periodic", "a periodic axis needs min and max");
    }
    s.domain.outside = domain.word_or("outside", "stop", {"stop", "remove", "keep"}, {"stop", "remove", "keep"});
    if (domain.has("min") || domain.has("max")) {
      s.domain.bounded = true;
      s.domain.lower = domain.vector("min", Dimension::length);
      s.domain.upper = domain.vector("max", Dimension::length);
      for (int k = 0; k < 3; ++k) {
        if (!(s.domain.lower[k] < s.domain.upper[k])) throw domain.error("min", "must be below max in x, y and z");
      }
    }
  }
  if (top.has("contact")) {
    const CaseTable contact = top.table("contact", {"law", "gather", "margin", "impact_speed", "relax"});
    s.law = contact.word_or("law", s.law, {"linear", "hunt-crossley", "hertz-mindlin"}, {"linear", "hunt-crossley", "hertz-mindlin"});
    s.impact_speed = contact.number_or("impact_speed", Dimension::velocity, 0, Range::positive);
    s.gather = contact.word_or("gather", s.gather, {"potential", "area", "pairs"}, {"potential", "pairs"});
    c.margin_given = contact.has("margin");
    c.relax = contact.boolean_or("relax", false);
    s.margin = contact.number_or("margin", Dimension::length, 0, Range::not_negative);
  }
  if (top.has("motion")) {
    s.integrator = top.table("motion", {"integrator"})
                       .word_or("integrator", s.integrator, {"kdk-dlm", "rig", "spiral", "midpoint", "euler"},
                                {"kdk-dlm", "rig", "spiral", "midpoint", "euler"});
  }
  if (top.has("distance")) {
    const CaseTable distance = top.table("distance", {"method", "precision"});
    s.distance_method = distance.word_or("method", s.distance_method, {"brute-force", "penalty", "hybrid"}, {"brute-force"});
    s.distance_precision = distance.word_or("precision", s.distance_precision, {"double", "mixed"}, {"double", "mixed"});
  }
  s.output_every = s.duration / 100;
  if (top.has("output")) {
    const CaseTable output = top.table("output", {"every", "contacts", "checkpoint"});
    s.output_every = output.number_or("every", Dimension::time, s.output_every, Range::positive);
    s.output_contacts = output.boolean_or("contacts", true);
    s.checkpoint_every = output.number_or("checkpoint", Dimension::time, 0, Range::positive);
  }
}

void read_shapes(const CaseTable& top, const std::string& folder, Case& c) {
  for (const auto& [name, t] : top.named_tables("shapes", {"file", "name", "sphere"})) {
    CaseShape shape;
    shape.name = name;
    shape.where = t.where();
    if (t.only_one_of({"file", "sphere"}) == "file") {
      shape.file = resolved(folder, t.text("file"));
      if (t.has("name")) shape.name_in_file = t.text("name");
    } else {
      shape.sphere_radius = t.table("sphere", {"radius"}).number("radius", Dimension::length, Range::positive);
      if (t.has("name")) throw t.error("name", "names one of several shapes in a file; a sphere has no file");
    }
    c.shapes.push_back(shape);
  }
}

void read_materials(const CaseTable& top, Case& c) {
  for (const auto& [name, t] : top.named_tables("materials", {"density", "young", "poisson"})) {
    Material m;
    m.name = name;
    m.density = t.number("density", Dimension::density, Range::positive);
    m.young = t.number_or("young", Dimension::pressure, 0, Range::positive);
    m.poisson = t.number_or("poisson", Dimension::none, 0);
    if (!(m.poisson > -1 && m.poisson <= 0.5)) throw t.error("poisson", "expected a value above -1 and at most 0.5");
    c.materials.push_back(m);
  }
}

void read_pairs(const CaseTable& top, const std::vector<std::string>& materials, Case& c) {
  for (const CaseTable& t : top.tables("pairs", {"between", "stiffness", "restitution", "friction", "friction_sliding",
                                                 "rolling_friction", "torsional_friction", "rolling_model", "tangential_ratio", "tangential_damping",
                                                 "restitution_speed", "contact_radius"})) {
    CasePair p;
    p.where = t.where();
    const std::vector<std::string> between = t.texts("between");
    if (between.size() != 2) throw t.error("between", "expected two material names, for instance [\"rock\", \"steel\"]");
    p.pair.a = t.find_name("between", between[0], materials, "material");
    p.pair.b = t.find_name("between", between[1], materials, "material");
    if (p.pair.a > p.pair.b) std::swap(p.pair.a, p.pair.b);
    for (const CasePair& other : c.pairs) {
      if (other.pair.a == p.pair.a && other.pair.b == p.pair.b) throw t.error("between", "is given twice; first at " + other.where);
    }
    const bool hertz = c.settings.law == "hertz-mindlin";
    if (hertz && t.has("stiffness")) {
      throw t.error("stiffness", "is not used with contact.law = \"hertz-mindlin\", whose stiffness follows from young and poisson of the materials; remove it");
    }
    if (!hertz) p.pair.stiffness = t.number("stiffness", Dimension::stiffness, Range::positive);
    p.pair.restitution = t.number("restitution", Dimension::none, Range::unit_interval);
    p.pair.friction = t.number_or("friction", Dimension::none, 0, Range::not_negative);
    p.pair.friction_sliding = t.number_or("friction_sliding", Dimension::none, -1);
    if (t.has("friction_sliding") && !(p.pair.friction_sliding >= 0 && p.pair.friction_sliding <= p.pair.friction)) {
      throw t.error("friction_sliding", fmt::format("expected a value from 0 to friction ({:g})", p.pair.friction));
    }
    p.pair.rolling_friction = t.number_or("rolling_friction", Dimension::none, 0, Range::not_negative);
    p.pair.torsional_friction = t.number_or("torsional_friction", Dimension::none, 0, Range::not_negative);
    p.pair.rolling_model = t.word_or("rolling_model", p.pair.rolling_model, {"elastic-plastic", "constant"}, {"elastic-plastic", "constant"});
    p.pair.tangential_ratio = t.number_or("tangential_ratio", Dimension::none, -1, Range::any);
    if (t.has("tangential_ratio") && !(p.pair.tangential_ratio >= 0)) throw t.error("tangential_ratio", "expected a value >= 0");
    p.pair.tangential_damping = t.number_or("tangential_damping", Dimension::none, 1, Range::not_negative);
    p.pair.contact_radius = t.number_or("contact_radius", Dimension::length, 0, Range::positive);
    p.pair.restitution_speed = t.number_or("restitution_speed", Dimension::velocity, 0, Range::positive);
    const bool hunt_crossley = c.settings.law == "hunt-crossley";
    if (t.has("restitution_speed") && !hunt_crossley) {
      throw t.error("restitution_speed", "is for contact.law = \"hunt-crossley\"; with other laws restitution does not depend on speed");
    }
    if (hunt_crossley && p.pair.restitution < 1 && !t.has("restitution_speed")) {
      throw t.error("restitution", "depends on the speed of the impact with contact.law = \"hunt-crossley\"; add restitution_speed, the speed "
                                   "at which it holds");
    }
    if (hertz) {
      for (const std::int32_t m : {p.pair.a, p.pair.b}) {
        const Material& material = c.materials[static_cast<std::size_t>(m)];
        if (!(material.young > 0)) {
          throw t.error("between", fmt::format("the material \"{}\" needs young (Young's modulus) for contact.law = \"hertz-mindlin\"", material.name));
        }
      }
    }
    c.pairs.push_back(p);
  }
}

void read_bodies(const CaseTable& top, const std::vector<std::string>& shapes, const std::vector<std::string>& materials, Case& c) {
  for (const CaseTable& t : top.tables("bodies", {"shape", "material", "position", "orientation", "velocity", "angular_velocity",
                                                  "scale", "fixed", "lock_rotation"})) {
    CaseBody b;
    b.where = t.where();
    b.shape = t.reference("shape", shapes, "shape");
    b.material = t.reference("material", materials, "material");
    b.position = t.vector("position", Dimension::length);
    b.orientation = read_orientation(t);
    b.velocity = t.vector_or("velocity", Dimension::velocity, {});
    b.angular_velocity = t.vector_or("angular_velocity", Dimension::angular_velocity, {});
    b.scale = t.number_or("scale", Dimension::none, 1, Range::positive);
    b.fixed = t.boolean_or("fixed", false);
    b.lock_rotation = t.boolean_or("lock_rotation", false);
    if (b.fixed && (length(b.velocity) > 0 || length(b.angular_velocity) > 0)) {
      throw t.error("fixed", "a fixed body cannot have a velocity; remove it, or use a wall with a motion");
    }
    c.bodies.push_back(b);
  }
}

SizeDistribution read_size(const CaseTable& population) {
  SizeDistribution d;
  const auto fixed = [&](double diameter) { d.first = d.min = d.max = diameter; };
  const std::vector<std::string> keys = {"distribution", "diameter", "mean", "median", "sigma", "scale", "shape", "exponent", "min", "max"};
  if (!population.is_table("size")) {
    fixed(population.number("size", Dimension::length, Range::positive));
    return d;
  }
  const CaseTable t = population.table("size", keys);
  const std::string kind = t.has("distribution") ? t.text("distribution") : "";
  std::vector<std::string> used = {"distribution"};
  const auto length_of = [&](const char* key) {
    used.emplace_back(key);
    return t.number(key, Dimension::length, Range::positive);
  };
  const auto plain = [&](const char* key, Range range) {
    used.emplace_back(key);
    return t.number(key, Dimension::none, range);
  };
  if (kind == "fixed") {
    fixed(length_of("diameter"));
  } else {
    if (kind == "uniform") {
      d.kind = SizeDistribution::Kind::uniform;
    } else if (kind == "normal") {
      d.kind = SizeDistribution::Kind::normal;
      d.first = length_of("mean");
      d.second = length_of("sigma");
    } else if (kind == "lognormal") {
      d.kind = SizeDistribution::Kind::lognormal;
      d.first = length_of("median");
      d.second = plain("sigma", Range::positive);
    } else if (kind == "weibull") {
      d.kind = SizeDistribution::Kind::weibull;
      d.first = length_of("scale");
      d.second = plain("shape", Range::positive);
    } else if (kind == "power") {
      d.kind = SizeDistribution::Kind::power;
      d.first = plain("exponent", Range::any);
    } else {
      t.word_or("distribution", "", {"fixed", "uniform", "normal", "lognormal", "weibull", "power"}, {});
      throw UsageError("{}: expected a distribution, for instance {{ distribution = \"uniform\", min = \"8 mm\", max = \"20 mm\" }}",
                       t.where());
    }
    // without bounds a tail asks, sooner or later, for a body larger than the box
    d.min = length_of("min");
    d.max = length_of("max");
    if (!(d.min <= d.max)) throw t.error("min", "must not be above max");
    const auto share = [&](double u) { return d.quantile(u); };
    if (!std::isfinite(share(0.5))) throw t.error("distribution", "has no sizes between min and max");
  }
  for (const std::string& key : keys) {
    if (t.has(key) && std::find(used.begin(), used.end(), key) == used.end()) {
      throw t.error(key, fmt::format("is not part of a {} distribution", kind));
    }
  }
  return d;
}

void read_populations(const CaseTable& top, const std::string& folder, const std::vector<std::string>& shapes,
                      const std::vector<std::string>& materials, Case& c) {
  for (const CaseTable& t : top.tables("populations", {"shapes", "shape", "material", "count", "mass", "solid_fraction", "size",
                                                       "region", "method", "velocity", "angular_velocity"})) {
    CasePopulation p;
    p.where = t.where();
    if (t.only_one_of({"shapes", "shape"}) == "shape") {
      p.shares = {{t.reference("shape", shapes, "shape"), 1.0}};
    } else {
      double sum = 0;
      for (const auto& [name, share] : t.named_numbers("shapes", Range::positive)) {
        p.shares.emplace_back(t.find_name("shapes", name, shapes, "shape"), share);
        sum += share;
      }
      for (auto& share : p.shares) share.second /= sum;
    }
    p.material = t.reference("material", materials, "material");
    const std::string amount = t.only_one_of({"count", "mass", "solid_fraction"});
    if (amount == "count") p.value = static_cast<double>(t.integer("count", 0));
    if (amount == "mass") {
      p.amount = CasePopulation::Amount::mass;
      p.value = t.number("mass", Dimension::mass, Range::positive);
    }
    if (amount == "solid_fraction") {
      p.amount = CasePopulation::Amount::solid_fraction;
      p.value = t.number("solid_fraction", Dimension::none, Range::fraction);
    }
    if (t.has("size")) p.size = read_size(t);
    const CaseTable region = t.table("region", {"box", "inside"});
    if (region.only_one_of({"box", "inside"}) == "box") {
      const auto [lower, upper] = region.corners("box");
      p.region.add(lower);
      p.region.add(upper);
    } else {
      p.region_file = resolved(folder, region.text("inside"));
    }
    t.word_or("method", "random", {"random", "lattice", "settle"}, {"random"});
    p.velocity = t.vector_or("velocity", Dimension::velocity, {});
    p.angular_velocity = t.vector_or("angular_velocity", Dimension::angular_velocity, {});
    c.populations.push_back(p);
  }
}

WallMotion read_motion(const CaseTable& t) {
  WallMotion m;
  const std::string kind = t.only_one_of({"rotate", "translate", "oscillate", "table"});
  if (kind == "rotate") {
    const CaseTable r = t.table("rotate", {"axis", "centre", "rate"});
    m.kind = WallMotion::Kind::rotate;
    m.axis = r.direction("axis");
    m.centre = r.vector_or("centre", Dimension::length, {});
    m.rate = r.number("rate", Dimension::angular_velocity);
  } else if (kind == "translate") {
    const CaseTable r = t.table("translate", {"velocity"});
    m.kind = WallMotion::Kind::translate;
    const Vec3 velocity = r.vector("velocity", Dimension::velocity);
    m.rate = length(velocity);
    if (m.rate > 0) m.axis = normalised(velocity);
  } else if (kind == "oscillate") {
    const CaseTable r = t.table("oscillate", {"direction", "amplitude", "frequency", "phase"});
    m.kind = WallMotion::Kind::oscillate;
    m.axis = r.direction("direction");
    m.amplitude = r.number("amplitude", Dimension::length, Range::not_negative);
    m.frequency = r.number("frequency", Dimension::frequency, Range::not_negative);
    m.phase = r.number_or("phase", Dimension::angle, 0);
  } else {
    const CaseTable r = t.table("table", {"time", "position"});
    m.kind = WallMotion::Kind::table;
    m.table_time = r.numbers("time", Dimension::time);
    m.table_position = r.vectors("position", Dimension::length);
    if (m.table_time.size() != m.table_position.size() || m.table_time.empty()) {
      throw r.error("time", fmt::format("has {} rows and position {}; expected as many, and at least one", m.table_time.size(),
                                        m.table_position.size()));
    }
    for (std::size_t i = 1; i < m.table_time.size(); ++i) {
      if (!(m.table_time[i - 1] < m.table_time[i])) throw r.error("time", "must ascend");
    }
  }
  m.start = t.number_or("start", Dimension::time, 0);
  m.stop = t.number_or("stop", Dimension::time, m.stop);
  if (!(m.start < m.stop)) throw t.error("stop", "must come after start");
  return m;
}

void read_walls(const CaseTable& top, const std::string& folder, const std::vector<std::string>& materials, Case& c) {
  for (const CaseTable& t : top.tables("walls", {"name", "shape", "material", "motion", "position", "orientation", "scale", "cell_size"})) {
    CaseWall w;
    w.where = t.where();
    w.wall.material = t.reference("material", materials, "material");
    const CaseTable shape = t.table("shape", {"plane", "box_inside", "cylinder_inside", "sphere_inside", "file"});
    const std::string kind = shape.only_one_of({"plane", "box_inside", "cylinder_inside", "sphere_inside", "file"});
    w.wall.name = t.has("name") ? t.text("name") : fmt::format("{} {}", kind == "file" ? "mesh" : kind, c.walls.size());
    if (kind == "plane") {
      const CaseTable s = shape.table("plane", {"point", "normal"});
      w.wall.kind = WallKind::plane;
      w.wall.point = s.vector("point", Dimension::length);
      w.wall.normal = s.direction("normal");
    } else if (kind == "box_inside") {
      w.wall.kind = WallKind::box_inside;
      std::tie(w.wall.lower, w.wall.upper) = shape.corners("box_inside");
    } else if (kind == "cylinder_inside") {
      const CaseTable s = shape.table("cylinder_inside", {"start", "end", "radius"});
      w.wall.kind = WallKind::cylinder_inside;
      w.wall.axis_start = s.vector("start", Dimension::length);
      w.wall.axis_end = s.vector("end", Dimension::length);
      w.wall.radius = s.number("radius", Dimension::length, Range::positive);
      if (w.wall.axis_start == w.wall.axis_end) throw s.error("end", "is the same as start; the axis needs a length");
    } else if (kind == "sphere_inside") {
      const CaseTable s = shape.table("sphere_inside", {"centre", "radius"});
      w.wall.kind = WallKind::sphere_inside;
      w.wall.point = s.vector("centre", Dimension::length);
      w.wall.radius = s.number("radius", Dimension::length, Range::positive);
    } else {
      w.wall.kind = WallKind::mesh;
      w.file = resolved(folder, shape.text("file"));
      w.wall.position = t.vector_or("position", Dimension::length, {});
      w.wall.orientation = read_orientation(t);
      w.wall.scale = t.number_or("scale", Dimension::none, 1, Range::positive);
      w.wall.cell_size = t.number_or("cell_size", Dimension::length, 0, Range::positive);
    }
    for (const char* key : {"position", "orientation", "scale", "cell_size"}) {
      if (kind != "file" && t.has(key)) throw t.error(key, "is for walls from a file; a " + kind + " says itself where it is");
    }
    if (t.has("motion")) w.wall.motion = read_motion(t.table("motion", {"rotate", "translate", "oscillate", "table", "start", "stop"}));
    c.walls.push_back(w);
  }
}

/// Every pair of materials that can touch must be given; pairs that cannot are dropped.
void check_pairs(Case& c) {
  // what uses a material: movers may touch everything else, fixed things only movers
  struct Users {
    double movers = 0;
    std::string mover, still;
  };
  std::map<std::int32_t, Users> users;
  for (const CaseBody& b : c.bodies) {
    Users& u = users[b.material];
    (b.fixed ? u.still : u.mover) = b.where;
    if (!b.fixed) u.movers += 1;
  }
  for (const CasePopulation& p : c.populations) {
    users[p.material].mover = p.where;
    users[p.material].movers += p.amount == CasePopulation::Amount::count ? p.value : 2;
  }
  for (const CaseWall& w : c.walls) users[w.wall.material].still = w.where;

  std::set<std::pair<std::int32_t, std::int32_t>> needed;
  for (const auto& [a, first] : users) {
    for (const auto& [b, second] : users) {
      if (b < a) continue;
      std::string with;
      if (a == b) {
        if (first.movers >= 2) with = first.mover;
        if (first.movers >= 1 && !first.still.empty()) with = first.still;
      } else if (first.movers >= 1 && second.movers >= 1) {
        with = second.mover;
      } else if (first.movers >= 1) {
        with = second.still;
      } else if (second.movers >= 1) {
        with = first.still;
      }
      if (with.empty()) continue;
      needed.insert({a, b});
      bool given = false;
      for (const CasePair& p : c.pairs) given = given || (p.pair.a == a && p.pair.b == b);
      if (given) continue;
      const std::string &na = c.materials[static_cast<std::size_t>(a)].name, &nb = c.materials[static_cast<std::size_t>(b)].name;
      const std::string mover = first.movers >= 1 ? first.mover : second.mover;
      throw UsageError("{}: the materials \"{}\" and \"{}\" can touch ({} and {}), but no [[pairs]] says how; add one with "
                       "between = [\"{}\", \"{}\"]", c.path, na, nb, mover, with, na, nb);
    }
  }
  std::erase_if(c.pairs, [&](const CasePair& p) { return !needed.contains({p.pair.a, p.pair.b}); });
}

}  // namespace

Case parse_case(const std::string& text, const std::string& path, const std::string& folder, const std::vector<std::string>& changes) {
  toml::table file;
  try {
    file = toml::parse(text, path);
  } catch (const toml::parse_error& e) {
    throw UsageError("{}:{}:{}: {}", path, e.source().begin.line, e.source().begin.column, e.description());
  }
  apply_settings(file, changes);
  const CaseTable top(file, path, "", {"title", "seed", "gravity", "time", "domain", "shapes", "materials", "pairs", "contact", "motion",
                                       "distance", "bodies", "populations", "walls", "output"});
  Case c;
  c.path = path;
  c.text = changes.empty() ? text : text_with_settings(file, path, changes);
  read_settings(top, c);
  read_shapes(top, folder, c);
  read_materials(top, c);
  std::vector<std::string> shapes, materials;
  for (const CaseShape& s : c.shapes) shapes.push_back(s.name);
  for (const Material& m : c.materials) materials.push_back(m.name);
  read_pairs(top, materials, c);
  read_bodies(top, shapes, materials, c);
  read_populations(top, folder, shapes, materials, c);
  read_walls(top, folder, materials, c);
  check_pairs(c);
  return c;
}

Case read_case(const std::string& path, const std::vector<std::string>& changes) {
  std::ifstream stream(path, std::ios::binary);
  if (!stream || std::filesystem::is_directory(path)) throw InputError("{}: cannot be read; expected a case file such as case.toml", path);
  std::ostringstream text;
  text << stream.rdbuf();
  return parse_case(text.str(), path, std::filesystem::path(path).parent_path().string(), changes);
}

}  // namespace scree
