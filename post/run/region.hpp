// A part of space that the user names: "box:...", "cylinder:...", "sphere:...". All are convex.
#pragma once

#include <optional>
#include <string>
#include <utility>

#include "core/geometry/triangle_mesh.hpp"

namespace scree {

struct Region {
  enum class Kind { box, cylinder, sphere };
  std::string name;
  Kind kind = Kind::box;
  Vec3 lower, upper;  ///< box: opposite corners; cylinder: ends of the axis; sphere: lower is the centre [m]
  double radius = 0;  ///< cylinder, sphere [m]

  bool contains(const Vec3& point) const;
  double volume() const;  ///< [m^3]
  Box3 bounds() const;
  /// Volume of the part in a box [m^3].
  /// How: of a box exact; else a sum over lines along an axis of the exact part of each line (part_inside), whose places lie closer
  /// towards the sides of the box, where the chords of circles end steeply: 3e-5 of the whole with 128 x 128 lines.
  /// in   lines   along each of the two other axes
  double volume_in(const Box3& box, int lines = 128) const;
  /// The part of the segment from a to b inside, as shares [first, last] of its length; none when it passes outside.
  std::optional<std::pair<double, double>> part_inside(const Vec3& a, const Vec3& b) const;
};

/// Reads "NAME=box:x0,y0,z0,x1,y1,z1", "cylinder:x0,y0,z0,x1,y1,z1,r" or "sphere:x,y,z,r"; the name may be left out, numbers
/// are metres or carry a unit of length.
/// Fails: UsageError with what was found and what was expected.
Region parse_region(const std::string& text);

}  // namespace scree
