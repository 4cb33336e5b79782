#pragma once

#include "core/geometry/vec3.hpp"

namespace scree {

/// Where a picture is taken from.
struct View {
  Vec3 centre;        ///< of what is drawn [m]
  double radius = 1;  ///< of the ball about it [m]
  Vec3 from;          ///< unit, from the centre to the camera
  Vec3 up;            ///< unit, against gravity
};

}  // namespace scree
