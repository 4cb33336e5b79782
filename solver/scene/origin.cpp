#include "solver/scene/origin.hpp"

#include <algorithm>
#include <cmath>

#include "core/geometry/triangle_mesh.hpp"

namespace scree {

Vec3 choose_origin(const Scene& scene) {
  const BodyTable& bodies = scene.bodies;
  if (bodies.size() == 0) return {};
  Box3 box;
  double largest = 0;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    box.add(bodies.position[b]);
    const Shape& shape = scene.shapes[static_cast<std::size_t>(bodies.shape[b])];
    largest = std::max(largest, bodies.scale[b] * (bounding_radius(shape.mesh) + shape.sphere_radius));
  }
  const double extent = length(box.extent()) + 2 * largest;
  constexpr double kFar = 1000;  // extents: closer in, twelve digits of a body's place are left
  const Vec3 centre = box.centre();
  if (!(length(centre) > kFar * extent) || !std::isfinite(length(centre))) return {};
  const double unit = std::exp2(std::floor(std::log2(extent)));
  return {unit * std::round(centre.x / unit), unit * std::round(centre.y / unit), unit * std::round(centre.z / unit)};
}

namespace {

void move_place(Wall& wall, const Vec3& origin) {
  for (Vec3* place : {&wall.point, &wall.lower, &wall.upper, &wall.axis_start, &wall.axis_end}) *place -= origin;
  if (wall.kind == WallKind::mesh) wall.position -= origin;
}

}  // namespace

void move_scene(Scene& scene, const Vec3& origin) {
  if (origin == Vec3{}) return;
  for (Vec3& x : scene.bodies.position) x -= origin;
  for (Wall& wall : scene.walls) {
    move_place(wall, origin);
    wall.motion.move_origin(origin);
    wall.surface.motion.move_origin(origin);
  }
  for (Inlet& inlet : scene.inlets) move_place(inlet.region, origin);
  for (Outlet& outlet : scene.outlets) move_place(outlet.region, origin);
  scene.settings.domain.lower -= origin;
  scene.settings.domain.upper -= origin;
  for (std::vector<Vec3>* sides : {&scene.partition.lower, &scene.partition.upper}) {
    for (Vec3& side : *sides) side -= origin;
  }
}

Vec3 wall_position_in_world(const Wall& wall, const WallState& state, const Vec3& origin) {
  if (origin == Vec3{}) return state.position;
  // The points of an analytic wall were moved in its own frame, those of a mesh were not.
  return wall.kind == WallKind::mesh ? state.position + origin : state.position + origin - rotate(state.orientation, origin);
}

}  // namespace scree
