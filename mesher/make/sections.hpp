// Cross-sections of lobes and of cylinders with holes, as catalysts and packings are pressed or extruded.
#pragma once

#include "core/geometry/extruded.hpp"

namespace scree {

/// The union of `count` discs of `radius` whose centres lie `spread` from the axis, at equal angles: trilobes, quadrilobes. A gap in the
/// middle, which discs leave open where spread > radius and count > 2, is filled. Each lobe has `steps` edges, with vertices on its circle.
/// Needs count >= 2 and radius > spread sin(pi / count), so that neighbours overlap.
CrossSection lobes(int count, double radius, double spread, int steps);

/// Length of the border of one lobe [m].
double arc_of_lobe(int count, double radius, double spread);

/// Area of the union with its gap filled [m^2]: count (spread^2 sin(2 t) / 2 + radius^2 t + s sqrt(radius^2 - s^2) + radius^2 asin(s /
/// radius)) with t = pi / count and s = spread sin(t), the integral of half the squared distance of the border from the axis.
double area_of_lobes(int count, double radius, double spread);

/// A disc with holes.
struct Drilled {
  double radius = 0;       ///< of the disc [m]
  double inner = 0;        ///< of the hole in the middle [m]; 0: none
  int holes = 0;           ///< around it, at equal angles; 0, or at least 2
  double hole_radius = 0;  ///< of each of them [m]
  double circle = 0;       ///< distance of their centres from the axis [m]
};

/// Why there is no such disc: holes that meet each other, the middle or the rim. Empty: there is one.
const char* fault_of(const Drilled& disc);

/// The disc in triangles: circles are polygons with vertices on them, `sectors` of the rim and of the hole in the middle, a multiple of the
/// number of holes, and `hole_sectors` of each hole.
CrossSection drilled(const Drilled& disc, int sectors, int hole_sectors);

}  // namespace scree
