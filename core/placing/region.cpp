#include "core/placing/region.hpp"

#include <algorithm>

#include "core/base/error.hpp"
#include "core/base/numbers.hpp"

namespace scree {

bool Region::holds(const PlacedBody& body, const std::vector<Vec3>& vertices, double gap, MeshDistanceScratch& scratch) const {
  if (!is_mesh()) return wall_allows(shape, nullptr, false, body, vertices, gap, scratch);
  if (!is_inside(mesh.shape.mesh, vertices.front())) return false;
  const PlacedBody hull{&mesh, 1, {}, {}};
  // a gap of zero cannot be told from an intersection
  constexpr double kApart = 1e-6;  // of the body's radius
  const double least = std::max(gap, kApart * body.radius());
  return gap_between(hull, body, least * kJustAbove, scratch) >= least;
}

bool Region::contains(const Vec3& p) const {
  for (int k = 0; k < 3; ++k) {
    if (!(p[k] >= box.lower[k] && p[k] <= box.upper[k])) return false;
  }
  if (is_box()) return true;
  if (is_mesh()) return is_inside(mesh.shape.mesh, p);
  if (shape.kind == WallKind::sphere_inside) return length(p - shape.point) <= shape.radius;
  const Vec3 axis = normalised(shape.axis_end - shape.axis_start);
  const double z = dot(axis, p - shape.axis_start);
  return z >= 0 && z <= length(shape.axis_end - shape.axis_start) && length(p - shape.axis_start - z * axis) <= shape.radius;
}

Region region_of(const RegionShape& region, const std::vector<Shape>& shapes, const std::string& whose) {
  if (region.kind != WallKind::mesh) return region_of(region);
  TriangleMesh mesh = shapes[static_cast<std::size_t>(region.shape)].mesh;
  for (Vec3& p : mesh.vertices) p = region.position + region.scale * rotate(region.orientation, p);
  try {
    return region_of(std::move(mesh));
  } catch (const InputError& e) {
    throw InputError("{}: {}", whose, e.what());
  }
}

bool draw_place(const Region& region, const BodyOrientation& asked, const RandomNumbers& random, PlacedBody& body) {
  constexpr std::uint64_t kOrientation = 0, kPlace = 3;  // which of the random numbers is what
  body.orientation = draw_orientation(asked, body.shape->shape, random, kOrientation);
  body.position = {};
  const Box3 extent = body.world_box();
  Vec3 place;
  for (int k = 0; k < 3; ++k) {
    const double low = region.box.lower[k] - extent.lower[k], high = region.box.upper[k] - extent.upper[k];
    if (low > high) return false;
    place[k] = low + random.uniform(kPlace + static_cast<std::uint64_t>(k)) * (high - low);
  }
  body.position = place;
  return true;
}

Region region_of(const Wall& wall) {
  Region region;
  region.shape = wall;
  if (wall.kind == WallKind::box_inside) {
    region.box = {wall.lower, wall.upper};
    const Vec3 e = region.box.extent();
    region.volume = e.x * e.y * e.z;
  } else if (wall.kind == WallKind::cylinder_inside) {
    const double height = length(wall.axis_end - wall.axis_start);
    const Vec3 axis = normalised(wall.axis_end - wall.axis_start);
    Vec3 reach;
    for (int k = 0; k < 3; ++k) reach[k] = wall.radius * std::sqrt(std::max(0.0, 1 - axis[k] * axis[k]));
    for (const Vec3& end : {wall.axis_start, wall.axis_end}) {
      region.box.add(end - reach);
      region.box.add(end + reach);
    }
    region.volume = kPi * wall.radius * wall.radius * height;
  } else {
    SCREE_ASSERT(wall.kind == WallKind::sphere_inside, "wall kind {}", static_cast<int>(wall.kind));
    const Vec3 reach{wall.radius, wall.radius, wall.radius};
    region.box = {wall.point - reach, wall.point + reach};
    region.volume = 4.0 / 3.0 * kPi * wall.radius * wall.radius * wall.radius;
  }
  return region;
}

Region region_of(TriangleMesh mesh) {
  Region region;
  region.shape.kind = WallKind::mesh;
  region.volume = mass_properties(mesh).volume;
  if (!(region.volume > 0)) throw InputError("cannot be a region; expected one closed mesh with outward triangles");
  region.box = bounding_box(mesh);
  region.mesh.bvh = build_bvh(mesh);
  region.mesh.radius = bounding_radius(mesh);
  region.mesh.shape = make_surface("region", std::move(mesh));
  return region;
}

}  // namespace scree
