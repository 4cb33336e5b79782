// Scenes built in memory for tests of the solver's library.
#pragma once

#include "core/storage/scene_file.hpp"

namespace scree::test {

/// A scene with one material that meets itself, no gravity, no walls, no bodies.
inline Scene empty_scene(double stiffness, double restitution, double friction, double margin, double density = 1000) {
  Scene scene;
  scene.settings.title = "test";
  scene.settings.margin = margin;
  scene.settings.duration = 1;
  scene.settings.output_every = 1;
  scene.materials = {{"rock", density, 0, 0}};
  scene.pairs = {{0, 0, stiffness, restitution, friction, -1, 0}};
  return scene;
}

inline std::size_t add_body(Scene& scene, std::int32_t shape, const Vec3& position, const Quat& orientation = {},
                            const Vec3& velocity = {}, const Vec3& spin = {}, double scale = 1) {
  BodyTable& b = scene.bodies;
  b.id.push_back(static_cast<std::int64_t>(b.id.size() + scene.walls.size()));
  b.shape.push_back(shape);
  b.material.push_back(0);
  b.scale.push_back(scale);
  b.position.push_back(position);
  b.orientation.push_back(orientation);
  b.velocity.push_back(velocity);
  b.angular_velocity.push_back(spin);
  b.fixed.push_back(0);
  b.lock_rotation.push_back(0);
  b.population.push_back(-1);
  return b.id.size() - 1;
}

inline void add_plane(Scene& scene, const Vec3& point, const Vec3& normal) {
  Wall wall;
  wall.id = static_cast<std::int64_t>(scene.bodies.size() + scene.walls.size());
  wall.name = "plane";
  wall.kind = WallKind::plane;
  wall.point = point;
  wall.normal = normal;
  scene.walls.push_back(wall);
}

}  // namespace scree::test
