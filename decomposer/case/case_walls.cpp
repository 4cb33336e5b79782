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

int segments_key(CaseKeys& k) {
  constexpr std::int64_t kMax = 4096;  // a rounding of 3e-7 of the radius
  std::int64_t segments = kDefaultSegments;
  k.integer({"segments"}, segments, 3);
  if (segments > kMax) throw k.table()->error("segments", fmt::format("expected at most {}", kMax));
  return static_cast<int>(segments);
}

/// Which faces `open` leaves out, in the order of the words.
std::vector<bool> open_key(CaseKeys& k, const std::vector<std::string>& faces, const char* meaning) {
  std::vector<bool> open(faces.size(), false);
  k.some_of({"open", "none", meaning}, open, faces, "side");
  return open;
}

void axis_keys(CaseKeys& k, Vec3& start, Vec3& end) {
  k.vector({"start", kRequired}, start, Dimension::length);
  k.vector({"end", kRequired}, end, Dimension::length);
  if (k.table() != nullptr && start == end) throw k.table()->error("end", "is the same as start; the axis needs a length");
}

void plate_section(CaseKeys& k, std::optional<WallForm>& form) {
  Vec3 corner, a, b;
  k.vector({"corner", kRequired}, corner, Dimension::length);
  k.vector({"side_a", kRequired}, a, Dimension::length);
  k.vector({"side_b", kRequired}, b, Dimension::length);
  if (k.table() == nullptr) return;
  if (!(length(cross(a, b)) > 0)) throw k.table()->error("side_b", "must not be zero or parallel to side_a");
  form = plate_form(corner, a, b);
}

void disc_section(CaseKeys& k, std::optional<WallForm>& form) {
  Vec3 centre, normal;
  double radius = 0, hole = 0;
  k.vector({"centre", kRequired}, centre, Dimension::length);
  k.direction({"normal", kRequired}, normal);
  k.number({"radius", kRequired}, radius, Dimension::length, Range::positive);
  k.number({"hole", "", "radius of one in the middle"}, hole, Dimension::length, Range::positive);
  const int segments = segments_key(k);
  if (k.table() == nullptr) return;
  if (!(hole < radius)) throw k.table()->error("hole", "is a radius and must be less than that of the disc");
  form = disc_form(centre, normal, radius, hole, segments);
}

void box_section(CaseKeys& k, std::optional<WallForm>& form) {
  Vec3 lower, upper;
  k.corners({"corners", kRequired}, lower, upper);
  const std::vector<bool> open = open_key(k, {"-x", "+x", "-y", "+y", "-z", "+z"}, "sides that are left out");
  if (k.table() == nullptr) return;
  std::array<bool, 6> sides{};
  std::copy(open.begin(), open.end(), sides.begin());
  if (std::find(open.begin(), open.end(), false) == open.end()) throw k.table()->error("open", "leaves no side of the box");
  form = box_form(lower, upper, sides);
}

void cone_section(CaseKeys& k, std::optional<WallForm>& form) {
  Vec3 start, end;
  double first = 0, last = 0;
  axis_keys(k, start, end);
  k.number({"radius_start", kRequired}, first, Dimension::length, Range::not_negative);
  k.number({"radius_end", kRequired}, last, Dimension::length, Range::not_negative);
  const std::vector<bool> open = open_key(k, {"start", "end"}, "lids that are left out");
  const int segments = segments_key(k);
  if (k.table() == nullptr) return;
  if (!(first > 0 || last > 0)) throw k.table()->error("radius_end", "one of the two radii must be > 0");
  form = cone_form(start, end, first, last, open[0], open[1], segments);
}

/// A diameter, or widths along x and y. Returns whether it is a diameter.
bool opening_key(CaseKeys& k, const Key& key, double (&size)[2]) {
  const CaseTable* t = k.table();
  const bool is_list = t != nullptr && t->is_list(key.name);
  if (k.when(!is_list)) {
    k.number(key, size[0], Dimension::length, Range::positive);
    size[1] = size[0];
  }
  if (k.when(is_list)) {
    std::vector<double> widths;
    k.numbers(key, widths, Dimension::length);
    if (t == nullptr) return true;
    if (widths.size() != 2 || !(widths[0] > 0 && widths[1] > 0)) {
      throw t->error(key.name, "expected a diameter, or two widths > 0 along x and y");
    }
    std::copy(widths.begin(), widths.end(), size);
  }
  return !is_list;
}

void hopper_section(CaseKeys& k, std::optional<WallForm>& form) {
  Hopper h;
  double angle = 0;
  const CaseTable* t = k.table();
  h.round = opening_key(k, {"outlet", kRequired, "a diameter, or both `[width x, width y]`"}, h.outlet);
  const bool round_bin = opening_key(k, {"bin", kRequired, "the same"}, h.bin);
  if (t != nullptr) {
    if (round_bin != h.round) throw t->error("bin", "outlet and bin must both be diameters, or both widths along x and y");
    if (!(h.bin[0] >= h.outlet[0] && h.bin[1] >= h.outlet[1]) || (h.bin[0] == h.outlet[0] && h.bin[1] == h.outlet[1])) {
      throw t->error("bin", "must be wider than the outlet");
    }
  }
  const bool has_angle = k.one_of({"half_angle", "funnel_height"}) == "half_angle";
  k.number({"half_angle", "or `funnel_height`", "of the funnel to the vertical; 90 deg is a flat floor"}, angle, Dimension::angle,
           Range::positive);
  k.number({"funnel_height", "or `half_angle`"}, h.funnel_height, Dimension::length, Range::not_negative);
  k.number({"bin_height", kRequired}, h.bin_height, Dimension::length, Range::positive);
  k.number({"stub", "", "length of a tube below the outlet"}, h.stub, Dimension::length, Range::positive);
  const int segments = segments_key(k);
  if (t == nullptr) return;
  if (has_angle) {
    constexpr double kRightAngle = 0.5 * std::numbers::pi;
    if (angle > kRightAngle * (1 + 1e-12))
      throw t->error("half_angle", "expected an angle between the funnel's wall and the vertical, at most 90 deg");
    // of a rectangular hopper, the wall that is further out has the angle
    h.funnel_height = 0.5 * std::max(h.bin[0] - h.outlet[0], h.bin[1] - h.outlet[1]) / std::tan(angle);
    if (angle >= kRightAngle * (1 - 1e-12)) h.funnel_height = 0;
  }
  form = hopper_form(h, segments);
}

void lifters_section(CaseKeys& k, double radius, Lifters& lifters) {
  std::int64_t count = 0;
  k.integer({"count", kRequired}, count, 1);
  k.number({"height", kRequired}, lifters.height, Dimension::length, Range::positive);
  k.number({"width", kRequired}, lifters.width, Dimension::length, Range::positive);
  lifters.top_width = lifters.width;
  k.number({"top_width", "`width`"}, lifters.top_width, Dimension::length, Range::positive);
  const CaseTable* t = k.table();
  if (t == nullptr) return;
  lifters.count = static_cast<int>(std::min<std::int64_t>(count, 1 << 20));
  if (!(lifters.height < radius)) throw t->error("height", fmt::format("must be less than the radius of the drum ({:g} m)", radius));
  const double half_pitch = std::numbers::pi / lifters.count;
  const auto fits = [&](double width, double at) { return 0.5 * width < at * std::sin(std::min(half_pitch, 0.5 * std::numbers::pi)); };
  if (!fits(lifters.width, radius) || !fits(lifters.top_width, radius - lifters.height)) {
    throw t->error("count", "these lifters leave no room between each other; fewer, lower or narrower ones do");
  }
}

/// in   may_have_lifters   a drum; else a cylinder
void tube_section(CaseKeys& k, bool may_have_lifters, std::optional<WallForm>& form) {
  Vec3 start, end;
  double radius = 0;
  Lifters lifters;
  axis_keys(k, start, end);
  k.number({"radius", kRequired}, radius, Dimension::length, Range::positive);
  const std::vector<bool> open = open_key(k, {"start", "end"}, "lids that are left out; both make a tube");
  const int segments = segments_key(k);
  if (may_have_lifters) {
    k.section({"lifters", "none", "bars along the wall, trapezoids towards the axis; the first stands on x for a drum along z"},
              [&](CaseKeys& below) { lifters_section(below, radius, lifters); });
  }
  if (k.table() == nullptr) return;
  form = lifters.count > 0 ? drum_form(start, end, radius, lifters, open[0], open[1], segments)
                           : cone_form(start, end, radius, radius, open[0], open[1], segments);
}

/// Shapes known by formula, then those that are made into a mesh.
void wall_shape_section(CaseKeys& k, CaseWall& w) {
  Wall& wall = w.wall;
  k.section({"plane", "", "the normal points to the particles"}, [&](CaseKeys& below) {
    wall.kind = WallKind::plane;
    below.vector({"point", kRequired}, wall.point, Dimension::length);
    below.direction({"normal", kRequired}, wall.normal);
  });
  k.corners({"box_inside"}, wall.lower, wall.upper);
  k.section({"cylinder_inside", "", "closed by lids"}, [&](CaseKeys& below) { cylinder_keys(below, wall); });
  k.section({"sphere_inside"}, [&](CaseKeys& below) { sphere_keys(below, wall); });
  k.section({"plate", "", "a parallelogram"}, [&](CaseKeys& below) { plate_section(below, w.form); });
  k.section({"disc"}, [&](CaseKeys& below) { disc_section(below, w.form); });
  k.section({"box"}, [&](CaseKeys& below) { box_section(below, w.form); });
  k.section({"cylinder"}, [&](CaseKeys& below) { tube_section(below, false, w.form); });
  k.section({"cone", "", "a frustum; one radius may be 0"}, [&](CaseKeys& below) { cone_section(below, w.form); });
  k.section({"hopper", "",
             "open above and below. Middle of the outlet at the origin, up is z: move it with `position`, turn it with `orientation`. "
             "Close the outlet with a plate or disc that moves"},
            [&](CaseKeys& below) { hopper_section(below, w.form); });
  k.section({"drum", "", "a cylinder with bars along the wall"}, [&](CaseKeys& below) { tube_section(below, true, w.form); });
  k.path({"file", "", "a surface that may be open, or a solid; coordinates of its file"}, w.file);
}

/// The form with triangles that stands for an analytic one.
const char* mesh_form_of(const std::string& shape) {
  if (shape == "plane") return "of shape = { plate = ... } or { disc = ... }";
  if (shape == "box_inside") return "of shape = { box = ... }";
  if (shape == "cylinder_inside") return "of shape = { cylinder = ... }";
  return "from a file (scree-mesher generate sphere, then { file = ... })";
}

void refine_form(const CaseTable& t, double size, WallForm& form) {
  constexpr std::int64_t kMaxTriangles = 4'000'000;  // 0.3 GB of mesh; a load map of them is 2 GB on each rank
  double area = 0;
  const TriangleMesh& mesh = form.surface;
  for (std::int32_t i = 0; i < mesh.triangle_count(); ++i)
    area += 0.5 * length(cross(mesh.corner(i, 1) - mesh.corner(i, 0), mesh.corner(i, 2) - mesh.corner(i, 0)));
  // one with all its edges of this length is the largest triangle that there can be
  const double least = area / (0.25 * std::sqrt(3.0) * size * size);
  if (least > static_cast<double>(kMaxTriangles))
    throw t.error("triangle_size", fmt::format("makes {:.2g} triangles or more of this wall, above the limit of {}; give a larger size",
                                               least, kMaxTriangles));
  refine_mesh(form.surface, size, 16 * kMaxTriangles);
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
    shape = below.one_of(
        {"plane", "box_inside", "cylinder_inside", "sphere_inside", "plate", "disc", "box", "cylinder", "cone", "hopper", "drum", "file"});
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

void cylinder_keys(CaseKeys& k, Wall& wall) {
  wall.kind = WallKind::cylinder_inside;
  axis_keys(k, wall.axis_start, wall.axis_end);
  k.number({"radius", kRequired}, wall.radius, Dimension::length, Range::positive);
}

void sphere_keys(CaseKeys& k, Wall& wall) {
  wall.kind = WallKind::sphere_inside;
  k.vector({"centre", kRequired}, wall.point, Dimension::length);
  k.number({"radius", kRequired}, wall.radius, Dimension::length, Range::positive);
}

void wall_sections(CaseKeys& k, Case& c) {
  k.sections({"walls"}, [&](CaseKeys& below) { wall_section(below, c); });
}

}  // namespace scree
