#include "decomposer/predicted_work.hpp"

#include <cmath>

#include "core/geometry/features.hpp"
#include "core/partition/partition.hpp"

namespace scree {

std::vector<double> predicted_work(const Scene& scene) {
  // a fixed body is never integrated, and costs only what its neighbours ask of it
  constexpr double kMotion = 1.0, kFixedMotion = 0.1, kPerSeenFeature = 0.1;
  std::vector<double> of_shape;
  for (const Shape& shape : scene.shapes) {
    const FeatureTable features = find_features(shape.mesh);
    of_shape.push_back(kPerSeenFeature * std::sqrt(static_cast<double>(features.corners.size() + features.edges.size())));
  }
  std::vector<double> work;
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    work.push_back((scene.bodies.fixed[i] != 0 ? kFixedMotion : kMotion) + of_shape[static_cast<std::size_t>(scene.bodies.shape[i])]);
  }
  return work;
}

void partition_scene(Scene& scene, int ranks, CutMethod method) {
  const std::vector<double> work = predicted_work(scene);
  Partitioner partitioner(MPI_COMM_SELF, ranks, method);
  const CutBoxes boxes = partitioner.cut(scene.bodies.id, scene.bodies.position, work);
  std::vector<double> per_rank(static_cast<std::size_t>(ranks), 0.0);
  scene.bodies.owner.clear();
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    const int owner = partitioner.part_of(scene.bodies.id[i], scene.bodies.position[i]);
    scene.bodies.owner.push_back(owner);
    per_rank[static_cast<std::size_t>(owner)] += work[i];
  }
  scene.partition.ranks = ranks;
  scene.partition.method = cut_method_name(boxes.lower.empty() ? method : CutMethod::rcb);
  scene.partition.lower = boxes.lower;
  scene.partition.upper = boxes.upper;
  scene.partition.predicted_imbalance = imbalance(per_rank);
}

}  // namespace scree
