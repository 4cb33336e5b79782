#include "core/geometry/blades.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/numbers.hpp"

namespace scree {

namespace {

std::int32_t add(CrossSection& section, double r, double angle) {
  section.points.push_back({r * std::cos(angle), r * std::sin(angle)});
  return static_cast<std::int32_t>(section.points.size()) - 1;
}

/// Steps of an arc, of `segments` around the whole circle.
int steps_of(double angle, int segments) { return std::max(1, static_cast<int>(std::lround(segments * angle / (2 * kPi)))); }

/// Triangles between the axis and the corners of the shaft, all around.
void fan(CrossSection& section, std::int32_t axis, const std::vector<std::int32_t>& shaft) {
  for (std::size_t i = 0; i < shaft.size(); ++i) section.triangles.push_back({axis, shaft[i], shaft[(i + 1) % shaft.size()]});
}

double angle_of_flight(const Screw& s) { return 2 * kPi * s.thickness / s.pitch; }

/// Half the angle between both feet of a blade, seen from the axis.
double half_angle_of_foot(const PaddleWheel& w) { return std::asin(0.5 * w.thickness / w.shaft); }

}  // namespace

const char* fault_of(const Screw& s) {
  if (!(s.shaft < s.radius)) return "the shaft is as wide as the flights";
  if (!(s.starts * s.thickness < s.pitch)) return "the flights leave no room between each other";
  return "";
}

double area_of(const Screw& s) {
  return kPi * s.shaft * s.shaft + 0.5 * s.starts * angle_of_flight(s) * (s.radius * s.radius - s.shaft * s.shaft);
}

TriangleMesh screw_mesh(const Screw& s, double length, int segments) {
  CrossSection section;
  const double flight = angle_of_flight(s), gap = 2 * kPi / s.starts - flight;
  const int across = steps_of(flight, segments), between = steps_of(gap, segments);
  const std::int32_t axis = add(section, 0, 0);
  std::vector<std::int32_t> shaft, border;
  for (int start = 0; start < s.starts; ++start) {
    const double first = 2 * kPi * start / s.starts - 0.5 * flight;
    std::vector<std::int32_t> foot, rim;
    for (int i = 0; i <= across; ++i) {
      const double angle = first + flight * i / across;
      foot.push_back(add(section, s.shaft, angle));
      rim.push_back(add(section, s.radius, angle));
    }
    for (std::size_t i = 0; i + 1 < foot.size(); ++i) {
      section.triangles.push_back({foot[i], rim[i], rim[i + 1]});
      section.triangles.push_back({foot[i], rim[i + 1], foot[i + 1]});
    }
    shaft.insert(shaft.end(), foot.begin(), foot.end());
    border.push_back(foot.front());
    border.insert(border.end(), rim.begin(), rim.end());
    border.push_back(foot.back());
    for (int i = 1; i < between; ++i) {
      shaft.push_back(add(section, s.shaft, first + flight + gap * i / between));
      border.push_back(shaft.back());
    }
  }
  fan(section, axis, shaft);
  section.loops = {border};
  const double turn = 2 * kPi * length / s.pitch;
  return extruded(section, length, s.left_handed ? -turn : turn, std::max(1, static_cast<int>(std::ceil(segments * length / s.pitch))));
}

const char* fault_of(const PaddleWheel& w) {
  if (!(w.shaft < w.radius)) return "the shaft is as wide as the blades";
  if (!(0.5 * w.thickness < w.shaft)) return "a blade is thicker than the shaft";
  if (!(half_angle_of_foot(w) < kPi / w.blades)) return "the blades leave no room between each other at the shaft";
  return "";
}

double area_of(const PaddleWheel& w) {
  const double b = half_angle_of_foot(w), half = 0.5 * w.thickness, foot = w.shaft * std::cos(b);
  const double tip = std::sqrt(w.radius * w.radius - half * half);
  return w.shaft * w.shaft * (kPi - w.blades * b) + w.blades * (foot * half + w.thickness * (tip - foot));
}

CrossSection section_of(const PaddleWheel& w, int segments) {
  CrossSection section;
  const double foot = half_angle_of_foot(w), tip = std::asin(0.5 * w.thickness / w.radius), gap = 2 * kPi / w.blades - 2 * foot;
  const int between = steps_of(gap, segments);
  const std::int32_t axis = add(section, 0, 0);
  std::vector<std::int32_t> shaft, border;
  for (int blade = 0; blade < w.blades; ++blade) {
    const double middle = 2 * kPi * blade / w.blades;
    const std::int32_t low = add(section, w.shaft, middle - foot), high = add(section, w.shaft, middle + foot);
    const std::int32_t tip_low = add(section, w.radius, middle - tip), tip_high = add(section, w.radius, middle + tip);
    section.triangles.push_back({low, tip_low, tip_high});
    section.triangles.push_back({low, tip_high, high});
    shaft.insert(shaft.end(), {low, high});
    border.insert(border.end(), {low, tip_low, tip_high, high});
    for (int i = 1; i < between; ++i) {
      shaft.push_back(add(section, w.shaft, middle + foot + gap * i / between));
      border.push_back(shaft.back());
    }
  }
  fan(section, axis, shaft);
  section.loops = {border};
  return section;
}

}  // namespace scree
