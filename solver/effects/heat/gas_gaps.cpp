#include "solver/effects/heat/gas_gaps.hpp"

#include <omp.h>

#include <algorithm>
#include <cstddef>

#include "core/base/index.hpp"
#include "core/distance/mesh_distance.hpp"
#include "solver/features/pair_features.hpp"

namespace scree {

namespace {

/// Of a body and an analytic zone: its nearest vertex, or the centre of a ball, less its radius.
double gap_to_zone(const PairView& view) {
  const SolverShape& shape = *view.a.shape;
  double least = 1e300;
  for (std::int32_t c = 0; at(c) < shape.features.corners.size(); ++c) {
    Vec3 normal;
    least = std::min(least, zone_gap(*view.zone, view.pose.b_from_a(view.a.scale * shape.corner(c)), normal));
  }
  return least - view.a.scale * shape.rounding;
}

/// The same bits on every instruction set and after every new list: the gap enters the temperatures, and so the state.
double distance_of_ball(const PairBody& ball, const PairBody& mesh, double reach) {
  const Vec3 centre = (1 / mesh.scale) * rotate_inverse(mesh.q, ball.x - mesh.x);
  return mesh.scale * reproducible_point_distance({&mesh.shape->mesh, &mesh.shape->bvh}, centre, reach / mesh.scale);
}

double distance_of_meshes(const PairBody& a, const PairBody& b, double reach, MeshDistanceScratch& scratch, TrianglePair& nearest) {
  return a.scale * reproducible_mesh_distance({&a.shape->mesh, &a.shape->bvh}, {&b.shape->mesh, &b.shape->bvh},
                                              relative_placement(a.x, a.q, a.scale, b.x, b.q, b.scale), reach / a.scale, scratch, nearest);
}

}  // namespace

double gap_of(const PairView& view, double reach, MeshDistanceScratch& scratch, TrianglePair& nearest) {
  // (reach + margin) - margin may be below reach by rounding: what is not found within is at reach, and conducts in no list of pairs
  const double within = reach + view.margin;
  switch (view.geometry) {
    case PairGeometry::two_spheres:
      return length(view.a.x - view.b.x) - view.a.scale * view.a.shape->rounding - view.b.scale * view.b.shape->rounding - view.margin;
    case PairGeometry::body_zone:
      return gap_to_zone(view) - view.margin;
    case PairGeometry::sphere_mesh: {
      const bool a_is_ball = view.a.shape->kind == ShapeKind::sphere;
      const PairBody &ball = a_is_ball ? view.a : view.b, &mesh = a_is_ball ? view.b : view.a;
      const double radius = ball.scale * ball.shape->rounding;
      const double distance = distance_of_ball(ball, mesh, within + radius);
      return distance < within + radius ? distance - radius - view.margin : reach;
    }
    case PairGeometry::two_meshes: {
      const double distance = distance_of_meshes(view.a, view.b, within, scratch, nearest);
      return distance < within ? distance - view.margin : reach;
    }
  }
  return reach;
}

GasGaps::GasGaps(const Scene& scene) : conductance_(scene), range_(scene.settings.heat->gas_range) {
  for (int thread = 0; thread < omp_get_max_threads(); ++thread) scratch_.push_back(make_mesh_distance_scratch());
}

void GasGaps::find(const StepParts& parts) {
  RunState& s = parts.state;
  gaps_.clear();
  for (const NearPair& pair :
       find_near_pairs(s.scene, s.particles, s.walls, s.scene.contact_range() + 0.5 * range_, parts.skin, grid_, s.times)) {
    if (pair.b < 0) {
      const Wall& wall = s.scene.source().walls[at(s.scene.zones()[at(pair.key.zone)].wall)];
      if (wall.heat.kind == WallHeatKind::adiabatic) continue;
    }
    gaps_.push_back({.pair = pair});
  }
}

void GasGaps::measure(const RunState& s) {
  const ParticleSet& p = s.particles;
  while (scratch_.size() < static_cast<std::size_t>(omp_get_max_threads())) scratch_.push_back(make_mesh_distance_scratch());
#pragma omp parallel for schedule(dynamic, 64)
  for (std::size_t k = 0; k < gaps_.size(); ++k) {
    Gap& gap = gaps_[k];
    const auto a = at(gap.pair.a);
    const PairView view = view_of(s.scene, p, s.walls, gap.pair.a, gap.pair.b, gap.pair.key.zone);
    const double distance = gap_of(view, range_, *scratch_[static_cast<std::size_t>(omp_get_thread_num())], gap.nearest);
    const bool is_wall = gap.pair.b < 0;
    const std::int32_t material_b = is_wall ? s.scene.source().walls[at(view.zone->wall)].material : p.material[at(gap.pair.b)];
    gap.conductance = conductance_.of(view, distance, p.material[a], material_b, p.equivalent_radius[a],
                                      is_wall ? 0.0 : p.equivalent_radius[at(gap.pair.b)]);
  }
}

}  // namespace scree
