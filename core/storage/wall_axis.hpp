// The axis of a wall that turns, of which its torque is told.
#pragma once

#include <optional>

#include "core/storage/scene.hpp"

namespace scree {

/// The axis about which a wall turns, or else its surface; of several motions that of the last that turns, carried along by those after it.
/// None for a wall that never turns.
/// in   time   [s]
std::optional<TurnAxis> own_axis(const Wall& wall, double time);

/// Torque about the axis [N m].   in   force, torque   [N], [N m], about the origin of the world
double axis_torque(const TurnAxis& axis, const Vec3& force, const Vec3& torque);

}  // namespace scree
