// Where a wall is and how fast it moves, from its motion (wall_motion.hpp). Decomposer and solver must agree on it.
#pragma once

#include "core/storage/scene_file.hpp"

namespace scree {

/// Pose and motion of a wall at a time.
struct WallState {
  Vec3 position;  ///< of the wall frame's origin [m]
  Quat orientation;
  Vec3 velocity, angular_velocity;                ///< [m/s] of the origin, [rad/s]
  Vec3 velocity_before, angular_velocity_before;  ///< the same half a step before
  /// A point of the wall and its velocity half a step before [m, m/s]: of a wall that turns on the axis, so that arms to it are those of
  /// the motion wherever the wall's origin is; else the origin.
  Vec3 pivot, pivot_velocity_before;
  /// How its surface moves along itself, on top of the wall's motion, about `position`: now, and half a step before.
  SurfaceVelocity surface, surface_before;
  Quat surface_turned;  ///< how far it has turned in the step, in the wall's frame
};
/// Where a wall is that answers to force, from where it was placed, along its guide: [m], [m/s], [N], [N/m] of one that goes along a
/// direction; [rad], [rad/s], [N m], [N m/rad] of one that turns.
struct DriveState {
  double way = 0;
  double rate = 0;         ///< now
  double rate_before = 0;  ///< with which it went the last step
  double force = 0;        ///< of its contacts on it, now
  double stiffness = 0;    ///< of its contacts, now
  double impedance = 0;    ///< of its contacts, now: their force for a rate, pi sqrt(k m) each [N s/m] or [N m s]
  double yield = 0;        ///< rate at which what touches it gives way, the mean by stiffness, now
  double asked = 0;        ///< rate that a program has set, of one that moves by that

  bool operator==(const DriveState&) const = default;
};

/// in   step    [s]; without one the velocities before are those at the time itself
/// in   drive   of a wall that answers to force; without one it is where it was placed
WallState wall_state(const Wall& wall, double time, double step = 0, const DriveState* drive = nullptr);

/// The wall where its frame has this pose, without its motion and that of its surface; one that is not moved is given back bit for bit.
/// Fails: UsageError for a box_inside that is turned, since its faces lie along the axes.
Wall wall_standing_at(const Wall& wall, const Vec3& position, const Quat& orientation);

/// The wall as it stands when a run begins, without its motion and that of its surface. A `start` before 0 and the first rows of a table
/// move it away from where the case draws it. Fails: as wall_standing_at().
Wall wall_at_start(const Wall& wall);

}  // namespace scree
