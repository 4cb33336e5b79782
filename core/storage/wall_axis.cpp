#include "core/storage/wall_axis.hpp"

namespace scree {

std::optional<TurnAxis> own_axis(const Wall& wall, double time) {
  const std::span<const WallMotion> parts = wall.motion.parts();
  const auto carried = [&](const TurnAxis& axis, std::size_t first) {
    Pose pose{axis.point, {}};
    for (std::size_t later = first; later < parts.size(); ++later) pose = parts[later].state(time, pose).pose;
    return TurnAxis{pose.position, rotate(pose.orientation, axis.direction)};
  };
  for (std::size_t k = parts.size(); k-- > 0;) {
    if (const std::optional<TurnAxis> axis = parts[k].turn_axis()) return carried(*axis, k + 1);
  }
  if (const std::optional<TurnAxis> axis = wall.surface.motion.turn_axis()) return carried(*axis, 0);
  return {};
}

double axis_torque(const TurnAxis& axis, const Vec3& force, const Vec3& torque) {
  return dot(axis.direction, torque - cross(axis.point, force));
}

}  // namespace scree
