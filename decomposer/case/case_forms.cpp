// The shapes of walls: those known by formula, and those made into triangles (wall_forms.hpp, machine_forms.hpp).
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "decomposer/case/case_sections.hpp"
#include "decomposer/case/machine_forms.hpp"

namespace scree {

namespace {

/// Height of one end of an axis over the other, over its length, that is none: rounding of the numbers of a case.
constexpr double kLevel = 1e-9;

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

void lifters_section(CaseKeys& k, double radius, int segments, Lifters& lifters) {
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
  if (!lifters_are_inside(radius, lifters, segments)) {
    throw t->error(
        "height",
        fmt::format(
            "the corners of bars that are {:g} m wide at their top stand outside the drum, whose wall is behind them; give higher or "
            "narrower bars, or a smaller top_width",
            lifters.top_width));
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
              [&](CaseKeys& below) { lifters_section(below, radius, segments, lifters); });
  }
  if (k.table() == nullptr) return;
  form = lifters.count > 0 ? drum_form(start, end, radius, lifters, open[0], open[1], segments)
                           : cone_form(start, end, radius, radius, open[0], open[1], segments);
}

void screw_section(CaseKeys& k, std::optional<WallForm>& form) {
  Vec3 start, end;
  Screw screw;
  std::int64_t starts = 1;
  double pitch = 0;
  axis_keys(k, start, end);
  k.number({"radius", kRequired, "of the rim of the flights"}, screw.radius, Dimension::length, Range::positive);
  k.number({"shaft", kRequired, "its radius"}, screw.shaft, Dimension::length, Range::positive);
  k.number({"pitch", kRequired, "length in which a flight goes round once; below 0: left-handed"}, pitch, Dimension::length, Range::any);
  k.number({"thickness", kRequired, "of a flight, along the axis"}, screw.thickness, Dimension::length, Range::positive);
  k.integer({"starts", "", "number of flights"}, starts, 1);
  const int segments = segments_key(k);
  const CaseTable* t = k.table();
  if (t == nullptr) return;
  screw.pitch = std::abs(pitch);
  screw.left_handed = pitch < 0;
  screw.starts = static_cast<int>(std::min<std::int64_t>(starts, 1 << 20));
  if (!(screw.pitch > 0)) throw t->error("pitch", "must not be 0");
  if (!(screw.shaft < screw.radius))
    throw t->error("shaft", fmt::format("must be less than the radius of the flights ({:g} m)", screw.radius));
  if (const std::string fault = fault_of(screw); !fault.empty())
    throw t->error("thickness", fmt::format("{}: {} times {:g} m in a pitch of {:g} m", fault, screw.starts, screw.thickness, screw.pitch));
  const double triangles = 4.0 * segments * segments * length(end - start) / screw.pitch;
  if (triangles > static_cast<double>(kMostTriangles))
    throw t->error("segments",
                   fmt::format("makes about {:.2g} triangles of this screw, above the limit of {}; give fewer", triangles, kMostTriangles));
  form = screw_form(start, end, screw, segments);
}

void paddles_section(CaseKeys& k, std::optional<WallForm>& form) {
  Vec3 start, end;
  Paddles paddles;
  std::int64_t count = 0;
  axis_keys(k, start, end);
  k.number({"radius", kRequired, "of the circle that the outer corners of the blades reach"}, paddles.radius, Dimension::length,
           Range::positive);
  k.number({"shaft", kRequired, "its radius"}, paddles.shaft, Dimension::length, Range::positive);
  k.integer({"count", kRequired, "of the blades, spread evenly along the shaft"}, count, 1);
  k.number({"width", kRequired, "of a blade"}, paddles.width, Dimension::length, Range::positive);
  k.number({"thickness", kRequired, "of a blade"}, paddles.thickness, Dimension::length, Range::positive);
  k.number({"angle", "45 deg", "of a blade to the axis: 0 pushes across, 90 deg cuts; right-handed screws have positive angles"},
           paddles.angle, Dimension::angle, Range::any);
  k.number({"turn", "90 deg", "about the axis, from one blade to the next; the first points up, or along x on a vertical shaft"},
           paddles.turn, Dimension::angle, Range::any);
  const int segments = segments_key(k);
  const CaseTable* t = k.table();
  if (t == nullptr) return;
  constexpr std::int64_t kMostPaddles = 10'000;
  if (count > kMostPaddles) throw t->error("count", fmt::format("expected at most {}", kMostPaddles));
  paddles.count = static_cast<int>(count);
  if (!(paddles.shaft < paddles.radius)) throw t->error("shaft", fmt::format("must be less than the radius ({:g} m)", paddles.radius));
  if (!(reach_across(paddles) < paddles.radius)) throw t->error("width", "is more than the circle of the blades has room for");
  form = paddles_form(start, end, paddles, segments);
}

void trough_section(CaseKeys& k, std::optional<WallForm>& form) {
  Vec3 start, end;
  double radius = 0, height = 0;
  axis_keys(k, start, end);
  k.number({"radius", kRequired, "of its bottom about the axis"}, radius, Dimension::length, Range::positive);
  k.number({"height", kRequired, "of its sides above the axis"}, height, Dimension::length, Range::positive);
  const std::vector<bool> open = open_key(k, {"start", "end"}, "end plates that are left out");
  const int segments = segments_key(k);
  const CaseTable* t = k.table();
  if (t == nullptr) return;
  const Vec3 axis = end - start;
  if (std::abs(axis.z) > kLevel * length(axis))
    throw t->error("end", fmt::format("is {:g} m higher than start; the axis of a trough is level, turn it with orientation", axis.z));
  form = trough_form(start, end, radius, height, open[0], open[1], segments);
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
  k.section({"trough", "", "open above, with a round bottom about a level axis"}, [&](CaseKeys& below) { trough_section(below, w.form); });
  k.section(
      {"screw", "", "a shaft with helical flights, met from outside. At its middle a flight points up, or along x on a vertical shaft"},
      [&](CaseKeys& below) { screw_section(below, w.form); });
  k.section({"paddles", "", "a shaft with flat blades, met from outside"}, [&](CaseKeys& below) { paddles_section(below, w.form); });
  k.path({"file", "", "a surface that may be open, or a solid; coordinates of its file"}, w.file);
}

}  // namespace scree
