// How the surface of a wall moves along itself while the wall stays where it is: a conveyor belt, the top of a rotary feeder. At a contact
// only the part of it along the tangent plane counts, in friction and in what damps sliding; a contact's normal force knows nothing of it.
#pragma once

#include <span>
#include <string>

#include "core/storage/wall_motion.hpp"

namespace scree {

/// A field of velocities, at a place x from the point that it is told about: velocity + spin x x.
struct SurfaceVelocity {
  Vec3 velocity, spin;  ///< [m/s], [rad/s]

  Vec3 at(const Vec3& x) const { return velocity + cross(spin, x); }
};

/// Given where the wall is placed; it goes along with the motion of the wall, and comes on top of it.
struct WallSurface {
  WallMotion motion;  ///< none, translate, or rotate: the velocities that a wall of that motion had, without its going anywhere

  bool is_given() const { return motion.is_prescribed(); }
  /// It moves at some time.
  bool moves() const { return motion.moves(); }
  bool turns() const { return motion.turn_axis().has_value(); }
  /// When it moves for the last time [s].
  double end() const { return motion.end(); }
  /// About the origin of the wall's frame.   in   placed   pose of the wall as drawn     in   now   its pose at the time
  SurfaceVelocity velocity(double time, const Pose& placed, const Pose& now) const;
  /// How far what moves along has turned, in the frame of the wall: its friction springs go round with it.
  Quat turned(double time, const Pose& placed) const;
  std::string text() const;
};

}  // namespace scree
