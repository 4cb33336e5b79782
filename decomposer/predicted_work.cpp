#include "decomposer/predicted_work.hpp"

#include <cmath>

#include "core/geometry/features.hpp"
#include "core/search/multilevel_grid.hpp"
#include "decomposer/placed_body.hpp"

namespace scree {

namespace {

// In motions of a body (kicks, rotation, its share of sums and bookkeeping). From dense packings of rocks of 20, 320 and 1280
// triangles (docs/performance.md): a pair that touches takes 1.8, 3.3 and 8 of them, where this gives 1.6, 3.8 and 6.9.
constexpr double kPair = 0.8, kPerSeenFeature = 0.06;
constexpr double kListedPair = 0.1;   // a pair in the list that does not touch: looked at, and added up
// A fixed body is never integrated.
constexpr double kMotion = 1.0, kFixedMotion = 0.1;

}  // namespace

std::vector<double> predicted_work(const Scene& scene) {
  const BodyTable& bodies = scene.bodies;
  std::vector<PackShape> shapes;
  std::vector<double> seen;  // features that a contact of the shape looks at
  for (const Shape& shape : scene.shapes) {
    shapes.push_back(make_pack_shape(shape));
    const FeatureTable features = find_features(shape.mesh);
    seen.push_back(kPerSeenFeature * std::sqrt(static_cast<double>(features.corners.size() + features.edges.size())));
  }
  std::vector<double> work, reach;
  std::vector<PlacedBody> placed;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    work.push_back(bodies.fixed[i] != 0 ? kFixedMotion : kMotion);
    placed.push_back({&shapes[static_cast<std::size_t>(bodies.shape[i])], bodies.scale[i], bodies.position[i], bodies.orientation[i]});
    reach.push_back(placed[i].radius() + scene.settings.margin);
  }
  const Domain& domain = scene.settings.domain;
  Vec3 period;
  for (int k = 0; k < 3; ++k) period[k] = domain.periodic[static_cast<std::size_t>(k)] ? domain.upper[k] - domain.lower[k] : 0;
  MultilevelGrid grid;
  grid.build(bodies.position, reach, period);
  const MeshDistanceScratchPtr scratch = make_mesh_distance_scratch();
  for (const std::int32_t a : grid.order()) {
    const auto i = static_cast<std::size_t>(a);
    grid.for_each_partner(a, [&](std::int32_t b, const PeriodicImage& image) {
      const auto j = static_cast<std::size_t>(b);
      if (bodies.fixed[i] != 0 && bodies.fixed[j] != 0) return;
      PlacedBody other = placed[j];
      for (int k = 0; k < 3; ++k) other.position[k] += image[static_cast<std::size_t>(k)] * period[k];
      const double contact = 2 * scene.settings.margin + kTouch * (placed[i].radius() + other.radius());
      double pair = kListedPair;
      if (gap_between(placed[i], other, contact, *scratch) < contact) {
        pair += kPair + seen[static_cast<std::size_t>(bodies.shape[i])] + seen[static_cast<std::size_t>(bodies.shape[j])];
      }
      work[i] += 0.5 * pair;
      work[j] += 0.5 * pair;
    });
  }
  return work;
}

void partition_scene(Scene& scene, const std::vector<double>& work, int ranks, CutMethod method) {
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
