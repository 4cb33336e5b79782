#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/geometry/mesh_refine.hpp"
#include "decomposer/case/case_sections.hpp"

namespace scree {

namespace {

void motion_section(CaseKeys& k, WallMotion& m) {
  std::vector<const char*> words;
  for_each_motion([&](auto kind) { words.push_back(kind.kWord); });
  k.one_of(words);
  for_each_motion([&](auto kind) {
    k.section({kind.kWord, "", kind.kMeaning}, [&](CaseKeys& below) {
      kind.keys(below);
      if (below.table() == nullptr) return;
      m.kind = kind;
      if (const auto fault = m.fault()) throw below.table()->error(fault->key, fault->text);
      if constexpr (std::is_same_v<decltype(kind), Free>) {
        if (kind.mass > 0 && below.table()->has("hinge") && !below.table()->has("mass_centre"))
          throw below.table()->error("mass_centre",
                                     "is missing; expected where the weight acts, as placed; without `mass` it has no weight");
      }
    });
  });
  k.number({"start", "", "before, the wall stands still"}, m.start, Dimension::time, Range::any);
  k.number({"stop", "never", "after, the wall stands still"}, m.stop, Dimension::time, Range::any);
  if (k.table() != nullptr && !(m.start < m.stop)) throw k.table()->error("stop", "must come after start");
}

bool overlap(const WallMotion& a, const WallMotion& b) { return a.start < b.stop && b.start < a.stop; }

/// Whether two motions of a wall say the same of it at the same time.
bool conflict(const WallMotion& a, const WallMotion& b) {
  if (!overlap(a, b)) return false;
  const auto *turn = std::get_if<Rotate>(&a.kind), *again = std::get_if<Rotate>(&b.kind);
  if (turn != nullptr && again != nullptr) {
    constexpr double kSame = 1e-12;  // of a unit vector and of a length: rounding of the case file
    const bool parallel = 1 - std::abs(dot(turn->axis, again->axis)) < kSame;
    const Vec3 apart = cross(turn->axis, again->centre - turn->centre);
    return parallel && length(apart) <= kSame * (length(turn->centre) + length(again->centre));
  }
  const auto *along = std::get_if<Translate>(&a.kind), *too = std::get_if<Translate>(&b.kind);
  return along != nullptr && too != nullptr;
}

void several_motions(CaseKeys& k, WallMotion& m) {
  Several several;
  k.section_list({"motion", "none", ""}, [&](CaseKeys& below) {
    WallMotion part;
    motion_section(below, part);
    const CaseTable* t = below.table();
    if (t == nullptr) return;
    if (part.drive())
      throw t->error(part.word(), "answers to force, which goes with no other motion of the same wall; give it alone, as motion = { ... }");
    for (const WallMotion& before : several.parts) {
      if (!conflict(before, part)) continue;
      throw t->error(part.word(),
                     fmt::format("conflicts with another {} of this wall: both {} at the same time; make one of the two, or give "
                                 "them `start` and `stop`",
                                 part.word(), part.turn_axis() ? "turn it about the same axis" : "move it along a line"));
    }
    several.parts.push_back(part);
  });
  if (k.table() == nullptr) return;
  if (several.parts.empty()) throw k.table()->error("motion", "is an empty list; expected motions, or leave it out");
  if (several.parts.size() == 1)
    m = several.parts.front();
  else
    m.kind = several;
}

void surface_section(CaseKeys& k, WallSurface& surface) {
  const bool along = k.one_of({"velocity", "rate"}) == "velocity";
  Translate belt;
  Rotate table;
  if (k.when(along)) k.velocity({"velocity", "or `rate`", "of a belt; only the tangential component counts"}, belt.rate, belt.axis);
  if (k.when(!along)) {
    k.number({"rate", "or `velocity`", "of a surface that turns"}, table.rate, Dimension::angular_velocity, Range::any);
    k.direction({.name = "axis", .otherwise = "with `rate`", .meaning = "about which it turns", .needed = true}, table.axis);
    k.vector({"centre", "", "with `rate`: a point on the axis"}, table.centre, Dimension::length);
  }
  WallMotion& m = surface.motion;
  k.number({"start", "", "before, the surface stands still"}, m.start, Dimension::time, Range::any);
  k.number({"stop", "never", "after, the surface stands still"}, m.stop, Dimension::time, Range::any);
  const CaseTable* t = k.table();
  if (t == nullptr) return;
  if (!(m.start < m.stop)) throw t->error("stop", "must come after start");
  if (along)
    m.kind = belt;
  else
    m.kind = table;
}

/// The form with triangles that stands for an analytic one.
const char* mesh_form_of(const std::string& shape) {
  if (shape == "plane") return "of shape = { plate = ... } or { disc = ... }";
  if (shape == "box_inside") return "of shape = { box = ... }";
  if (shape == "cylinder_inside") return "of shape = { cylinder = ... }";
  return "from a file (scree-mesher generate sphere, then { file = ... })";
}

void refine_form(const CaseTable& t, double size, WallForm& form) {
  double area = 0;
  const TriangleMesh& mesh = form.surface;
  for (std::int32_t i = 0; i < mesh.triangle_count(); ++i)
    area += 0.5 * length(cross(mesh.corner(i, 1) - mesh.corner(i, 0), mesh.corner(i, 2) - mesh.corner(i, 0)));
  // one with all its edges of this length is the largest triangle that there can be
  const double least = area / (0.25 * std::sqrt(3.0) * size * size);
  if (least > static_cast<double>(kMostTriangles))
    throw t.error("triangle_size", fmt::format("makes {:.2g} triangles or more of this wall, above the limit of {}; give a larger size",
                                               least, kMostTriangles));
  refine_mesh(form.surface, size, 16 * kMostTriangles);
}

/// At most one of temperature, heat_flux and exchange.
void wall_heat_keys(CaseKeys& k, const Case& c, WallHeat& heat) {
  refuse_without_heat(k, c, {"temperature", "heat_flux", "exchange"});
  const CaseTable* t = k.table();
  if (t != nullptr) {
    std::string given;
    for (const char* key : {"temperature", "heat_flux", "exchange"}) {
      if (!t->has(key)) continue;
      if (!given.empty()) throw t->error(key, fmt::format("says what {} says too; give one of them", given));
      given = key;
    }
    heat.kind = t->has("temperature") ? WallHeatKind::isothermal
                : t->has("heat_flux") ? WallHeatKind::flux
                : t->has("exchange")  ? WallHeatKind::exchange
                                      : WallHeatKind::adiabatic;
  }
  constexpr const char* kOfRun = "of the run, ascending";
  const auto temperature_over_time = [&](CaseKeys& of, const char* otherwise, const char* meaning) {
    over_time_key(of, {"temperature", otherwise, meaning}, kOfRun, "temperature", "temperatures", Dimension::temperature, Range::positive,
                  heat.temperature);
    if (of.table() != nullptr && of.table()->has("temperature") && !(heat.temperature.least() > 0))
      throw of.table()->error("temperature",
                              fmt::format("is {:g} K at one of the times; expected values above 0", heat.temperature.least()));
  };
  temperature_over_time(k, "no heat passes", "with `[heat]`: of the wall, or a table");
  over_time_key(k,
                {"heat_flux", "no heat passes",
                 "with `[heat]`: a power, or a table, shared among the bodies that touch the wall in proportion to what their contacts "
                 "conduct, and kept for later while none touches; below 0: taken from them"},
                kOfRun, "power", "powers", Dimension::power, Range::any, heat.flux);
  k.section({"exchange", "no heat passes", "with `[heat]`: a temperature outside, behind a resistance"}, [&](CaseKeys& below) {
    below.number({"coefficient", kRequired, "from the outside to the contact, for each area of contact"}, heat.coefficient,
                 Dimension::heat_transfer, Range::positive);
    temperature_over_time(below, kRequired, "outside, or a table");
  });
}

void wall_section(CaseKeys& k, Case& c) {
  CaseWall w;
  std::string shape;
  const CaseTable* t = k.table();
  if (t != nullptr) w.where = t->where();
  k.reference({"material", kRequired}, w.wall.material, names_of_materials(c), "material");
  k.section({"shape", kRequired}, [&](CaseKeys& below) {
    shape = below.one_of({"plane", "box_inside", "cylinder_inside", "sphere_inside", "plate", "disc", "box", "cylinder", "cone", "hopper",
                          "drum", "trough", "screw", "paddles", "file"});
    wall_shape_section(below, w);
  });
  if (shape == "box_inside") w.wall.kind = WallKind::box_inside;
  if (w.form || shape == "file") w.wall.kind = WallKind::mesh;
  w.wall.name = fmt::format("{} {}", shape == "file" ? "mesh" : shape, c.walls.size());
  k.text({"name", "kind and number", "for messages"}, w.wall.name);
  if (k.when(w.wall.kind == WallKind::mesh)) {
    k.vector({"position", "", "of a mesh: where the origin of its file or form is placed"}, w.wall.position, Dimension::length);
    k.orientation({"orientation", "", "of a mesh"}, w.wall.orientation);
    k.number({"scale", "", "of a mesh"}, w.wall.scale, Dimension::none, Range::positive);
    k.number({"cell_size", "none",
              "of a mesh: contacts of one body that are further apart than this do not share stiffness. For terrain that carries long "
              "bodies; about half their length"},
             w.wall.cell_size, Dimension::length, Range::positive);
  } else {
    for (const char* key : {"position", "orientation", "scale", "cell_size"}) {
      if (t->has(key)) throw t->error(key, "is for walls that are meshes; a " + shape + " says itself where it is");
    }
  }
  if (t == nullptr || w.form) {
    double size = 0;
    k.number({"triangle_size", "none",
              "of a form of this list: no edge of its triangles is longer, which sets the resolution of `load_map` and `wear`"},
             size, Dimension::length, Range::positive);
    if (t != nullptr && size > 0) refine_form(*t, size, *w.form);
  } else if (t->has("triangle_size")) {
    throw t->error("triangle_size", shape == "file"
                                        ? "is for forms that the case makes; give the triangles of a file with scree-mesher refine"
                                        : fmt::format("a {} has no triangles; make the wall {}", shape, mesh_form_of(shape)));
  }
  if (k.when(w.wall.kind == WallKind::mesh)) {
    k.boolean({"load_map", "", "of a mesh: sums impulse, sliding work and impacts on each triangle, for frames, ParaView and the report"},
              w.wall.load_map);
  } else if (t->has("load_map")) {
    throw t->error("load_map", fmt::format("needs triangles, which a {} has none of; make the wall {}", shape, mesh_form_of(shape)));
  }
  if (t == nullptr || w.wall.kind == WallKind::mesh) {
    k.section(
        {"wear", "none", "of a mesh, Archard's: the wall recedes where bodies slide over it; includes a `load_map`"}, [&](CaseKeys& below) {
          below.number({"coefficient", kRequired, "volume per sliding work"}, w.wall.wear, Dimension::wear_coefficient, Range::positive);
          below.number({"every", kRequired,
                        "after which vertices are moved, counted from the start; more than a tenth of the margin "
                        "(balls: of the smallest radius) at a time ends the run (exit 5)"},
                       w.wall.wear_every, Dimension::time, Range::positive);
          w.wall.load_map = true;
        });
  } else if (t->has("wear")) {
    throw t->error("wear", fmt::format("needs triangles, which a {} has none of; make the wall {}", shape, mesh_form_of(shape)));
  }
  const bool several = t != nullptr && t->is_list("motion");
  if (k.when(!several))
    k.section({"motion", "none",
               "prescribed, or force-controlled; or a list of prescribed motions, applied in order: each acts on the wall as moved by "
               "those before it"},
              [&](CaseKeys& below) { motion_section(below, w.wall.motion); });
  if (k.when(several)) several_motions(k, w.wall.motion);
  if (const std::optional<Drive> drive = w.wall.motion.drive();
      t != nullptr && w.wall.kind == WallKind::plane && drive && drive->guide.turns) {
    throw t->error("motion", "turns a plane in answer to force, which has no end and so any lever; use a plate or another mesh");
  }
  k.section({"surface", "none",
             "velocity of the surface of a wall that itself stays in place: a belt, a turntable. Given for the wall as placed; it moves "
             "with the wall and adds to the velocity of the wall"},
            [&](CaseKeys& below) { surface_section(below, w.wall.surface); });
  wall_heat_keys(k, c, w.wall.heat);
  if (t != nullptr) c.walls.push_back(w);
}

}  // namespace

void wall_sections(CaseKeys& k, Case& c) {
  k.sections({"walls"}, [&](CaseKeys& below) { wall_section(below, c); });
}

}  // namespace scree
