#include "decomposer/case/case_file.hpp"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <tuple>

#include "core/base/near_file.hpp"
#include "core/base/provenance.hpp"
#include "core/storage/attraction.hpp"
#include "core/storage/plasticity.hpp"
#include "core/storage/scene_keys.hpp"
#include "decomposer/case/case_pairs.hpp"
#include "decomposer/case/case_sections.hpp"
#include "decomposer/case/case_settings.hpp"
#include "decomposer/case/parse_toml.hpp"

namespace scree {

namespace {

void shape_section(CaseKeys& k, CaseShape& s) {
  k.one_of({"file", "sphere"});
  k.path({"file", "or `sphere`", "a `*.shape.h5` with a solid"}, s.file);
  k.text({"name", "the only one", "which of several shapes in the file"}, s.name_in_file);
  k.section({"sphere", "or `file`", "an exact ball, no triangles"}, [&](CaseKeys& below) {
    below.number({"radius", kRequired}, s.sphere_radius, Dimension::length, Range::positive);
  });
  k.number({"cell_size", "none",
            "of a mesh at scale 1: for very large bodies, such as terrain that moves; contacts of one other body with it that are further "
            "apart than this do not share stiffness"},
           s.cell_size, Dimension::length, Range::positive);
  const CaseTable* t = k.table();
  const bool is_cut_here = t != nullptr && t->is_table("pieces");
  if (k.when(!is_cut_here)) {
    k.path({"pieces", "none",
            "a `*.shape.h5` from `scree-mesher fracture` of this solid: its bodies are packed as a whole and start as these "
            "pieces, held by `[[bonds]]`"},
           s.pieces);
  }
  if (k.when(is_cut_here)) {
    k.section({"pieces", "none", "the same, with the cut made here"}, [&](CaseKeys& below) {
      below.integer({"cells", kRequired, "how many Voronoi cells it is cut into"}, s.cells, 2);
      below.integer({"seed", "", "of their points"}, s.cut_seed, 0);
      below.boolean({"evenly", "", "points move to the centres of their cells: cells of more equal size"}, s.cut_evenly);
    });
  }
  if (t == nullptr) return;
  s.where = t->where();
  if (s.falls_apart() && s.file.empty()) throw t->error("pieces", "are those of a mesh: a sphere has no file that could be cut");
  if (s.falls_apart() && s.cell_size > 0) throw t->error("pieces", "do not go with cell_size");
  if (t->has("name") && s.file.empty()) throw t->error("name", "names one of several shapes in a file; a sphere has no file");
  if (s.cell_size > 0 && s.file.empty()) throw t->error("cell_size", "is for meshes: a sphere touches in one place");
}

void material_section(CaseKeys& k, const Case& c, Material& m) {
  material_keys(k, m);
  material_heat_keys(k, m);
  refuse_without_heat(k, c, {"heat_capacity", "conductivity", "real_young"});
  const CaseTable* t = k.table();
  if (t != nullptr && !(m.poisson > -1 && m.poisson <= 0.5)) throw t->error("poisson", "expected a value above -1 and at most 0.5");
}

/// What the law and the gathering of the case have no use for.
void refuse_unused(const CaseTable& t, const Settings& s) {
  if (s.law == ContactLaw::hertz_mindlin && t.has("stiffness")) {
    throw t.error(
        "stiffness",
        "is not used with contact.law = \"hertz-mindlin\", whose stiffness follows from young and poisson of the materials; remove it");
  }
  const bool area = s.gather == Gathering::area;
  if (t.has("modulus") && t.has("stiffness"))
    throw t.error("modulus", "is the stiffness by size, in place of stiffness; remove one of them");
  if (t.has("modulus") && s.law == ContactLaw::hertz_mindlin) {
    throw t.error(
        "modulus",
        "is not used with contact.law = \"hertz-mindlin\", whose stiffness follows from young and poisson of the materials; remove it");
  }
  if (t.has("modulus") && area)
    throw t.error("modulus", "is not used with contact.gather = \"area\", where layer_modulus takes its place; remove it");
  if (t.has("modulus") && s.barrier > 0) {
    throw t.error("modulus", "does not go with contact.barrier, which is one for all sizes; give stiffness, or leave out the barrier");
  }
  if (area && t.has("stiffness")) {
    throw t.error(
        "stiffness",
        "is not used with contact.gather = \"area\", whose stiffness is layer_modulus over the thickness of the margins; remove it");
  }
  if (!area && t.has("layer_modulus")) throw t.error("layer_modulus", "is for contact.gather = \"area\"");
}

/// What they ask of a pair beyond its own ranges.
void check_pair(const CaseTable& t, const MaterialPair& p, const Case& c) {
  if (t.has("modulus") && attracts(p)) {
    throw t.error("modulus",
                  "does not go with pull_off, adhesion or surface_tension, whose range follows from one stiffness; give stiffness");
  }
  const bool hertz = c.settings.law == ContactLaw::hertz_mindlin, hunt_crossley = c.settings.law == ContactLaw::hunt_crossley;
  if (t.has("friction_sliding") && !(p.friction_sliding >= 0 && p.friction_sliding <= p.friction)) {
    throw t.error("friction_sliding", fmt::format("expected a value from 0 to friction ({:g})", p.friction));
  }
  if (t.has("restitution_speed") && !hunt_crossley) {
    throw t.error("restitution_speed", "is for contact.law = \"hunt-crossley\"; with other laws restitution does not depend on speed");
  }
  if (hunt_crossley && p.restitution < 1 && !t.has("restitution_speed")) {
    throw t.error("restitution",
                  "depends on the speed of the impact with contact.law = \"hunt-crossley\"; add restitution_speed, the speed "
                  "at which it holds");
  }
  if (t.has("adhesion_model") && !t.has("adhesion")) throw t.error("adhesion_model", "goes with adhesion, the work of adhesion");
  const bool area = c.settings.gather == Gathering::area;
  if (area && t.has("adhesion_model"))
    throw t.error("adhesion_model", "is not used with contact.gather = \"area\": adhesion is the work for each area there; remove it");
  if (t.has("adhesion") && !area && !t.has("adhesion_model"))
    throw t.error("adhesion", "needs adhesion_model: \"jkr\" for a pull-off force of 3/2 pi w R*, \"dmt\" for 2 pi w R*");
  for (const std::int32_t m : {p.a, p.b}) {
    const Material& material = c.materials[static_cast<std::size_t>(m)];
    if (hertz && !(material.young > 0)) {
      throw t.error("between",
                    fmt::format("the material \"{}\" needs young (Young's modulus) for contact.law = \"hertz-mindlin\"", material.name));
    }
  }
  const AttractionFault fault =
      attraction_fault(c.settings, p, c.materials[static_cast<std::size_t>(p.a)], c.materials[static_cast<std::size_t>(p.b)]);
  if (fault.key[0] != 0) throw t.error(fault.key, fault.text);
  if (const AttractionFault plastic = plasticity_fault(c.settings, p); plastic.key[0] != 0) throw t.error(plastic.key, plastic.text);
}

/// Where bodies stay as they are, nothing may ask for motion.
void check_frozen(const CaseTable& t, const Case& c) {
  if (!c.settings.heat->frozen) return;
  const auto refuse = [&](const std::string& what) {
    return t.error(
        "heat",
        fmt::format("frozen = true keeps bodies and contacts as they are and cannot be combined with {}; leave out one of both", what));
  };
  if (const char* key = frozen_blocker(c.settings)) throw refuse(key);
  for (const CaseWall& w : c.walls) {
    if (const char* why = frozen_blocker(w.wall)) throw refuse(fmt::format("the wall '{}', which {}", w.wall.name, why));
  }
  if (!c.inlets.empty()) throw refuse("[[inlets]]");
  if (!c.outlets.empty()) throw refuse("[[outlets]]");
}

/// What heat needs of the materials of bodies, and does not go with.
void check_heat(const CaseTable& t, const Case& c) {
  if (!c.settings.heat) return;
  const auto need = [&](const std::string& where, std::int32_t index) {
    const Material& m = c.materials[static_cast<std::size_t>(index)];
    for (const auto& [key, value, example] :
         {std::tuple("heat_capacity", m.heat_capacity, "900 J/(kg K)"), std::tuple("conductivity", m.conductivity, "2 W/(m K)")}) {
      if (value > 0) continue;
      throw UsageError("{}: with [heat] its material \"{}\" needs {}; add it to [materials.{}], for instance {} = \"{}\"", where, m.name,
                       key, m.name, key, example);
    }
  };
  for (const CaseBody& b : c.bodies) need(b.where, b.material);
  for (const CasePopulation& p : c.populations) need(p.where, p.material);
  for (const CaseInlet& i : c.inlets) need(i.where, i.material);
  const Heat& heat = *c.settings.heat;
  if (heat.has_gas() != (heat.gas_range > 0)) {
    throw t.error("heat",
                  fmt::format("gas_conductivity and gas_range belong together; add {}, or leave out both",
                              heat.has_gas() ? "gas_range, for instance half a radius" : "gas_conductivity, for instance \"26 mW/(m K)\""));
  }
  for (const Material& m : c.materials) {
    if (!(m.conductivity > 0) || m.conductivity > kSolidOverGas * heat.gas_conductivity) continue;
    throw t.error("heat",
                  fmt::format("gas_conductivity = {:g} W/(m K) is more than a tenth of the conductivity {:g} W/(m K) of the material "
                              "\"{}\": bodies of such a material have no one temperature; leave the gas out, or use another material",
                              heat.gas_conductivity, m.conductivity, m.name));
  }
  check_frozen(t, c);
  if (!c.bonds.empty()) throw t.error("heat", "does not go with [[bonds]]: what a bond conducts is not modelled; leave out one of both");
}

/// What a cell that deforms does not go with beside settings: cell_blocker() of a scene, with the places in the case.
void check_cell(const CaseTable& t, const Case& c) {
  if (!c.settings.cell) return;
  const auto refuse = [](const std::string& where, const char* why) { throw UsageError("{}: does not go with [cell]: {}", where, why); };
  constexpr const char* kMomentum = "the momentum of all bodies together must stay 0; leave out one of both";
  for (const CaseWall& wall : c.walls) {
    if (const char* why = cell_blocker(c.settings.domain, wall.wall)) refuse(wall.where, why);
  }
  if (!c.inlets.empty()) refuse(c.inlets.front().where, kMomentum);
  if (!c.outlets.empty()) throw t.error("outlets", fmt::format("does not go with [cell]: {}", kMomentum));
  if (!c.bonds.empty()) throw t.error("bonds", "does not go with [cell]: forces of bonds are not part of the stress that it measures");
  for (const CaseBody& b : c.bodies) {
    if (length(b.force) > 0) refuse(b.where + ".force", kMomentum);
    if (b.fixed) refuse(b.where + ".fixed", "a fixed body would not go with it; leave out one of both");
  }
}

void pair_section(CaseKeys& k, Case& c) {
  CasePair p;
  std::vector<std::string> between;
  k.texts({"between", kRequired, "two names of materials, in either order"}, between);
  const CaseTable* t = k.table();
  if (t != nullptr) {
    p.where = t->where();
    const std::vector<std::string> materials = names_of_materials(c);
    if (between.size() != 2) throw t->error("between", "expected two material names, for instance [\"rock\", \"steel\"]");
    p.pair.a = t->find_name("between", between[0], materials, "material");
    p.pair.b = t->find_name("between", between[1], materials, "material");
    if (p.pair.a > p.pair.b) std::swap(p.pair.a, p.pair.b);
    for (const CasePair& other : c.pairs) {
      if (other.pair.a == p.pair.a && other.pair.b == p.pair.b) throw t->error("between", "is given twice; first at " + other.where);
    }
    refuse_unused(*t, c.settings);
  }
  pair_keys(k, p.pair, c.settings);
  pair_heat_keys(k, p.pair);
  if (t == nullptr) return;
  refuse_without_heat(k, c, {"contact_conductance"});
  check_pair(*t, p.pair, c);
  p.friction_given = t->has("friction");
  c.pairs.push_back(p);
}

void body_section(CaseKeys& k, Case& c) {
  CaseBody b;
  k.reference({"shape", kRequired}, b.shape, names_of_shapes(c), "shape");
  k.reference({"material", kRequired}, b.material, names_of_materials(c), "material");
  k.vector({"position", kRequired, "of the centre of mass"}, b.position, Dimension::length);
  k.orientation({"orientation", "", "unit quaternion, mesh axes to world"}, b.orientation);
  k.vector({"velocity"}, b.velocity, Dimension::velocity);
  k.vector({"angular_velocity", "", "world axes"}, b.angular_velocity, Dimension::angular_velocity);
  k.number({"scale", "", "of the shape"}, b.scale, Dimension::none, Range::positive);
  k.boolean({"fixed", "", "never moves; may stand in a wall"}, b.fixed);
  k.boolean({"lock_rotation", "", "translates only"}, b.lock_rotation);
  k.vector({"force", "", "on its centre, at all times, beside gravity"}, b.force, Dimension::force);
  temperature_key(k, c, b.temperature);
  heat_source_key(k, c, b.heat_source, b.heat_table);
  const CaseTable* t = k.table();
  if (t == nullptr) return;
  b.where = t->where();
  if (b.fixed && (length(b.velocity) > 0 || length(b.angular_velocity) > 0)) {
    throw t->error("fixed", "a fixed body cannot have a velocity; remove it, or use a wall with a motion");
  }
  if (b.fixed && length(b.force) > 0) throw t->error("fixed", "a force does not move a fixed body; remove one of both");
  c.bodies.push_back(b);
}

/// What was probably meant by a line that is no TOML: a unit without quotes, a comma for a point.   in   number   of the line, from 1
std::string hint_for_line(const std::string& text, std::size_t number) {
  std::istringstream lines(text);
  std::string line;
  for (std::size_t k = 0; k < number; ++k) std::getline(lines, line);
  const std::size_t equals = line.find('=');
  if (equals == std::string::npos) return "";
  const std::size_t start = line.find_first_of("0123456789", equals);
  if (start == std::string::npos || line.find_first_not_of(" \t+-", equals + 1) != start) return "";  // not a number
  std::size_t end = line.find_first_not_of("0123456789._", start);
  if (end != std::string::npos && (line[end] == 'e' || line[end] == 'E') && end + 1 < line.size() &&
      line.find_first_of("0123456789+-", end + 1) == end + 1)
    end = line.find_first_not_of("0123456789+-_", end + 1);
  if (end == std::string::npos) return "";
  if (line[end] == ',') return "; decimals have a point, not a comma";
  const std::size_t word = line.find_first_not_of(" \t", end);
  if (word == std::string::npos || !(std::isalpha(static_cast<unsigned char>(line[word])) != 0 || line[word] == '%')) return "";
  const std::size_t last = line.find_last_not_of(" \t\r", line.find('#', word) - 1);
  const std::size_t first = line.find_first_not_of(" \t", equals + 1);
  return fmt::format("; a number with a unit is written in quotes: \"{}\"", line.substr(first, last + 1 - first));
}

}  // namespace

std::vector<std::string> names_of_shapes(const Case& c) {
  std::vector<std::string> names;
  for (const CaseShape& s : c.shapes) names.push_back(s.name);
  return names;
}

std::vector<std::string> names_of_materials(const Case& c) {
  std::vector<std::string> names;
  for (const Material& m : c.materials) names.push_back(m.name);
  return names;
}

void case_keys(CaseKeys& k, Case& c) {
  settings_sections(k, c);
  k.named_sections({"shapes"}, [&](CaseKeys& below, const std::string& name) {
    CaseShape shape;
    shape.name = name;
    shape_section(below, shape);
    if (below.table() != nullptr) c.shapes.push_back(shape);
  });
  k.named_sections({"materials"}, [&](CaseKeys& below, const std::string& name) {
    Material material;
    material.name = name;
    material_section(below, c, material);
    if (below.table() != nullptr) c.materials.push_back(material);
  });
  k.sections({"pairs"}, [&](CaseKeys& below) { pair_section(below, c); });
  k.sections({"bodies"}, [&](CaseKeys& below) { body_section(below, c); });
  wall_sections(k, c);
  if (c.no_wall_moves && std::none_of(c.walls.begin(), c.walls.end(), [](const CaseWall& w) { return w.wall.motion.moves(); }))
    throw *c.no_wall_moves;
  population_sections(k, c);
  k.section({"start", "bodies of this case only"}, [&](CaseKeys& below) { start_section(below, c); });
  inlet_sections(k, c);
  bond_sections(k, c);
  if (k.table() != nullptr) check_heat(*k.table(), c);
  if (k.table() != nullptr) check_cell(*k.table(), c);
}

std::vector<KeyDescription> describe_case() {
  Case c;
  return describe_keys([&](CaseKeys& k) { case_keys(k, c); });
}

Case parse_case(const std::string& text, const std::string& path, const std::string& folder, const std::vector<std::string>& changes) {
  toml::table file;
  try {
    file = parse_toml(text, path);
  } catch (const toml::parse_error& e) {
    throw UsageError("{}:{}:{}: {}{}", path, e.source().begin.line, e.source().begin.column, e.description(),
                     hint_for_line(text, e.source().begin.line));
  }
  apply_settings(file, changes);
  if (const toml::node* removed = file.get("distance")) {
    throw UsageError(
        "{}:{}: [distance] is no longer part of the case language: the solver has one exact distance, in double precision. Remove it", path,
        removed->source().begin.line);
  }
  Case c;
  c.path = path;
  c.sha256 = sha256_of_bytes(text.data(), text.size());
  c.text = changes.empty() ? text : text_with_settings(file, path, changes);
  read_keys(file, path, folder, [&](CaseKeys& k) { case_keys(k, c); });
  check_pairs(c, {});
  if (!c.start) drop_pairs_that_cannot_meet(c, {});
  return c;
}

Case read_case(const std::string& path, const std::vector<std::string>& changes) {
  std::ifstream stream(path, std::ios::binary);
  if (!stream || std::filesystem::is_directory(path))
    throw InputError("{}: cannot be read, expected a case file such as case.toml{}", path, near_file(path));
  std::ostringstream text;
  text << stream.rdbuf();
  return parse_case(text.str(), path, std::filesystem::path(path).parent_path().string(), changes);
}

}  // namespace scree
