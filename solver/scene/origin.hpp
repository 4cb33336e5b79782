// Scenes far from the world's origin. Doubles lie 1e-10 apart at 1e6, and a step that adds 1e-9 there loses its digits; so
// such a scene is computed about its own middle, and only what is written is moved back.
#pragma once

#include "core/storage/scene_file.hpp"
#include "core/storage/wall_state.hpp"

namespace scree {

/// Where the solver's origin should be in the world [m]: 0 unless the bodies lie further from it than a thousand times the
/// extent of all of them. A whole number of extents (to a power of two), so that moving a position there rounds nothing.
Vec3 choose_origin(const Scene& scene);

/// Moves bodies, walls, domain and cut by -origin.
void move_scene(Scene& scene, const Vec3& origin);

/// Place of a wall's own frame in the world, for a wall of the moved scene.
Vec3 wall_position_in_world(const Wall& wall, const WallState& state, const Vec3& origin);

}  // namespace scree
