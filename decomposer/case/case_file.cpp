#include "decomposer/case/case_file.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <sstream>
#include <tuple>

#include "core/base/provenance.hpp"
#include "decomposer/case/case_sections.hpp"
#include "decomposer/case/case_settings.hpp"

namespace scree {

namespace {

// A quaternion typed by hand has few digits; a wrong one is off by far more.
constexpr double kTypedQuaternionTolerance = 1e-3;

}  // namespace

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

namespace {

Relax relax_of(const CaseTable& contact) {
  if (contact.is_text("relax")) {
    contact.word("relax", {"shallow"});
    return Relax::shallow;
  }
  if (!contact.has("relax")) return Relax::shallow;
  if (!contact.is_boolean("relax")) throw contact.error("relax", "expected true, false or \"shallow\"");
  return contact.boolean_or("relax", false) ? Relax::all : Relax::none;
}

void read_settings(const CaseTable& top, Case& c) {
  Settings& s = c.settings;
  s.title = top.has("title") ? top.text("title") : std::filesystem::path(c.path).stem().string();
  s.seed = top.has("seed") ? static_cast<std::uint64_t>(top.integer("seed", 0)) : 0;
  s.gravity = top.vector_or("gravity", Dimension::acceleration, {0, 0, -9.81});

  const CaseTable time = top.table("time", {"duration", "steps_per_contact", "step", "step_control", "stop_at_rest"});
  s.duration = time.number("duration", Dimension::time, Range::not_negative);
  s.steps_per_contact = time.number_or("steps_per_contact", Dimension::none, 30, Range::positive);
  s.step = time.number_or("step", Dimension::time, 0, Range::positive);
  s.step_control = time.word_or("step_control", s.step_control);
  s.stop_at_rest = time.boolean_or("stop_at_rest", false);
  if (s.stop_at_rest && !(length(s.gravity) > 0)) throw time.error("stop_at_rest", "needs gravity: without it rest cannot be told");
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
    s.domain.outside = domain.word_or("outside", s.domain.outside);
    if (domain.has("min") || domain.has("max")) {
      s.domain.bounded = true;
      s.domain.lower = domain.vector("min", Dimension::length);
      s.domain.upper = domain.vector("max", Dimension::length);
      for (int k = 0; k < 3; ++k) {
        if (!(s.domain.lower[k] < s.domain.upper[k])) throw domain.error("min", "must be below max in x, y and z");
      }
    }
  }
  if (top.has("fluid")) {
    const CaseTable fluid = top.table("fluid", {"density", "viscosity", "velocity", "drag"});
    s.fluid.emplace();
    s.fluid->density = fluid.number("density", Dimension::density, Range::positive);
    s.fluid->viscosity = fluid.number("viscosity", Dimension::viscosity, Range::positive);
    s.fluid->velocity = fluid.vector_or("velocity", Dimension::velocity, {});
    s.fluid->drag = fluid.word_or("drag", s.fluid->drag);
  }
  if (top.has("contact")) {
    const CaseTable contact = top.table("contact", {"law", "gather", "margin", "impact_speed", "relax", "barrier"});
    s.law = contact.word_or("law", s.law);
    s.barrier = contact.number_or("barrier", Dimension::none, 0, Range::not_negative);
    s.impact_speed = contact.number_or("impact_speed", Dimension::velocity, 0, Range::positive);
    s.gather = contact.word_or("gather", s.gather);
    c.margin_given = contact.has("margin");
    c.relax = relax_of(contact);
    if (s.barrier > 0 && s.gather != Gathering::potential) throw contact.error("barrier", "goes with gather = \"potential\" only");
    if (s.gather == Gathering::area && s.law == ContactLaw::hertz_mindlin)
      throw contact.error("gather", "\"area\" has a law of its own; use it with law = \"linear\" or \"hunt-crossley\"");
    if (s.gather == Gathering::area && !contact.has("margin"))
      throw contact.error("gather", "\"area\" needs contact.margin, the thickness of the elastic layer");
    s.margin = contact.number_or("margin", Dimension::length, 0, Range::not_negative);
  }
  if (top.has("motion")) {
    s.integrator = top.table("motion", {"integrator"}).word_or("integrator", s.integrator);
  }
  s.output_every = s.duration / 100;
  if (top.has("output")) {
    const CaseTable output = top.table("output", {"every", "contacts", "checkpoint"});
    s.output_every = output.number_or("every", Dimension::time, s.output_every, Range::positive);
    s.output_contacts = output.boolean_or("contacts", true);
    s.checkpoint_every = output.number_or("checkpoint", Dimension::time, 0, Range::not_negative);
    s.checkpoint_by_clock = !output.has("checkpoint");  // 0 asks for none but the last
  }
}

void read_shapes(const CaseTable& top, const std::string& folder, Case& c) {
  for (const auto& [name, t] : top.named_tables("shapes", {"file", "name", "sphere", "cell_size"})) {
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
    shape.cell_size = t.number_or("cell_size", Dimension::length, 0, Range::positive);
    if (shape.cell_size > 0 && shape.file.empty()) throw t.error("cell_size", "is for meshes: a sphere touches in one place");
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
  for (const CaseTable& t : top.tables(
           "pairs", {"between", "stiffness", "restitution", "friction", "friction_sliding", "rolling_friction", "torsional_friction",
                     "rolling_model", "tangential_ratio", "tangential_damping", "restitution_speed", "contact_radius", "layer_modulus"})) {
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
    const bool hertz = c.settings.law == ContactLaw::hertz_mindlin;
    if (hertz && t.has("stiffness")) {
      throw t.error(
          "stiffness",
          "is not used with contact.law = \"hertz-mindlin\", whose stiffness follows from young and poisson of the materials; remove it");
    }
    const bool area = c.settings.gather == Gathering::area;
    if (area && t.has("stiffness")) {
      throw t.error(
          "stiffness",
          "is not used with contact.gather = \"area\", whose stiffness is layer_modulus over the thickness of the margins; remove it");
    }
    if (!area && t.has("layer_modulus")) throw t.error("layer_modulus", "is for contact.gather = \"area\"");
    if (area) p.pair.layer_modulus = t.number("layer_modulus", Dimension::pressure, Range::positive);
    if (!hertz && !area) p.pair.stiffness = t.number("stiffness", Dimension::stiffness, Range::positive);
    p.pair.restitution = t.number("restitution", Dimension::none, Range::unit_interval);
    p.pair.friction = t.number_or("friction", Dimension::none, 0, Range::not_negative);
    p.friction_given = t.has("friction");
    p.pair.friction_sliding = t.number_or("friction_sliding", Dimension::none, -1);
    if (t.has("friction_sliding") && !(p.pair.friction_sliding >= 0 && p.pair.friction_sliding <= p.pair.friction)) {
      throw t.error("friction_sliding", fmt::format("expected a value from 0 to friction ({:g})", p.pair.friction));
    }
    p.pair.rolling_friction = t.number_or("rolling_friction", Dimension::none, 0, Range::not_negative);
    p.pair.torsional_friction = t.number_or("torsional_friction", Dimension::none, 0, Range::not_negative);
    p.pair.rolling_model = t.word_or("rolling_model", p.pair.rolling_model);
    p.pair.tangential_ratio = t.number_or("tangential_ratio", Dimension::none, -1, Range::any);
    if (t.has("tangential_ratio") && !(p.pair.tangential_ratio >= 0)) throw t.error("tangential_ratio", "expected a value >= 0");
    p.pair.tangential_damping = t.number_or("tangential_damping", Dimension::none, 1, Range::not_negative);
    p.pair.contact_radius = t.number_or("contact_radius", Dimension::length, 0, Range::positive);
    p.pair.restitution_speed = t.number_or("restitution_speed", Dimension::velocity, 0, Range::positive);
    const bool hunt_crossley = c.settings.law == ContactLaw::hunt_crossley;
    if (t.has("restitution_speed") && !hunt_crossley) {
      throw t.error("restitution_speed", "is for contact.law = \"hunt-crossley\"; with other laws restitution does not depend on speed");
    }
    if (hunt_crossley && p.pair.restitution < 1 && !t.has("restitution_speed")) {
      throw t.error("restitution",
                    "depends on the speed of the impact with contact.law = \"hunt-crossley\"; add restitution_speed, the speed "
                    "at which it holds");
    }
    if (hertz) {
      for (const std::int32_t m : {p.pair.a, p.pair.b}) {
        const Material& material = c.materials[static_cast<std::size_t>(m)];
        if (!(material.young > 0)) {
          throw t.error("between", fmt::format("the material \"{}\" needs young (Young's modulus) for contact.law = \"hertz-mindlin\"",
                                               material.name));
        }
      }
    }
    c.pairs.push_back(p);
  }
}

void read_bodies(const CaseTable& top, const std::vector<std::string>& shapes, const std::vector<std::string>& materials, Case& c) {
  for (const CaseTable& t : top.tables(
           "bodies", {"shape", "material", "position", "orientation", "velocity", "angular_velocity", "scale", "fixed", "lock_rotation"})) {
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
      throw UsageError(
          "{}: the materials \"{}\" and \"{}\" can touch ({} and {}), but no [[pairs]] says how; add one with "
          "between = [\"{}\", \"{}\"]",
          c.path, na, nb, mover, with, na, nb);
    }
  }
  std::erase_if(c.pairs, [&](const CasePair& p) { return !needed.contains({p.pair.a, p.pair.b}); });
}

}  // namespace

Case parse_case(const std::string& text, const std::string& path, const std::string& folder, const std::vector<std::string>& changes,
                CaseReads* reads) {
  toml::table file;
  try {
    file = toml::parse(text, path);
  } catch (const toml::parse_error& e) {
    throw UsageError("{}:{}:{}: {}", path, e.source().begin.line, e.source().begin.column, e.description());
  }
  apply_settings(file, changes);
  if (const toml::node* removed = file.get("distance")) {
    throw UsageError(
        "{}:{}: [distance] is no longer part of the case language: the solver has one exact distance, in double precision. Remove it", path,
        removed->source().begin.line);
  }
  const CaseTable top(file, path, "",
                      {"title", "seed", "gravity", "time", "domain", "fluid", "shapes", "materials", "pairs", "contact", "motion", "bodies",
                       "populations", "walls", "output"},
                      reads);
  Case c;
  c.path = path;
  c.sha256 = sha256_of_bytes(text.data(), text.size());
  c.text = changes.empty() ? text : text_with_settings(file, path, changes);
  read_settings(top, c);
  read_shapes(top, folder, c);
  read_materials(top, c);
  std::vector<std::string> shapes, materials;
  for (const CaseShape& s : c.shapes) shapes.push_back(s.name);
  for (const Material& m : c.materials) materials.push_back(m.name);
  read_pairs(top, materials, c);
  read_bodies(top, shapes, materials, c);
  read_walls(top, folder, materials, c);
  read_populations(top, folder, shapes, materials, c);
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
