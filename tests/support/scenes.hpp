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

inline std::size_t add_body(Scene& scene, std::int32_t shape, const Vec3& position, const Quat& orientation = {}, const Vec3& velocity = {},
                            const Vec3& spin = {}, double scale = 1) {
  const std::size_t index = scene.bodies.size();
  scene.bodies.add({static_cast<std::int64_t>(index + scene.walls.size()), shape, 0, scale, position, orientation, velocity, spin});
  return index;
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
