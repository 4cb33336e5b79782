#include "solver/features/pair_view.hpp"

#include <algorithm>

#include "solver/built_with.hpp"

namespace scree {

namespace {

PairGeometry geometry_of(const PairView& view) {
  if (view.zone != nullptr && (!built_with::kMeshes || view.zone->kind != WallZone::Kind::mesh)) return PairGeometry::body_zone;
  if constexpr (!built_with::kMeshes) return PairGeometry::two_spheres;
  const bool a_is_sphere = view.a.shape->kind == ShapeKind::sphere, b_is_sphere = view.b.shape->kind == ShapeKind::sphere;
  if (a_is_sphere != b_is_sphere) return PairGeometry::sphere_mesh;
  return a_is_sphere ? PairGeometry::two_spheres : PairGeometry::two_meshes;
}

void view_row(const SolverScene& scene, const ParticleSet& p, std::size_t i, PairBody& body, double& radius) {
  body.shape = &scene.shape(p.shape[i]);
  body.scale = p.scale[i];
  body.x = p.x[i];
  body.q = p.q[i];
  body.weights = p.weights[i];
  body.cluster_scale = 1;
  radius = p.radius[i];
}

void view_body(const SolverScene& scene, const ParticleSet& p, std::size_t i, std::size_t j, PairView& view) {
  view_row(scene, p, j, view.b, view.radius_b);
  if (p.cell.periodicity().any()) view.b.x = p.x[i] + p.cell.periodicity().nearest(p.x[j] - p.x[i]);
  const double cells_a = view.a.scale * view.a.shape->cell_size, cells_b = view.b.scale * view.b.shape->cell_size;
  view.cell_size = std::max(cells_a, cells_b);
  if (view.cell_size > 0) view.cells = cells_a > cells_b ? CellSide::a : cells_b > cells_a ? CellSide::b : CellSide::both;
}

void view_wall(const SolverScene& scene, const std::vector<WallState>& walls, std::int32_t zone, PairView& view) {
  view.zone = &scene.zones()[static_cast<std::size_t>(zone)];
  const Wall& wall = scene.source().walls[static_cast<std::size_t>(view.zone->wall)];
  const WallState& state = walls[static_cast<std::size_t>(view.zone->wall)];
  view.b.x = state.position;
  view.b.q = state.orientation;
  view.radius_b = 2 * view.radius_a;  // the wall is the frame of the pair's motion
  const double wall_cells = view.zone->kind == WallZone::Kind::mesh ? wall.cell_size : 0.0,
               own_cells = view.a.scale * view.a.shape->cell_size;
  view.cell_size = std::max(own_cells, wall_cells);
  if (view.cell_size > 0) view.cells = own_cells > wall_cells ? CellSide::a : CellSide::b;
  if (view.zone->kind == WallZone::Kind::mesh) {
    view.b.shape = &scene.wall_shape(view.zone->wall);
    view.b.scale = wall.scale;
    view.b.weights = scene.wall_weights(view.zone->wall);
    view.radius_b = std::max(view.radius_b, wall.scale * view.b.shape->radius);
  }
}

/// Margins that go with the size of bodies. An analytic wall is moved back by the margin of the body that it meets, and carries it: touch
/// begins where it was drawn, and there is as much room as between two bodies.
void view_own_margins(const SolverScene& scene, PairView& view) {
  const double of_a = view.a.scale * view.a.shape->margin;
  const bool has_other = view.b.shape != nullptr;
  const double of_b = has_other ? view.b.scale * view.b.shape->margin : 0;
  view.margin = of_a + of_b;
  view.off_middle = 0.5 * (of_a - of_b);
  view.max_overlap = has_other ? view.margin : 2 * of_a;
  if (!(view.margin > 0)) {  // balls, and balls on walls: no deeper than their centres
    view.max_overlap = view.a.scale * view.a.shape->equivalent_radius;
    if (has_other && view.b.shape->equivalent_radius > 0)
      view.max_overlap = std::min(view.max_overlap, view.b.scale * view.b.shape->equivalent_radius);
    return;
  }
  // Crowds of both are told for one depth, whichever is A: that of an edge pair, a mean of weights, does not go with it in proportion
  const double depth_a = of_a > 0 ? of_a : of_b, depth_b = of_b > 0 ? of_b : scene.wall_table_depth();
  view.cluster_depth = of_a > 0 && of_b > 0 ? 0.5 * (of_a + of_b) : depth_a;
  if (view.a.weights != nullptr) view.a.cluster_scale = view.cluster_depth / depth_a;
  if (has_other && view.b.weights != nullptr) view.b.cluster_scale = view.cluster_depth / depth_b;
}

/// What does not depend on the pose, of bodies that are known.
void view_margins(const SolverScene& scene, PairView& view) {
  if (scene.margins_by_size()) {
    view_own_margins(scene, view);
  } else {
    view.margin = view.max_overlap = 2 * scene.margin();
    view.cluster_depth = scene.margin();
  }
  view.reach = view.margin + scene.reach();
  view.weights_follow_overlap = scene.weights_follow_overlap() && view.cells == CellSide::none;
}

}  // namespace

BallContactRows find_ball_contact(const LaneLaws& laws, const ParticleSet& p, std::int32_t a, std::int32_t b, std::int32_t zone) {
  BallContactRows found;
  const auto i = static_cast<std::size_t>(a);
  if (laws.kind == LaneLawKind::none || !(p.ball_radius[i] > 0)) return found;
  std::int32_t other = 0;
  if (b >= 0) {
    const auto j = static_cast<std::size_t>(b);
    if (!(p.ball_radius[j] > 0)) return found;
    other = p.material[j];
  } else {
    found.wall = laws.row_of_zone[static_cast<std::size_t>(zone)];
    if (found.wall < 0) return found;
    other = laws.zones[static_cast<std::size_t>(found.wall)].material;
  }
  found.law = laws.row(p.material[i], other);
  found.is_one = laws.holds[found.law] != 0;
  return found;
}

PairView view_of(const SolverScene& scene, const ParticleSet& p, const std::vector<WallState>& walls, std::int32_t a, std::int32_t b,
                 std::int32_t zone) {
  PairView view;
  const auto i = static_cast<std::size_t>(a);
  view_row(scene, p, i, view.a, view.radius_a);
  if (b >= 0)
    view_body(scene, p, i, static_cast<std::size_t>(b), view);
  else
    view_wall(scene, walls, zone, view);
  if (is_ball_contact(scene, p, a, b, zone)) {
    view.a.q = {};
    if (b >= 0) view.b.q = {};
  }
  view.geometry = geometry_of(view);
  view_margins(scene, view);
  view.pose = RelativePose(view.a, view.b);
  return view;
}

void view_two_meshes(const SolverScene& scene, const ParticleSet& p, std::int32_t a, std::int32_t b, const RelativePose& pose,
                     PairView& view) {
  const auto i = static_cast<std::size_t>(a), j = static_cast<std::size_t>(b);
  view_row(scene, p, i, view.a, view.radius_a);
  view.off_middle = view.cell_size = view.cluster_depth = 0;
  view.zone = nullptr;
  view.cells = CellSide::none;
  view_body(scene, p, i, j, view);
  view.geometry = PairGeometry::two_meshes;
  view_margins(scene, view);
  view.pose = pose;
}

PullView pull_view_of(const SolverScene& scene, const ParticleSet& p, std::int32_t a, std::int32_t b, const PairView& view, double range) {
  PullView pull{range, scene.pull_table_depth(), view.a, view.b};
  pull.a.weights = pull.b.weights = nullptr;
  pull.a.cluster_scale = pull.b.cluster_scale = 1;              // all its tables are made for one depth
  if (view.geometry == PairGeometry::sphere_mesh) return pull;  // one contact for each minimum of the distance: they are no cluster
  pull.a.weights = p.pull_weights[static_cast<std::size_t>(a)];
  pull.b.weights = b >= 0 ? p.pull_weights[static_cast<std::size_t>(b)] : scene.wall_pull_weights(view.zone->wall);
  return pull;
}

namespace {

[[gnu::noinline]] void see_bonded(const ParticleSet& p, std::size_t a, std::int32_t b, PairMotion& m) {
  const BondedMass *of_a = p.bonded[a], *of_b = b >= 0 ? p.bonded[static_cast<std::size_t>(b)] : nullptr;
  // pieces of one fragment move with respect to each other, not as a whole
  if (of_a != nullptr && of_b != nullptr && of_a->fragment == of_b->fragment) return;
  m.bonded_a = of_a;
  m.bonded_b = of_b;
}

}  // namespace

Vec3 spin_of_normal(const PairMotion& m, const Vec3& n) {
  if (m.ball_a != m.ball_b) return m.ball_a ? m.w_b : m.w_a;  // it is that of the other surface
  const double distance = length(m.centre_b);
  return distance > 0 ? (1 / distance) * cross(n, m.v_a - m.v_b) : Vec3{};
}

PairMotion motion_of(const ParticleSet& p, std::int32_t a, std::int32_t b, const PairView& view, const PairVelocities& world,
                     const Mat3& a_to_world) {
  PairMotion m;
  m.v_a = transpose_times(a_to_world, world.v_a);
  m.w_a = transpose_times(a_to_world, world.w_a);
  m.v_b = transpose_times(a_to_world, world.v_b);
  m.w_b = transpose_times(a_to_world, world.w_b);
  m.centre_b = m.pivot_b = view.pose.centre;
  m.pivot_v_b = m.v_b;
  if (!(world.pivot_b == view.b.x)) {
    m.pivot_b = rotate_inverse(view.a.q, world.pivot_b - view.a.x);
    m.pivot_v_b = transpose_times(a_to_world, world.pivot_v_b);
  }
  m.b_to_a = view.pose.rotation;
  m.turn = view.pose.turn;
  const auto i = static_cast<std::size_t>(a);
  m.inverse_mass_a = p.inverse_mass[i];
  m.inverse_inertia_a = p.inverse_inertia[i];
  m.inverse_mass_b = 0;
  if (b >= 0) {
    const auto j = static_cast<std::size_t>(b);
    m.inverse_mass_b = p.inverse_mass[j];
    m.inverse_inertia_b = p.inverse_inertia[j];
  }
  if (!p.bonded.empty()) see_bonded(p, i, b, m);
  m.ball_a = p.ball_radius[i] > 0;
  m.ball_b = b >= 0 && p.ball_radius[static_cast<std::size_t>(b)] > 0;
  return m;
}

SurfaceBeneath surface_beneath(const WallState& wall, const PairView& view, const Mat3& a_to_world, bool in_step) {
  const SurfaceVelocity& at_wall = in_step ? wall.surface_before : wall.surface;
  const Vec3 here = at_wall.at(view.a.x - wall.position);
  return {{transpose_times(a_to_world, here), transpose_times(a_to_world, at_wall.spin)}, wall.surface_turned};
}

double contact_radius(const PairView& view) {
  const double a = view.a.scale * view.a.shape->equivalent_radius;
  if (view.zone == nullptr) {
    const double b = view.b.scale * view.b.shape->equivalent_radius;
    return a * b / (a + b);
  }
  return view.zone->kind == WallZone::Kind::sphere && view.zone->radius > a ? a * view.zone->radius / (view.zone->radius - a) : a;
}

}  // namespace scree
