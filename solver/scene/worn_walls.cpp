// Walls whose mesh recedes while a run goes on: part of solver_scene.hpp.
#include "core/base/error.hpp"
#include "solver/scene/solver_scene.hpp"

namespace scree {

void SolverScene::set_wall_vertices(std::int32_t of, const std::vector<Vec3>& vertices) const {
  const auto w = static_cast<std::size_t>(of);
  const Wall& wall = scene_->walls[w];
  Shape worn = scene_->shapes[static_cast<std::size_t>(wall.shape)];
  SCREE_ASSERT(wall.wear > 0 && vertices.size() == worn.mesh.vertices.size(), "wall {} does not wear so", of);
  worn.mesh.vertices = vertices;
  auto as_now = std::make_unique<WornWall>();
  as_now->shape = make_solver_shape(worn);
  const auto make = [&](const std::shared_ptr<DensityWeights>& of_scene, std::vector<double>& weights) -> const double* {
    if (of_scene) weights = of_scene->of_worn_wall(as_now->shape, wall.scale, wall_weight_radius());
    return weights.empty() ? nullptr : weights.data();
  };
  wall_weights_[w] = make(weights_, as_now->weights);
  wall_pull_weights_[w] = make(pull_weights_, as_now->pull_weights);
  wall_shapes_[w] = &as_now->shape;
  worn_walls_[w] = std::move(as_now);
}

}  // namespace scree
