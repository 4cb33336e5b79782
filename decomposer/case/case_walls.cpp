#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>

#include "decomposer/case/case_sections.hpp"

namespace scree {

namespace {

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

int read_segments(const CaseTable& t) {
  if (!t.has("segments")) return kDefaultSegments;
  constexpr std::int64_t kMost = 4096;  // a rounding of 3e-7 of the radius
  const std::int64_t segments = t.integer("segments", 3);
  if (segments > kMost) throw t.error("segments", fmt::format("expected at most {}", kMost));
  return static_cast<int>(segments);
}

/// Which faces `open` leaves out, in the order of the words.
std::vector<bool> read_open(const CaseTable& t, const std::vector<std::string>& faces) {
  std::vector<bool> open(faces.size(), false);
  if (!t.has("open")) return open;
  for (const std::string& face : t.texts("open")) open[static_cast<std::size_t>(t.find_name("open", face, faces, "side"))] = true;
  return open;
}

std::pair<Vec3, Vec3> read_axis(const CaseTable& t) {
  const Vec3 start = t.vector("start", Dimension::length), end = t.vector("end", Dimension::length);
  if (start == end) throw t.error("end", "is the same as start; the axis needs a length");
  return {start, end};
}

/// A diameter, or widths along x and y.
bool read_opening(const CaseTable& t, const std::string& key, double (&size)[2]) {
  if (!t.is_list(key)) {
    size[0] = size[1] = t.number(key, Dimension::length, Range::positive);
    return true;
  }
  const std::vector<double> widths = t.numbers(key, Dimension::length);
  if (widths.size() != 2 || !(widths[0] > 0 && widths[1] > 0)) {
    throw t.error(key, "expected a diameter, or two widths > 0 along x and y");
  }
  size[0] = widths[0];
  size[1] = widths[1];
  return false;
}

WallForm read_hopper(const CaseTable& t) {
  Hopper h;
  h.round = read_opening(t, "outlet", h.outlet);
  if (read_opening(t, "bin", h.bin) != h.round) throw t.error("bin", "outlet and bin must both be diameters, or both widths along x and y");
  if (!(h.bin[0] >= h.outlet[0] && h.bin[1] >= h.outlet[1]) || (h.bin[0] == h.outlet[0] && h.bin[1] == h.outlet[1])) {
    throw t.error("bin", "must be wider than the outlet");
  }
  if (t.only_one_of({"half_angle", "funnel_height"}) == "half_angle") {
    const double angle = t.number("half_angle", Dimension::angle, Range::positive);
    constexpr double kRightAngle = 0.5 * std::numbers::pi;
    if (angle > kRightAngle * (1 + 1e-12))
      throw t.error("half_angle", "expected an angle between the funnel's wall and the vertical, at most 90 deg");
    // of a rectangular hopper, the wall that is further out has the angle
    h.funnel_height = 0.5 * std::max(h.bin[0] - h.outlet[0], h.bin[1] - h.outlet[1]) / std::tan(angle);
    if (angle >= kRightAngle * (1 - 1e-12)) h.funnel_height = 0;
  } else {
    h.funnel_height = t.number("funnel_height", Dimension::length, Range::not_negative);
  }
  h.bin_height = t.number("bin_height", Dimension::length, Range::positive);
  h.stub = t.number_or("stub", Dimension::length, 0, Range::positive);
  return hopper_form(h, read_segments(t));
}

WallForm read_drum(const CaseTable& t) {
  const auto [start, end] = read_axis(t);
  const double radius = t.number("radius", Dimension::length, Range::positive);
  const std::vector<bool> open = read_open(t, {"start", "end"});
  const int segments = read_segments(t);
  if (!t.has("lifters")) return cone_form(start, end, radius, radius, open[0], open[1], segments);
  const CaseTable l = t.table("lifters", {"count", "height", "width", "top_width"});
  Lifters lifters;
  lifters.count = static_cast<int>(std::min<std::int64_t>(l.integer("count", 1), 1 << 20));
  lifters.height = l.number("height", Dimension::length, Range::positive);
  lifters.width = l.number("width", Dimension::length, Range::positive);
  lifters.top_width = l.number_or("top_width", Dimension::length, lifters.width, Range::positive);
  if (!(lifters.height < radius)) throw l.error("height", fmt::format("must be less than the radius of the drum ({:g} m)", radius));
  const double half_pitch = std::numbers::pi / lifters.count;
  const auto fits = [&](double width, double at) { return 0.5 * width < at * std::sin(std::min(half_pitch, 0.5 * std::numbers::pi)); };
  if (!fits(lifters.width, radius) || !fits(lifters.top_width, radius - lifters.height)) {
    throw l.error("count", "these lifters leave no room between each other; fewer, lower or narrower ones do");
  }
  return drum_form(start, end, radius, lifters, open[0], open[1], segments);
}

/// A wall that is made into a mesh. Kinds that are known, in the order of CASE.md.
WallForm read_form(const std::string& kind, const CaseTable& shape) {
  if (kind == "plate") {
    const CaseTable s = shape.table(kind, {"corner", "side_a", "side_b"});
    const Vec3 a = s.vector("side_a", Dimension::length), b = s.vector("side_b", Dimension::length);
    if (!(length(cross(a, b)) > 0)) throw s.error("side_b", "must not be zero or parallel to side_a");
    return plate_form(s.vector("corner", Dimension::length), a, b);
  }
  if (kind == "disc") {
    const CaseTable s = shape.table(kind, {"centre", "normal", "radius", "hole", "segments"});
    const double radius = s.number("radius", Dimension::length, Range::positive);
    const double hole = s.number_or("hole", Dimension::length, 0, Range::positive);
    if (!(hole < radius)) throw s.error("hole", "is a radius and must be less than that of the disc");
    return disc_form(s.vector("centre", Dimension::length), s.direction("normal"), radius, hole, read_segments(s));
  }
  if (kind == "box") {
    const CaseTable s = shape.table(kind, {"corners", "open"});
    const auto [lower, upper] = s.corners("corners");
    const std::vector<bool> open = read_open(s, {"-x", "+x", "-y", "+y", "-z", "+z"});
    std::array<bool, 6> sides{};
    std::copy(open.begin(), open.end(), sides.begin());
    if (std::find(open.begin(), open.end(), false) == open.end()) throw s.error("open", "leaves no side of the box");
    return box_form(lower, upper, sides);
  }
  if (kind == "cone") {
    const CaseTable s = shape.table(kind, {"start", "end", "radius_start", "radius_end", "open", "segments"});
    const auto [start, end] = read_axis(s);
    const double first = s.number("radius_start", Dimension::length, Range::not_negative);
    const double last = s.number("radius_end", Dimension::length, Range::not_negative);
    if (!(first > 0 || last > 0)) throw s.error("radius_end", "one of the two radii must be > 0");
    const std::vector<bool> open = read_open(s, {"start", "end"});
    return cone_form(start, end, first, last, open[0], open[1], read_segments(s));
  }
  if (kind == "cylinder") return read_drum(shape.table(kind, {"start", "end", "radius", "open", "segments"}));
  if (kind == "hopper") {
    return read_hopper(shape.table(kind, {"outlet", "bin", "half_angle", "funnel_height", "bin_height", "stub", "segments"}));
  }
  return read_drum(shape.table("drum", {"start", "end", "radius", "lifters", "open", "segments"}));
}

}  // namespace

void read_cylinder(const CaseTable& t, Wall& wall) {
  wall.kind = WallKind::cylinder_inside;
  std::tie(wall.axis_start, wall.axis_end) = read_axis(t);
  wall.radius = t.number("radius", Dimension::length, Range::positive);
}

void read_sphere(const CaseTable& t, Wall& wall) {
  wall.kind = WallKind::sphere_inside;
  wall.point = t.vector("centre", Dimension::length);
  wall.radius = t.number("radius", Dimension::length, Range::positive);
}

void read_walls(const CaseTable& top, const std::string& folder, const std::vector<std::string>& materials, Case& c) {
  for (const CaseTable& t : top.tables("walls", {"name", "shape", "material", "motion", "position", "orientation", "scale", "cell_size"})) {
    CaseWall w;
    w.where = t.where();
    w.wall.material = t.reference("material", materials, "material");
    const CaseTable shape = t.table("shape", {"plane", "box_inside", "cylinder_inside", "sphere_inside", "plate", "disc", "box", "cylinder",
                                              "cone", "hopper", "drum", "file"});
    const std::string kind = shape.only_one_of(
        {"plane", "box_inside", "cylinder_inside", "sphere_inside", "plate", "disc", "box", "cylinder", "cone", "hopper", "drum", "file"});
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
      read_cylinder(shape.table(kind, {"start", "end", "radius"}), w.wall);
    } else if (kind == "sphere_inside") {
      read_sphere(shape.table(kind, {"centre", "radius"}), w.wall);
    } else {
      w.wall.kind = WallKind::mesh;
      if (kind == "file") {
        w.file = resolved(folder, shape.text("file"));
      } else {
        w.form = read_form(kind, shape);
      }
      w.wall.position = t.vector_or("position", Dimension::length, {});
      w.wall.orientation = read_orientation(t);
      w.wall.scale = t.number_or("scale", Dimension::none, 1, Range::positive);
      w.wall.cell_size = t.number_or("cell_size", Dimension::length, 0, Range::positive);
    }
    for (const char* key : {"position", "orientation", "scale", "cell_size"}) {
      if (w.wall.kind != WallKind::mesh && t.has(key))
        throw t.error(key, "is for walls that are meshes; a " + kind + " says itself where it is");
    }
    if (t.has("motion")) w.wall.motion = read_motion(t.table("motion", {"rotate", "translate", "oscillate", "table", "start", "stop"}));
    c.walls.push_back(w);
  }
}

}  // namespace scree
