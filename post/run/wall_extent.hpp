// Where walls are, and how far they reach.
#pragma once

#include <optional>

#include "core/storage/scene.hpp"
#include "post/run/region.hpp"

namespace scree {

/// World position and orientation of a wall.
struct WallPlace {
  Vec3 position;
  Quat orientation;
};

/// Box around a wall at its place in a frame [m]; none for a plane, which has no end.
std::optional<Box3> wall_extent(const Wall& wall, const Scene& scene, const WallPlace& place);

/// What an analytic wall with an end holds, in its own frame.
Region inside_of(const Wall& wall);

}  // namespace scree
