#include "core/storage/wall_state.hpp"

#include "core/base/error.hpp"

namespace scree {

WallState wall_state(const Wall& wall, double time, double step, const DriveState* drive) {
  const Pose placed{wall.position, wall.orientation};
  const std::optional<Drive> answers = drive != nullptr ? wall.motion.drive() : std::nullopt;
  const MotionState now = answers ? answers->guide.state(drive->way, drive->rate, placed) : wall.motion.state(time, placed);
  WallState state{now.pose.position, now.pose.orientation, now.velocity, now.angular_velocity, {}, {}, now.pose.position, {}, {}, {}, {}};
  if (wall.surface.is_given()) {
    state.surface = wall.surface.velocity(time, placed, now.pose);
    state.surface_before = wall.surface.velocity(time - 0.5 * step, placed, now.pose);
    state.surface_turned = wall.surface.turned(time, placed) * conjugate(wall.surface.turned(time - step, placed));
  }
  if (!wall.motion.is_prescribed()) return state;
  const MotionState before = answers    ? answers->guide.state(drive->way, drive->rate_before, placed)
                             : step > 0 ? wall.motion.state(time - 0.5 * step, placed)
                                        : now;
  state.velocity_before = before.velocity;
  state.angular_velocity_before = before.angular_velocity;
  if (const auto* several = std::get_if<Several>(&wall.motion.kind)) {
    state.pivot = several->pivot(time, placed);
    const Vec3 was = several->pivot(time - 0.5 * step, placed);
    state.pivot_velocity_before = before.velocity + cross(before.angular_velocity, was - before.pose.position);
  } else if (const std::optional<TurnAxis> axis = wall.motion.turn_axis())
    state.pivot = axis->point;
  else
    state.pivot_velocity_before = before.velocity;
  return state;
}

Wall wall_standing_at(const Wall& wall, const Vec3& position, const Quat& orientation) {
  Wall placed = wall;
  placed.motion = {};
  placed.surface = {};
  if (position == wall.position && orientation == wall.orientation) return placed;
  if (wall.kind == WallKind::mesh) {
    placed.position = position;
    placed.orientation = orientation;
    return placed;
  }
  // an analytic wall has no place of its own: its points are moved
  const auto moved = [&](const Vec3& p) { return position + rotate(orientation, p - wall.position); };
  if (wall.kind == WallKind::box_inside && !(orientation == wall.orientation)) {
    throw UsageError(
        "wall {} ('{}'): its motion starts at {:g} s, so that the box_inside is turned when the run begins; nothing can be placed "
        "in it then. Start at 0 s, or make the wall of shape = {{ box = ... }}",
        wall.id, wall.name, wall.motion.start);
  }
  placed.point = moved(wall.point);
  placed.normal = rotate(orientation, wall.normal);
  placed.axis_start = moved(wall.axis_start);
  placed.axis_end = moved(wall.axis_end);
  if (wall.kind == WallKind::box_inside) {
    placed.lower = moved(wall.lower);
    placed.upper = moved(wall.upper);
  }
  return placed;
}

Wall wall_at_start(const Wall& wall) {
  const WallState state = wall_state(wall, 0);
  return wall_standing_at(wall, state.position, state.orientation);
}

}  // namespace scree
