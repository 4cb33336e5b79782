#include "decomposer/cut/predicted_work.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/long_work.hpp"
#include "core/geometry/features.hpp"
#include "core/placing/placed_body.hpp"
#include "core/search/multilevel_grid.hpp"
#include "core/storage/plasticity.hpp"
#include "core/storage/wall_state.hpp"
#include "core/surface/touch_surface.hpp"

namespace scree {

namespace {

// In motions of a body whose moments of inertia differ, what each body costs a step besides included: some 65 ns on one core (Zen 4,
// AVX-512) since motions are computed in lanes, in processor time of 1000 to 1600 bodies. Fitted so that the measured imbalance of the
// scenes of tests/decomposer/imbalance_test.py is that of the prediction: a lattice of cubes gives those of cubes and of listed pairs, a
// dense bed that of pairs that touch.
constexpr double kMotion = 1.0;
constexpr double kEvenMotion = 0.5, kStraightMotion = 0.4;  // equal moments need no rotor, and less as long as nothing turns them
constexpr double kFixedMotion = 0.2;                        // never integrated
constexpr double kListedPair = 0.16;                        // a pair in the list that cannot touch yet is compared and added up
constexpr double kPair = 1.8, kPerSeenFeature = 0.1;        // a pair that touches, and the features that it looks at
// A pair that does not touch rests until its bodies have gone what they lack, is looked at then, and rests again.
constexpr double kLook = 1.1, kRarelyLooked = 0.01;  // below that share of the steps it does not count
constexpr double kFirstSteps = 240;                  // that are predicted
constexpr double kEqualMoments = 1e-12;              // relative, as in the solver

bool has_equal_moments(const Shape& shape) {
  if (shape.kind == ShapeKind::sphere) return true;
  const Vec3& m = shape.mass.principal_moments;
  const auto [low, high] = std::minmax({m.x, m.y, m.z});
  return high - low <= kEqualMoments * high;
}

/// About the step that the solver will take [s]: contacts of the lightest body by the stiffest pair. 0 where a law has no stiffness.
double about_step(const Scene& scene, const std::vector<PackShape>& shapes) {
  if (scene.settings.step > 0) return scene.settings.step;
  double lightest = 1e300, smallest = 0, stiffest = 0;
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    const double scale = scene.bodies.scale[i], density = scene.materials[static_cast<std::size_t>(scene.bodies.material[i])].density;
    const double mass = density * shapes[static_cast<std::size_t>(scene.bodies.shape[i])].shape.mass.volume * scale * scale * scale;
    if (scene.bodies.fixed[i] != 0 || !(mass < lightest)) continue;
    lightest = mass;
    smallest = std::cbrt(mass / density * 3 / (4 * std::numbers::pi));
  }
  for (const MaterialPair& pair : scene.pairs) stiffest = std::max(stiffest, steepening(pair) * pair.spring(0.5 * smallest));
  return stiffest > 0 && lightest < 1e300 ? std::numbers::pi * std::sqrt(0.5 * lightest / stiffest) / scene.settings.steps_per_contact : 0;
}

}  // namespace

PredictedWork predicted_work(const Scene& scene) {
  const BodyTable& bodies = scene.bodies;
  const double margin = common_margin(scene.settings);
  std::vector<PackShape> shapes;
  std::vector<double> seen;  // cost of the features that a contact of the shape looks at
  for (const Shape& shape : scene.shapes) {
    shapes.push_back(make_pack_shape(shape, scene.settings));
    const FeatureTable features = find_features(shape.mesh);
    seen.push_back(kPerSeenFeature * std::sqrt(static_cast<double>(features.corners.size() + features.edges.size())));
  }
  PredictedWork work;
  work.of_body.assign(bodies.size(), 0.0);
  std::vector<double> reach;
  std::vector<PlacedBody> placed;
  std::vector<std::uint8_t> turns;
  std::vector<double> way;  // in one of the first steps, on average [m]
  const double step = about_step(scene, shapes), fall = 0.5 * kFirstSteps * step * length(scene.settings.gravity);
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    placed.push_back({&shapes[static_cast<std::size_t>(bodies.shape[i])], bodies.scale[i], bodies.position[i], bodies.orientation[i]});
    reach.push_back(placed[i].radius() + margin);
    const double spin = length(bodies.angular_velocity[i]);
    turns.push_back(spin > 0 ? 1 : 0);
    way.push_back(bodies.fixed[i] != 0 ? 0 : step * (length(bodies.velocity[i]) + placed[i].radius() * spin + fall));
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
      const double contact = 2 * margin + kTouch * (placed[i].radius() + other.radius());
      const double ways = way[i] + way[j], farthest = contact + ways / kRarelyLooked;
      const double gap = gap_between(placed[i], other, farthest, *scratch);
      double pair = kListedPair;
      if (gap < contact) {
        pair += kPair + seen[static_cast<std::size_t>(bodies.shape[i])] + seen[static_cast<std::size_t>(bodies.shape[j])];
        turns[i] = turns[j] = 1;
      } else if (gap < farthest) {
        pair += kLook * std::min(1.0, ways / (gap - contact));
      }
      work.of_body[i] += 0.5 * pair;
      work.of_body[j] += 0.5 * pair;
      work.pairs.push_back({a, b, pair});
    });
  }
  std::vector<Vec3> vertices;
  std::vector<Wall> walls;
  for (const Wall& wall : scene.walls) walls.push_back(wall_at_start(wall));
  LongWork progress("work of the bodies", static_cast<double>(bodies.size()));
  for (std::size_t i = 0; i < bodies.size() && !walls.empty(); ++i) {
    progress.advance();
    if (bodies.fixed[i] != 0) continue;
    placed[i].world_vertices(vertices);
    const double contact = 2 * margin + kTouch * placed[i].radius();
    for (const Wall& wall : walls) {
      PlacedBody mesh;
      if (wall.kind == WallKind::mesh) mesh = {&shapes[static_cast<std::size_t>(wall.shape)], wall.scale, wall.position, wall.orientation};
      const auto is_within = [&](double gap) { return !wall_allows(wall, &mesh, false, placed[i], vertices, gap, *scratch); };
      if (is_within(contact)) {
        work.of_body[i] += kPair + seen[static_cast<std::size_t>(bodies.shape[i])];
        turns[i] = 1;
      } else if (is_within(contact + kFirstSteps * way[i])) {
        // once it has gone what it lacks, it is looked at in every step: on average in half of them
        work.of_body[i] += 0.5 * kLook;
      }
    }
  }
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const bool rotor = bodies.lock_rotation[i] == 0 && !has_equal_moments(placed[i].shape->shape);
    const bool straight = bodies.lock_rotation[i] != 0 || turns[i] == 0;
    work.of_body[i] += bodies.fixed[i] != 0 ? kFixedMotion : rotor ? kMotion : straight ? kStraightMotion : kEvenMotion;
  }
  return work;
}

void partition_scene(Scene& scene, const PredictedWork& work, int ranks, CutMethod method) {
  if (scene.bodies.size() == 0) {  // all come in later: the solver cuts when they are there
    scene.partition = {};
    return;
  }
  Partitioner partitioner(MPI_COMM_SELF, ranks, method);
  const CutBoxes boxes = partitioner.cut(scene.bodies.id, scene.bodies.position, work.of_body);
  std::vector<double> per_rank(static_cast<std::size_t>(ranks), 0.0);
  scene.bodies.owner.clear();
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    const int owner = partitioner.part_of(scene.bodies.id[i], scene.bodies.position[i]);
    scene.bodies.owner.push_back(owner);
    per_rank[static_cast<std::size_t>(owner)] += work.of_body[i];
  }
  // both owners compute a pair across ranks, and each body bears half of it already
  for (const PairWork& pair : work.pairs) {
    const std::int32_t one = scene.bodies.owner[static_cast<std::size_t>(pair.a)],
                       other = scene.bodies.owner[static_cast<std::size_t>(pair.b)];
    if (one == other) continue;
    per_rank[static_cast<std::size_t>(one)] += 0.5 * pair.work;
    per_rank[static_cast<std::size_t>(other)] += 0.5 * pair.work;
  }
  scene.partition.ranks = ranks;
  scene.partition.method = cut_method_name(boxes.lower.empty() ? method : CutMethod::rcb);
  scene.partition.lower = boxes.lower;
  scene.partition.upper = boxes.upper;
  scene.partition.predicted_imbalance = imbalance(per_rank);
}

}  // namespace scree
