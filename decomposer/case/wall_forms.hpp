// Containers from a few numbers: plates, boxes, tubes, cones, hoppers and drums as triangle meshes.
//
// The walls that the solver knows by formula (plane, box_inside, cylinder_inside, sphere_inside) go on indefinitely or have
// no openings; these are finite, may be open, and are met from both sides. Triangles face the inside: edges between
// faces that are concave from there then carry no contact of their own (core/geometry/features.hpp), however finely a
// tube is faceted. From outside such an edge is met by corners and faces only.
#pragma once

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/geometry/triangle_mesh.hpp"

namespace scree {

/// A wall made from numbers.
struct WallForm {
  TriangleMesh surface;  ///< as it stands in the scene, triangles towards the inside
  TriangleMesh inside;   ///< what it would hold with all openings closed: closed, outward; empty for plates and discs
};

/// Corners of the polygon that stands for a circle lie on it: at 64 corners the area is 0.16 % less than the circle's.
inline constexpr int kDefaultSegments = 64;

/// Most triangles of a form: 0.3 GB of mesh; a load map of them is 2 GB on each rank.
inline constexpr std::int64_t kMostTriangles = 4'000'000;

/// A parallelogram with corners c, c + a, c + b, c + a + b [m].
WallForm plate_form(const Vec3& corner, const Vec3& side_a, const Vec3& side_b);

/// A flat ring, or a disc when hole = 0.
/// in   normal   unit     in   radius > hole >= 0 [m]     in   segments   corners of the circle, >= 3
WallForm disc_form(const Vec3& centre, const Vec3& normal, double radius, double hole, int segments);

/// A box; `open`: which of its sides -x +x -y +y -z +z are left out.
WallForm box_form(const Vec3& lower, const Vec3& upper, const std::array<bool, 6>& open);

/// A cylinder, or a frustum when the radii differ; one of them may be 0 [m].
WallForm cone_form(const Vec3& start, const Vec3& end, double radius_start, double radius_end, bool open_start, bool open_end,
                   int segments);

/// Lifters (bars along a drum's wall): trapezoids that stand on the wall and point to the axis.
struct Lifters {
  int count = 0;
  double height = 0;     ///< from the circle of the wall towards the axis [m]
  double width = 0;      ///< at the wall [m]
  double top_width = 0;  ///< at the inner end [m], > 0
};
/// A drum with lifters.   Needs height < radius, and room between two lifters at the wall and at their inner ends.
WallForm drum_form(const Vec3& start, const Vec3& end, double radius, const Lifters& lifters, bool open_start, bool open_end, int segments);

/// Whether the tops of all bars stand inside the wall of a drum, its facets included.   in   radius, lifters, segments   as of drum_form()
bool lifters_are_inside(double radius, const Lifters& lifters, int segments);

/// A bin over a funnel over an outlet, all on the z axis: the outlet lies at z = 0, a stub below it.
struct Hopper {
  bool round = true;
  double outlet[2] = {0, 0}, bin[2] = {0, 0};  ///< diameters, or widths along x and y [m]; bin >= outlet > 0
  double funnel_height = 0;                    ///< [m]; 0: a flat floor with a hole
  double bin_height = 0;                       ///< [m], > 0
  double stub = 0;                             ///< length of the tube below the outlet [m]
};
WallForm hopper_form(const Hopper& hopper, int segments);

/// Open above: a half tube about a level axis, with upright sides.   in   height   of the sides above the axis [m]
WallForm trough_form(const Vec3& start, const Vec3& end, double radius, double height, bool open_start, bool open_end, int segments);

/// Two unit vectors across an axis, right-handed with it; the first points up as far as it can, on a vertical axis along x.
std::pair<Vec3, Vec3> across(const Vec3& axis);

/// Triangles of a simple polygon, counter-clockwise, by clipping ears.   Cost: O(n^2) for most outlines.
std::vector<Triangle> triangulate_polygon(const std::vector<std::array<double, 2>>& corners);

}  // namespace scree
