#include "core/storage/wall_surface.hpp"

#include <fmt/format.h>

namespace scree {

SurfaceVelocity WallSurface::velocity(double time, const Pose& placed, const Pose& now) const {
  if (!is_given() || !(time >= motion.start && time < motion.stop)) return {};
  const MotionState drawn = std::visit([&](const auto& kind) { return kind.state(0, placed); }, motion.kind);
  if (now.orientation == placed.orientation) return {drawn.velocity, drawn.angular_velocity};
  const Quat turn = now.orientation * conjugate(placed.orientation);
  return {rotate(turn, drawn.velocity), rotate(turn, drawn.angular_velocity)};
}

Quat WallSurface::turned(double time, const Pose& placed) const {
  const auto* around = std::get_if<Rotate>(&motion.kind);
  if (around == nullptr) return {};
  return quaternion_of(rotate_inverse(placed.orientation, around->axis), around->rate * motion.elapsed(time));
}

std::string WallSurface::text() const {
  if (const auto* along = std::get_if<Translate>(&motion.kind)) return fmt::format("surface at {:.4g} m/s", along->rate);
  if (const auto* around = std::get_if<Rotate>(&motion.kind)) return fmt::format("surface at {:.4g} rad/s", around->rate);
  return "";
}

}  // namespace scree
