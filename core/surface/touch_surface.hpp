// What of a shape contacts are computed with: the mesh, and the margin around it at which touch begins.
#pragma once

#include "core/storage/scene_file.hpp"

namespace scree {

struct TouchSurface {
  TriangleMesh mesh;  ///< axes and origin as those of the shape
  double margin = 0;  ///< around the mesh, at scale 1 [m]; 0 where all bodies have one margin (contact.surface = "outside")
};

/// Margin of a shape of a scene, at scale 1 [m]: margin_ratio times the radius of the ball of its volume; 0 for analytic spheres and wall
/// surfaces, which lie where they are drawn, and where all bodies have one margin.
double own_margin(const Shape& shape, const Settings& settings);

/// Margin of every body where it is one for all [m], else 0.
inline double common_margin(const Settings& settings) { return settings.surface == TouchAt::outside ? settings.margin : 0; }

/// Cost: that of an inset (inset.hpp) for a mesh with a margin of its own.
TouchSurface touch_surface(const Shape& shape, const Settings& settings);

}  // namespace scree
