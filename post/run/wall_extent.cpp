#include "post/run/wall_extent.hpp"

namespace scree {

Region inside_of(const Wall& wall) {
  Region region;
  if (wall.kind == WallKind::box_inside) {
    region.kind = Region::Kind::box;
    region.lower = wall.lower;
    region.upper = wall.upper;
  } else if (wall.kind == WallKind::cylinder_inside) {
    region.kind = Region::Kind::cylinder;
    region.lower = wall.axis_start;
    region.upper = wall.axis_end;
    region.radius = wall.radius;
  } else {
    region.kind = Region::Kind::sphere;
    region.lower = wall.point;
    region.radius = wall.radius;
  }
  return region;
}

std::optional<Box3> wall_extent(const Wall& wall, const Scene& scene, const WallPlace& place) {
  Box3 box;
  const auto add = [&](const Vec3& p) { box.add(place.position + rotate(place.orientation, p)); };
  switch (wall.kind) {
    case WallKind::plane:
      return std::nullopt;
    case WallKind::mesh:
      for (const Vec3& p : scene.shapes.at(static_cast<std::size_t>(wall.shape)).mesh.vertices) add(wall.scale * p);
      break;
    case WallKind::box_inside:
      for (int corner = 0; corner < 8; ++corner)
        add({((corner & 1) != 0 ? wall.upper : wall.lower).x, ((corner & 2) != 0 ? wall.upper : wall.lower).y,
             ((corner & 4) != 0 ? wall.upper : wall.lower).z});
      break;
    case WallKind::cylinder_inside:
    case WallKind::sphere_inside: {
      Region region = inside_of(wall);
      region.lower = place.position + rotate(place.orientation, region.lower);
      region.upper = place.position + rotate(place.orientation, region.upper);
      box = region.bounds();
      break;
    }
  }
  return box.is_empty() ? std::nullopt : std::optional<Box3>(box);
}

}  // namespace scree
