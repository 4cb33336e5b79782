#include "core/storage/wall_zones.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/error.hpp"

namespace scree {

namespace {

void add_zones(const Wall& wall, std::int32_t index, std::vector<WallZone>& zones) {
  const auto add = [&](WallZone::Kind kind, const Vec3& point, const Vec3& direction, double radius) {
    std::int32_t number = 0;
    for (const WallZone& z : zones) number += z.wall == index ? 1 : 0;
    zones.push_back({index, number, kind, point, direction, radius});
  };
  switch (wall.kind) {
    case WallKind::plane:
      add(WallZone::Kind::plane, wall.point, wall.normal, 0);
      break;
    case WallKind::box_inside:
      for (int axis = 0; axis < 3; ++axis) {
        Vec3 inward;
        inward[axis] = 1;
        add(WallZone::Kind::plane, wall.lower, inward, 0);
        add(WallZone::Kind::plane, wall.upper, -inward, 0);
      }
      break;
    case WallKind::cylinder_inside: {
      const Vec3 axis = normalised(wall.axis_end - wall.axis_start);
      add(WallZone::Kind::cylinder, wall.axis_start, axis, wall.radius);
      add(WallZone::Kind::plane, wall.axis_start, axis, 0);
      add(WallZone::Kind::plane, wall.axis_end, -axis, 0);
      break;
    }
    case WallKind::sphere_inside:
      add(WallZone::Kind::sphere, wall.point, {}, wall.radius);
      break;
    case WallKind::mesh:
      add(WallZone::Kind::mesh, {}, {}, 0);
      break;
  }
}

void fit_zones_to_period(const Periodicity& periodicity, const Wall& wall, std::int32_t index, std::vector<WallZone>& zones,
                         std::vector<std::string>& dropped) {
  if (!periodicity.any() || wall.kind == WallKind::mesh) return;
  constexpr double kAligned = 1e-12;  // of a unit vector: rounding of the case file
  const auto refuse = [&](int axis) {
    throw UsageError("wall {} ('{}') changes along the periodic axis {}; use walls that are the same all along it, or a mesh", wall.id,
                     wall.name, "xyz"[axis]);
  };
  const std::optional<TurnAxis> turning = wall.motion.turn_axis(), surface_turning = wall.surface.motion.turn_axis();
  for (int axis = 0; axis < 3; ++axis) {
    if (!periodicity.is_periodic(axis)) continue;
    Vec3 along;
    along[axis] = 1;
    if (turning && length(cross(turning->direction, along)) > kAligned) refuse(axis);
    if (surface_turning && length(cross(surface_turning->direction, along)) > kAligned) refuse(axis);
    std::erase_if(zones, [&](const WallZone& zone) {
      if (zone.wall != index) return false;
      if (zone.kind == WallZone::Kind::sphere) refuse(axis);
      const double across = std::abs(dot(zone.direction, along));
      if (zone.kind == WallZone::Kind::cylinder) {
        if (1 - across > kAligned) refuse(axis);
        return false;
      }
      if (across <= kAligned) return false;
      if (wall.kind == WallKind::plane || 1 - across > kAligned) refuse(axis);
      dropped.push_back(fmt::format("wall {} ('{}'): a plane across {}", wall.id, wall.name, "xyz"[axis]));
      return true;
    });
  }
}

}  // namespace

std::vector<WallZone> wall_zones(const std::vector<Wall>& walls, const Periodicity& periodicity, std::vector<std::string>& dropped) {
  std::vector<WallZone> zones;
  for (std::size_t w = 0; w < walls.size(); ++w) {
    add_zones(walls[w], static_cast<std::int32_t>(w), zones);
    fit_zones_to_period(periodicity, walls[w], static_cast<std::int32_t>(w), zones, dropped);
  }
  return zones;
}

void check_period(const Periodicity& periodicity, double radius, double margin, const std::function<std::string()>& who) {
  // a quarter of a period must hold the body's reach and the smallest skin of the body lists, which is 1 % of a radius a side
  constexpr double kRoomForSkin = 1.01;
  const double needed = 4 * (kRoomForSkin * radius + margin);
  for (int axis = 0; axis < 3; ++axis) {
    if (!periodicity.is_periodic(axis) || periodicity.period()[axis] >= needed) continue;
    throw UsageError(
        "domain: the periodic axis {} is {:g} m long, but {} with a bounding radius of {:g} m needs {:g} m, two of its "
        "diameters and margins; widen the domain",
        "xyz"[axis], periodicity.period()[axis], who(), radius, needed);
  }
}

}  // namespace scree
