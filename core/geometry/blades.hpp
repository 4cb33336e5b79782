// Cross-sections of shafts that carry flights or blades, to be extruded along z: conveyor screws and paddle wheels.
#pragma once

#include "core/geometry/extruded.hpp"

namespace scree {

/// A shaft with helical flights of rectangular profile: all of a flight between shaft and rim has the same thickness along the axis.
struct Screw {
  double shaft = 0, radius = 0;  ///< of the shaft and of the rim of the flights [m], 0 < shaft < radius
  double pitch = 0;              ///< length in which a flight goes round once [m], > 0
  double thickness = 0;          ///< of a flight along the axis [m], > 0
  int starts = 1;                ///< flights, side by side
  bool left_handed = false;
};

/// Why there is no such screw. Empty: there is one.
const char* fault_of(const Screw& screw);

/// Its volume for each length [m^2]: pi shaft^2 + pi (radius^2 - shaft^2) starts thickness / pitch, since a plane across the axis cuts each
/// flight in a sector of the angle 2 pi thickness / pitch.
double area_of(const Screw& screw);

/// A screw along z, its middle at the origin. Circles have about `segments` corners, which lie on them, and so have helices in each turn:
/// the volume is below that of area_of() by an error of second order.   Cost: about 4 segments^2 length / pitch triangles at most.
TriangleMesh screw_mesh(const Screw& screw, double length, int segments);

/// A shaft with straight blades of constant thickness that stand on it like spokes.
struct PaddleWheel {
  double shaft = 0, radius = 0;  ///< of the shaft and of the circle through the outer corners of the blades [m], 0 < shaft < radius
  double thickness = 0;          ///< of a blade [m], below 2 shaft
  int blades = 0;
};

const char* fault_of(const PaddleWheel& wheel);

/// Area of the cross-section [m^2]: the sectors of the shaft between the blades, and of each blade, with b = asin(thickness / (2 shaft)),
/// shaft^2 sin(b) cos(b) + thickness (sqrt(radius^2 - thickness^2 / 4) - shaft cos(b)).
double area_of(const PaddleWheel& wheel);

CrossSection section_of(const PaddleWheel& wheel, int segments);

}  // namespace scree
