#include "decomposer/tile_scene.hpp"

#include <algorithm>

#include "core/base/error.hpp"

namespace scree {

Scene tile_scene(const Scene& scene, const FrameBodies& frame, const std::array<int, 3>& copies) {
  constexpr double kMostBodies = 1e9;  // 2 TB in memory
  const double bodies = static_cast<double>(std::max(frame.size(), scene.bodies.size())) * copies[0] * copies[1] * copies[2];
  if (bodies > kMostBodies)
    throw UsageError("--copies {},{},{}: {:.3g} bodies would be made, at most {:g} can be", copies[0], copies[1], copies[2], bodies,
                     kMostBodies);
  if (scene.walls.size() != 1 || scene.walls[0].kind != WallKind::box_inside) {
    throw UsageError("tile: the scene has {} walls; expected one, box_inside, whose inside is the tile", scene.walls.size());
  }
  if (scene.walls[0].motion.is_prescribed() || scene.walls[0].surface.is_given()) {
    throw UsageError("tile: the wall '{}' moves, and its motion would not fit a box of another size; tile a scene whose box does not move",
                     scene.walls[0].name);
  }
  if (frame.size() != 0 && frame.size() != scene.bodies.size()) {
    throw UsageError("tile: the frame has {} bodies, the scene {}; give a frame of a run of this scene", frame.size(), scene.bodies.size());
  }
  if (!scene.inlets.empty() || !scene.outlets.empty()) {
    throw UsageError("tile: the scene has {} inlets and {} outlets, which belong to one place; tile a scene without", scene.inlets.size(),
                     scene.outlets.size());
  }
  if (!scene.bonds.empty() || !scene.forces.empty()) {
    throw UsageError("tile: the scene has {} bonds and {} forces on bodies, which would not be repeated; tile a scene without",
                     scene.bonds.size(), scene.forces.size());
  }
  Scene result = scene;
  result.partition = {};
  Wall& box = result.walls[0];
  const Vec3 width = box.upper - box.lower;
  for (int k = 0; k < 3; ++k) {
    const double grown = (copies[static_cast<std::size_t>(k)] - 1) * width[k];
    box.upper[k] += grown;
    result.settings.domain.upper[k] += grown;
  }
  if (result.walls.front().heat.kind == WallHeatKind::flux) {
    throw UsageError("tile: the wall '{}' has a heat_flux, a power that more bodies would share; tile a scene with temperature or exchange",
                     result.walls.front().name);
  }
  // where each body of the scene is now
  BodyTable tile = scene.bodies;
  tile.owner.clear();
  for (std::size_t i = 0; i < frame.size(); ++i) {
    if (frame.id[i] != tile.id[i])
      throw UsageError("tile: the frame has body {} where the scene has {}; give a frame of a run of this scene", frame.id[i], tile.id[i]);
    if (frame.shape[i] != tile.shape[i]) throw UsageError("tile: body {} has another shape in the frame than in the scene", frame.id[i]);
    tile.position[i] = frame.position[i];
    tile.orientation[i] = frame.orientation[i];
    tile.velocity[i] = frame.velocity[i];
    tile.angular_velocity[i] = frame.angular_velocity[i];
    if (frame.has_temperature && scene.settings.heat) tile.temperature[i] = frame.temperature[i];
  }
  box.id = 0;
  BodyTable& all = result.bodies;
  all = {};
  for (int z = 0; z < copies[2]; ++z)
    for (int y = 0; y < copies[1]; ++y)
      for (int x = 0; x < copies[0]; ++x) {
        const Vec3 shift{x * width.x, y * width.y, z * width.z};
        for (std::size_t i = 0; i < tile.size(); ++i) {
          BodyRow row = tile.row(i);
          row.id = static_cast<std::int64_t>(all.size()) + 1;
          row.position += shift;
          all.add(row);
        }
      }
  return result;
}

}  // namespace scree
