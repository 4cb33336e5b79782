#include "decomposer/case/wall_forms.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/base/error.hpp"
#include "core/geometry/closed_mesh.hpp"

namespace scree {

namespace {

using Point2 = std::array<double, 2>;
using Ring = std::vector<std::int32_t>;

std::vector<Point2> circle(double radius, int segments) {
  std::vector<Point2> points;
  for (int i = 0; i < segments; ++i) {
    const double a = 2 * std::numbers::pi * i / segments;
    points.push_back({radius * std::cos(a), radius * std::sin(a)});
  }
  return points;
}

/// Puts outlines on top of each other along an axis and joins them. Outlines are counter-clockwise seen against the axis.
class Tube {
 public:
  Tube(const Vec3& origin, const Vec3& axis) : origin_(origin), axis_(axis) { std::tie(u_, v_) = across(axis); }

  Ring ring(const std::vector<Point2>& outline, double height) {
    Ring result;
    for (const Point2& p : outline) result.push_back(vertex(p[0] * u_ + p[1] * v_ + height * axis_));
    return result;
  }
  std::int32_t vertex(const Vec3& offset) {
    mesh_.vertices.push_back(origin_ + offset);
    return mesh_.vertex_count() - 1;
  }
  /// Faces between a ring and the next one along the axis, towards the inside; `whole`: the last corner is joined with the first.
  void join(const Ring& low, const Ring& high, bool whole = true) {
    for (std::size_t i = 0; i + (whole ? 0 : 1) < low.size(); ++i) {
      const std::size_t j = (i + 1) % low.size();
      mesh_.triangles.push_back({low[i], high[i], high[j]});
      mesh_.triangles.push_back({low[i], high[j], low[j]});
    }
  }
  /// Faces between a ring and the tip of a cone.
  void join_to_tip(const Ring& ring, double height, bool tip_is_end) {
    const std::int32_t tip = vertex(height * axis_);
    for (std::size_t i = 0; i < ring.size(); ++i) {
      const std::size_t j = (i + 1) % ring.size();
      mesh_.triangles.push_back(tip_is_end ? Triangle{ring[i], tip, ring[j]} : Triangle{tip, ring[i], ring[j]});
    }
  }
  /// A lid over a ring; `faces_along`: it looks along the axis, as the one at the start does.
  void lid(const Ring& ring, const std::vector<Triangle>& triangles, bool faces_along) {
    for (const Triangle& t : triangles) {
      const auto v = [&](std::size_t k) { return ring[static_cast<std::size_t>(t[k])]; };
      mesh_.triangles.push_back(faces_along ? Triangle{v(0), v(1), v(2)} : Triangle{v(0), v(2), v(1)});
    }
  }
  /// A lid of triangles that meet in the middle: better shaped than clipped ears, for outlines that are seen whole from there.
  void fan(const Ring& ring, double height, bool faces_along) {
    const std::int32_t middle = vertex(height * axis_);
    for (std::size_t i = 0; i < ring.size(); ++i) {
      const std::size_t j = (i + 1) % ring.size();
      mesh_.triangles.push_back(faces_along ? Triangle{middle, ring[i], ring[j]} : Triangle{middle, ring[j], ring[i]});
    }
  }
  TriangleMesh take() { return std::move(mesh_); }

 private:
  Vec3 origin_, axis_, u_, v_;
  TriangleMesh mesh_;
};

TriangleMesh turned_inside_out(TriangleMesh mesh) {
  turn_inside_out(mesh);
  return mesh;
}

TriangleMesh cone_surface(const Vec3& start, const Vec3& end, double radius_start, double radius_end, bool lid_start, bool lid_end,
                          int segments) {
  const double height = length(end - start);
  Tube tube(start, normalised(end - start));
  if (radius_start > 0 && radius_end > 0) {
    const Ring low = tube.ring(circle(radius_start, segments), 0), high = tube.ring(circle(radius_end, segments), height);
    tube.join(low, high);
    if (lid_start) tube.fan(low, 0, true);
    if (lid_end) tube.fan(high, height, false);
  } else if (radius_start > 0) {
    const Ring low = tube.ring(circle(radius_start, segments), 0);
    tube.join_to_tip(low, height, true);
    if (lid_start) tube.fan(low, 0, true);
  } else {
    const Ring high = tube.ring(circle(radius_end, segments), height);
    tube.join_to_tip(high, 0, false);
    if (lid_end) tube.fan(high, height, false);
  }
  return tube.take();
}

TriangleMesh box_surface(const Vec3& lower, const Vec3& upper, const std::array<bool, 6>& open) {
  TriangleMesh mesh = box_mesh(upper - lower);  // two triangles a side, outward
  TriangleMesh result;
  const Vec3 centre = 0.5 * (lower + upper);
  for (const Vec3& p : mesh.vertices) result.vertices.push_back(centre + p);
  for (std::int32_t t = 0; t < mesh.triangle_count(); ++t) {
    const Vec3 n = cross(mesh.corner(t, 1) - mesh.corner(t, 0), mesh.corner(t, 2) - mesh.corner(t, 0));
    std::size_t side = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      if (n[static_cast<int>(k)] != 0) side = 2 * k + (n[static_cast<int>(k)] > 0 ? 1 : 0);
    }
    const Triangle& v = mesh.triangles[static_cast<std::size_t>(t)];
    if (!open[side]) result.triangles.push_back({v[0], v[2], v[1]});
  }
  return result;
}

/// Where bars and arcs of a drum stand.
struct DrumParts {
  double half, pitch;  ///< half of the angle of a bar, from one bar to the next
  int arc_segments;    ///< between two bars
};
DrumParts parts_of_drum(double radius, const Lifters& lifters, int segments) {
  const double half = std::asin(0.5 * lifters.width / radius), pitch = 2 * std::numbers::pi / lifters.count;
  return {half, pitch, std::max(1, static_cast<int>(std::lround(segments * (pitch - 2 * half) / (2 * std::numbers::pi))))};
}

/// Outline of a drum with lifters, counter-clockwise.
std::vector<Point2> drum_outline(double radius, const Lifters& lifters, int segments) {
  const auto [half, pitch, arc_segments] = parts_of_drum(radius, lifters, segments);
  const double inner = radius - lifters.height;
  std::vector<Point2> outline;
  const auto add = [&](double angle, double along, double side) {
    outline.push_back({along * std::cos(angle) - side * std::sin(angle), along * std::sin(angle) + side * std::cos(angle)});
  };
  for (int i = 0; i < lifters.count; ++i) {
    const double angle = pitch * i;
    add(angle - half, radius, 0);
    add(angle, inner, -0.5 * lifters.top_width);
    add(angle, inner, 0.5 * lifters.top_width);
    // the arc to the next lifter; its last corner is that lifter's first
    for (int k = 0; k < arc_segments; ++k) add(angle + half + k * (pitch - 2 * half) / arc_segments, radius, 0);
  }
  return outline;
}

TriangleMesh drum_surface(const Vec3& start, const Vec3& end, const std::vector<Point2>& outline, bool lid_start, bool lid_end) {
  Tube tube(start, normalised(end - start));
  const std::vector<Triangle> lid = triangulate_polygon(outline);
  const Ring low = tube.ring(outline, 0), high = tube.ring(outline, length(end - start));
  tube.join(low, high);
  if (lid_start) tube.lid(low, lid, true);
  if (lid_end) tube.lid(high, lid, false);
  return tube.take();
}

TriangleMesh hopper_surface(const Hopper& h, int segments, bool closed) {
  const auto outline = [&](const double(&size)[2]) -> std::vector<Point2> {
    if (h.round) return circle(0.5 * size[0], segments);
    const double x = 0.5 * size[0], y = 0.5 * size[1];
    return {{x, -y}, {x, y}, {-x, y}, {-x, -y}};
  };
  Tube tube({}, {0, 0, 1});
  const double top = h.funnel_height + h.bin_height;
  Ring lowest = tube.ring(outline(h.outlet), 0);
  const Ring foot = tube.ring(outline(h.bin), h.funnel_height), rim = tube.ring(outline(h.bin), top);
  tube.join(lowest, foot);
  tube.join(foot, rim);
  if (h.stub > 0) {
    const Ring mouth = tube.ring(outline(h.outlet), -h.stub);
    tube.join(mouth, lowest);
    lowest = mouth;
  }
  if (closed) {
    tube.fan(lowest, -h.stub, true);
    tube.fan(rim, top, false);
  }
  return tube.take();
}

/// Corners of the half circle lie on it. Counter-clockwise, from the rim of one side to that of the other.
TriangleMesh trough_surface(const Vec3& start, const Vec3& end, double radius, double height, int segments, bool lid_start, bool lid_end,
                            bool lid_above) {
  const int steps = std::max(2, segments / 2);
  std::vector<Point2> outline{{height, radius}};  // upwards, and to the side
  for (int i = 0; i <= steps; ++i) {
    const double a = std::numbers::pi * i / steps;
    outline.push_back({-radius * std::sin(a), radius * std::cos(a)});
  }
  outline.push_back({height, -radius});
  const Vec3 axis = end - start;
  Tube tube(start, normalised(axis));
  const std::vector<Triangle> plate = triangulate_polygon(outline);
  const Ring low = tube.ring(outline, 0), high = tube.ring(outline, length(axis));
  tube.join(low, high, lid_above);
  if (lid_start) tube.lid(low, plate, true);
  if (lid_end) tube.lid(high, plate, false);
  return tube.take();
}

}  // namespace

std::pair<Vec3, Vec3> across(const Vec3& axis) {
  const Vec3 away = std::abs(axis.z) > 0.9 ? Vec3{1, 0, 0} : Vec3{0, 0, 1};
  const Vec3 first = normalised(away - dot(away, axis) * axis);
  return {first, cross(axis, first)};
}

WallForm plate_form(const Vec3& corner, const Vec3& side_a, const Vec3& side_b) {
  return {{{corner, corner + side_a, corner + side_a + side_b, corner + side_b}, {{0, 1, 2}, {0, 2, 3}}}, {}};
}

WallForm disc_form(const Vec3& centre, const Vec3& normal, double radius, double hole, int segments) {
  Tube tube(centre, normal);
  const Ring rim = tube.ring(circle(radius, segments), 0);
  if (hole > 0) {
    tube.join(tube.ring(circle(hole, segments), 0), rim);
  } else {
    tube.fan(rim, 0, true);
  }
  return {tube.take(), {}};
}

WallForm box_form(const Vec3& lower, const Vec3& upper, const std::array<bool, 6>& open) {
  return {box_surface(lower, upper, open), turned_inside_out(box_surface(lower, upper, {}))};
}

WallForm cone_form(const Vec3& start, const Vec3& end, double radius_start, double radius_end, bool open_start, bool open_end,
                   int segments) {
  return {cone_surface(start, end, radius_start, radius_end, !open_start, !open_end, segments),
          turned_inside_out(cone_surface(start, end, radius_start, radius_end, true, true, segments))};
}

bool lifters_are_inside(double radius, const Lifters& lifters, int segments) {
  const DrumParts parts = parts_of_drum(radius, lifters, segments);
  const double inner = radius - lifters.height, corner = std::hypot(inner, 0.5 * lifters.top_width),
               angle = std::atan2(0.5 * lifters.top_width, inner);
  if (!(corner < radius)) return false;
  // a corner beyond the foot of its bar lies in front of the chords of the arc
  const double step = (parts.pitch - 2 * parts.half) / parts.arc_segments;
  if (angle <= parts.half) return true;
  const double chord = std::floor((angle - parts.half) / step), middle = parts.half + (chord + 0.5) * step;
  return corner * std::cos(angle - middle) < radius * std::cos(0.5 * step);
}

WallForm drum_form(const Vec3& start, const Vec3& end, double radius, const Lifters& lifters, bool open_start, bool open_end,
                   int segments) {
  const std::vector<Point2> outline = drum_outline(radius, lifters, segments);
  return {drum_surface(start, end, outline, !open_start, !open_end), turned_inside_out(drum_surface(start, end, outline, true, true))};
}

WallForm hopper_form(const Hopper& hopper, int segments) {
  return {hopper_surface(hopper, segments, false), turned_inside_out(hopper_surface(hopper, segments, true))};
}

WallForm trough_form(const Vec3& start, const Vec3& end, double radius, double height, bool open_start, bool open_end, int segments) {
  return {trough_surface(start, end, radius, height, segments, !open_start, !open_end, false),
          turned_inside_out(trough_surface(start, end, radius, height, segments, true, true, true))};
}

std::vector<Triangle> triangulate_polygon(const std::vector<std::array<double, 2>>& corners) {
  const auto turn = [&](std::int32_t a, std::int32_t b, std::int32_t c) {
    const Point2 &p = corners[static_cast<std::size_t>(a)], &q = corners[static_cast<std::size_t>(b)],
                 &r = corners[static_cast<std::size_t>(c)];
    return (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
  };
  std::vector<std::int32_t> left(corners.size());
  for (std::size_t i = 0; i < left.size(); ++i) left[i] = static_cast<std::int32_t>(i);
  // how good an ear is: height over base, 0 for none. The best is cut first: the first one found would make a fan of slivers.
  const auto quality_at = [&](std::size_t i) {
    const std::int32_t a = left[(i + left.size() - 1) % left.size()], b = left[i], c = left[(i + 1) % left.size()];
    const double area = turn(a, b, c);
    if (!(area > 0)) return 0.0;
    for (const std::int32_t other : left) {
      if (other == a || other == b || other == c) continue;
      if (turn(a, b, other) >= 0 && turn(b, c, other) >= 0 && turn(c, a, other) >= 0) return 0.0;
    }
    const Point2 &p = corners[static_cast<std::size_t>(a)], &q = corners[static_cast<std::size_t>(c)];
    return area / std::max(1e-300, (q[0] - p[0]) * (q[0] - p[0]) + (q[1] - p[1]) * (q[1] - p[1]));
  };
  std::vector<double> quality(left.size());
  for (std::size_t i = 0; i < left.size(); ++i) quality[i] = quality_at(i);
  std::vector<Triangle> triangles;
  while (left.size() > 3) {
    const auto best = static_cast<std::size_t>(std::max_element(quality.begin(), quality.end()) - quality.begin());
    SCREE_ASSERT(quality[best] > 0, "the outline crosses itself");
    triangles.push_back({left[(best + left.size() - 1) % left.size()], left[best], left[(best + 1) % left.size()]});
    left.erase(left.begin() + static_cast<std::ptrdiff_t>(best));
    quality.erase(quality.begin() + static_cast<std::ptrdiff_t>(best));
    // a corner that was no ear for one in its way may be one now, but none stops being one: only neighbours change shape
    for (const std::size_t i : {(best + left.size() - 1) % left.size(), best % left.size()}) quality[i] = quality_at(i);
    if (*std::max_element(quality.begin(), quality.end()) > 0) continue;
    for (std::size_t i = 0; i < left.size(); ++i) quality[i] = quality_at(i);
  }
  triangles.push_back({left[0], left[1], left[2]});
  return triangles;
}

}  // namespace scree
