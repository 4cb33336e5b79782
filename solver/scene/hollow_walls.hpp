// Walls that bend towards the bodies that they hold.
#pragma once

#include "core/storage/scene_file.hpp"
#include "solver/scene/body_extremes.hpp"

namespace scree {

/// By how much R* of two materials exceeds the radius of their largest body: 1, or more where it lies in a hollow sphere, in which
/// 1/R* = 1/R_a - 1/R. Source: K. L. Johnson, Contact Mechanics (1985), section 4.2.
double hollow_factor(const Scene& scene, const MaterialPair& pair, const BodyExtremes& extremes);

}  // namespace scree
