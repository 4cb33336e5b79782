// The smooth pieces that a wall is made of, and which of them a periodic domain leaves. Decomposer and solver refuse the
// same walls and the same periods.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "core/geometry/periodic.hpp"
#include "core/storage/scene_file.hpp"

namespace scree {

/// One smooth piece of a wall; each carries its own potential with a body, so that a body in a corner rests on
/// two walls and not on one shared spring.
struct WallZone {
  enum class Kind : std::int32_t { plane, cylinder, sphere, mesh };
  std::int32_t wall = 0;  ///< index into Scene::walls
  std::int32_t zone = 0;  ///< number within its wall, part of the contact key
  Kind kind = Kind::plane;
  Vec3 point, direction;  ///< wall frame: plane point and unit normal; cylinder point and unit axis; sphere centre
  double radius = 0;      ///< cylinder, sphere [m]
};

/// The zones of all walls, in their order. Walls are not repeated along a periodic axis, so each zone must look the same all along
/// it. The faces of boxes and the lids of cylinders that lie across the axis are left out: the seam takes their place. Meshes stay
/// as they are; they must reach beyond the seam by the reach of a body.
/// out    dropped   names of what was left out
/// Fails: UsageError for a wall that changes along a periodic axis.
std::vector<WallZone> wall_zones(const std::vector<Wall>& walls, const Periodicity& periodicity, std::vector<std::string>& dropped);

/// Refuses, with UsageError, a body of which two images could be in reach of another body at once.
/// in   radius   bounding, of the body [m]     in   margin   of each body [m]     in   who   "body 3", asked
/// only for a message
void check_period(const Periodicity& periodicity, double radius, double margin, const std::function<std::string()>& who);

}  // namespace scree
