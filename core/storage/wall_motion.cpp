#include "core/storage/wall_motion.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/error.hpp"

namespace scree {

namespace {

WallState state_at(const Wall& wall, double time) {
  WallState state{wall.position, wall.orientation, {}, {}, {}, {}, {}, {}};
  const WallMotion& m = wall.motion;
  if (m.kind == WallMotion::Kind::none) return state;
  const double elapsed = std::clamp(time, m.start, std::max(m.start, m.stop)) - m.start;
  const bool moving = time >= m.start && time < m.stop;
  switch (m.kind) {
    case WallMotion::Kind::none:
      break;
    case WallMotion::Kind::rotate: {
      const Quat turn = quaternion_of(m.axis, m.rate * elapsed);
      state.position = m.centre + rotate(turn, wall.position - m.centre);
      state.orientation = turn * wall.orientation;
      if (moving) {
        state.angular_velocity = m.rate * m.axis;
        state.velocity = cross(state.angular_velocity, state.position - m.centre);
      }
      break;
    }
    case WallMotion::Kind::translate:
      state.position = wall.position + (m.rate * elapsed) * m.axis;
      if (moving) state.velocity = m.rate * m.axis;
      break;
    case WallMotion::Kind::oscillate: {
      const double omega = 2 * std::numbers::pi * m.frequency;
      state.position = wall.position + m.amplitude * (std::sin(omega * elapsed + m.phase) - std::sin(m.phase)) * m.axis;
      if (moving) state.velocity = m.amplitude * omega * std::cos(omega * elapsed + m.phase) * m.axis;
      break;
    }
    case WallMotion::Kind::table: {
      if (m.table_time.empty()) break;
      const double t = elapsed;
      const auto next = std::upper_bound(m.table_time.begin(), m.table_time.end(), t);
      const auto i = static_cast<std::size_t>(next - m.table_time.begin());
      if (i == 0) {
        state.position += m.table_position.front();
      } else if (i == m.table_time.size()) {
        state.position += m.table_position.back();
      } else {
        const double width = m.table_time[i] - m.table_time[i - 1];
        const Vec3 velocity = (1 / width) * (m.table_position[i] - m.table_position[i - 1]);
        state.position += m.table_position[i - 1] + (t - m.table_time[i - 1]) * velocity;
        if (moving) state.velocity = velocity;
      }
      break;
    }
  }
  return state;
}

}  // namespace

WallState wall_state(const Wall& wall, double time, double step) {
  WallState state = state_at(wall, time);
  state.pivot = state.position;
  if (wall.motion.kind == WallMotion::Kind::none) return state;
  const WallState before = step > 0 ? state_at(wall, time - 0.5 * step) : state;
  state.velocity_before = before.velocity;
  state.angular_velocity_before = before.angular_velocity;
  if (wall.motion.kind == WallMotion::Kind::rotate)
    state.pivot = wall.motion.centre;
  else
    state.pivot_velocity_before = before.velocity;
  return state;
}

Wall wall_at_start(const Wall& wall) {
  Wall placed = wall;
  placed.motion = {};
  const WallState state = wall_state(wall, 0);
  if (state.position == wall.position && state.orientation == wall.orientation) return placed;
  if (wall.kind == WallKind::mesh) {
    placed.position = state.position;
    placed.orientation = state.orientation;
    return placed;
  }
  // an analytic wall has no place of its own: its points are moved
  const auto moved = [&](const Vec3& p) { return state.position + rotate(state.orientation, p - wall.position); };
  if (wall.kind == WallKind::box_inside && !(state.orientation == wall.orientation)) {
    throw UsageError(
        "wall {} ('{}'): its motion starts at {:g} s, so that the box_inside is turned when the run begins; nothing can be placed "
        "in it then. Start at 0 s, or make the wall of shape = {{ box = ... }}",
        wall.id, wall.name, wall.motion.start);
  }
  placed.point = moved(wall.point);
  placed.normal = rotate(state.orientation, wall.normal);
  placed.axis_start = moved(wall.axis_start);
  placed.axis_end = moved(wall.axis_end);
  if (wall.kind == WallKind::box_inside) {
    placed.lower = moved(wall.lower);
    placed.upper = moved(wall.upper);
  }
  return placed;
}

}  // namespace scree
