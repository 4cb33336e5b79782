// Where the particles that were drawn have got to, while populations are packed one after the other.
#pragma once

#include <cstdint>
#include <vector>

#include "core/storage/frame_file.hpp"
#include "decomposer/packing/scene_parts.hpp"

namespace scree {

/// One entry for each of SceneParts::draws.
struct Placements {
  std::vector<PlacedBody> body;
  std::vector<std::uint8_t> is_placed;

  explicit Placements(const SceneParts& parts);
  std::size_t count_placed(const SceneParts& parts, std::size_t population) const;
  double volume_placed(const SceneParts& parts, std::size_t population) const;
};

/// Adds placed particles to the bodies of a scene, with the speeds of their populations. Ids go on from the last one in use, without gaps,
/// one population after the other. Within one (but for a lattice, which keeps its own order) they follow a curve through space: pairs and
/// bodies lie in memory in the order of ids, and neighbours that lie near each other there take a quarter off a step of 50 000 balls.
void add_placed(const Case& c, const SceneParts& parts, const Placements& placements, Scene& scene);

/// What the solver runs while some draws move and all else is held: the scene so far, walls at rest, all placed draws.
///
/// in   moves   one flag for each draw     in   velocity, angular_velocity   one for each draw
/// out  draw_of_body   index of the draw of each body of the result, -1 for [[bodies]]
Scene stage_scene(const Case& c, const SceneParts& parts, const Scene& so_far, const Placements& placements,
                  const std::vector<std::uint8_t>& moves, const std::vector<Vec3>& velocity, const std::vector<Vec3>& angular_velocity,
                  std::vector<std::int64_t>& draw_of_body);

}  // namespace scree
