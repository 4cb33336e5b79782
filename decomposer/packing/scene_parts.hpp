// What a case becomes before anything is placed: shapes with their trees, walls, regions, and the particles drawn.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/placing/region.hpp"
#include "decomposer/case/case_file.hpp"
#include "decomposer/packing/from_run.hpp"

namespace scree {

/// A particle that has been drawn but not placed.
struct Draw {
  std::int64_t id = 0;
  std::size_t population = 0;
  std::int32_t shape = 0;  ///< index into the case's shapes
  double scale = 1, volume = 0;
};

/// Bodies that come from a run: they are where they are, and all else is placed around them.
struct CarriedBodies {
  FromRun from;
  std::vector<PackShape> shapes;           ///< of the run; empty where not used
  std::vector<std::int32_t> scene_shape;   ///< index into Scene::shapes, -1 when unused
  std::vector<PlacedBody> placed;          ///< one for each of from.bodies
  std::vector<std::int32_t> wall_partner;  ///< of each wall of the case, see partners_of_walls()
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
  std::optional<CarriedBodies> carried;
  std::int64_t first_id = 0;  ///< of what this case adds: [[bodies]], then walls, then populations

  const PackShape& shape(std::int32_t index) const { return shapes[static_cast<std::size_t>(index)]; }
};

}  // namespace scree
