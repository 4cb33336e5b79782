// What a case becomes before anything is placed: shapes with their trees, walls, regions, and the particles drawn.
#pragma once

#include <cstdint>
#include <vector>

#include "core/placing/region.hpp"
#include "decomposer/case/case_file.hpp"

namespace scree {

/// A particle that has been drawn but not placed.
struct Draw {
  std::int64_t id = 0;
  std::size_t population = 0;
  std::int32_t shape = 0;  ///< index into the case's shapes
  double scale = 1, volume = 0;
};

struct SceneParts {
  std::vector<PackShape> shapes;          ///< one per shape of the case; empty where it is not used
  std::vector<std::int32_t> scene_shape;  ///< index into Scene::shapes, -1 when unused
  std::vector<Wall> walls;                ///< as they stand when the run begins (wall_at_start)
  std::vector<PackShape> wall_shapes;     ///< one per wall; filled for mesh walls
  std::vector<PlacedBody> wall_bodies;    ///< of mesh walls
  std::vector<bool> wall_is_solid;
  std::vector<Region> regions;  ///< one per population
  std::vector<Region> inlets, outlets;
  std::vector<Draw> draws;

  const PackShape& shape(std::int32_t index) const { return shapes[static_cast<std::size_t>(index)]; }
};

}  // namespace scree
