// Analytic sphere against mesh: part of pair_features.hpp.
//
// Each local minimum of the distance from the sphere's centre to the surface is one contact, with its weight (surface_minima.hpp).
// Minima are found by distances alone: neither the winding of the triangles nor the angle of an edge matters.
#include <algorithm>
#include <cmath>

#include "core/geometry/nearest_on_triangle.hpp"
#include "solver/features/pair_features.hpp"
#include "solver/features/surface_minima.hpp"

namespace scree {

namespace {

struct Roles {
  const PairBody* sphere;
  const PairBody* mesh;
  bool sphere_is_a;
  Roles(const PairBody& a, const PairBody& b)
      : sphere(a.shape->kind == ShapeKind::sphere ? &a : &b),
        mesh(a.shape->kind == ShapeKind::sphere ? &b : &a),
        sphere_is_a(a.shape->kind == ShapeKind::sphere) {}
  Vec3 centre_in_mesh() const { return (1 / mesh->scale) * rotate_inverse(mesh->q, sphere->x - mesh->x); }
};

/// See find_minima() [m].
double sharing_of(const Roles& roles) {
  return roles.mesh->shape->is_convex ? 0 : kSharingOfBalls * roles.sphere->scale * roles.sphere->shape->rounding;
}

}  // namespace

bool list_sphere_mesh_pair(const PairBody& a, const PairBody& b, double margin, double skin, double radius_a, double radius_b,
                           MeshDistanceScratch& scratch, CandidateLists& lists) {
  begin_lists(a, b, skin, radius_a, radius_b, lists);
  const Roles roles(a, b);
  // the centre as a mesh of one triangle that is a point: the same descent serves
  static const TriangleMesh point{{Vec3{}}, {Triangle{0, 0, 0}}};
  static const Bvh point_tree = build_bvh(point);
  const double radius = roles.sphere->scale * roles.sphere->shape->rounding;
  const SolverShape& mesh = *roles.mesh->shape;
  Placement placement;
  placement.translation = roles.centre_in_mesh();
  thread_local std::vector<TrianglePair> pairs;
  const double sharing = sharing_of(roles), reach = (radius + margin + sharing + skin) / roles.mesh->scale;
  if (triangle_pairs_within({&mesh.mesh, &mesh.bvh}, {&point, &point_tree}, placement, reach, scratch, pairs)) return false;
  for (const TrianglePair& pair : pairs) {
    const NearestOnTriangle nearest =
        nearest_on_triangle(placement.translation, mesh.mesh.corner(pair.a, 0), mesh.mesh.corner(pair.a, 1), mesh.mesh.corner(pair.a, 2));
    const double gap = roles.mesh->scale * length(placement.translation - nearest.point) - radius;
    lists.corners_a.push_back({0, pair.a, slack_below(gap, margin + sharing, std::max(radius_a, radius_b))});
  }
  end_lists(lists);
  return true;
}

void sphere_mesh_features(const PairBody& a, const PairBody& b, double margin, double motion, const CandidateLists& lists,
                          std::vector<ContactFeature>& features) {
  features.clear();
  if (lists.corners_a.empty()) return;
  const Roles roles(a, b);
  const SolverShape& shape = *roles.mesh->shape;
  const Vec3 centre = roles.centre_in_mesh();
  const double radius = roles.sphere->scale * roles.sphere->shape->rounding;
  const double reach = (radius + margin) / roles.mesh->scale;
  thread_local std::vector<NearTriangle> near;
  thread_local std::vector<SurfaceMinimum> minima;
  near.clear();
  for (const CornerCandidate& candidate : lists.corners_a) {
    if (candidate.slack > motion) continue;
    const TriangleMesh& mesh = shape.mesh;
    const std::int32_t t = candidate.triangle;
    const auto [foot, place] = nearest_on_triangle(centre, mesh.corner(t, 0), mesh.corner(t, 1), mesh.corner(t, 2));
    near.push_back({t, place, foot, squared_length(centre - foot)});
  }
  find_minima(shape, centre, near, reach, sharing_of(roles) / roles.mesh->scale, minima);
  for (const SurfaceMinimum& m : minima) {
    const double distance = std::sqrt(m.squared);
    const Vec3 direction = rotate(roles.mesh->q, (1 / distance) * (centre - m.foot));  // world, mesh to sphere
    ContactFeature f{};
    f.key = m.place;
    const double gap = roles.mesh->scale * distance - radius;
    f.overlap = margin - gap;
    f.weight = m.weight;
    const Vec3 point = (roles.sphere->x - a.x) - (radius + 0.5 * gap) * direction;  // mid-gap, from A's centre
    f.x = rotate_inverse(a.q, point);
    f.n = rotate_inverse(a.q, roles.sphere_is_a ? direction : -direction);
    f.faded = m.varies;
    if (m.varies) {
      const Vec3 gradient = (1 / roles.mesh->scale) * rotate_inverse(a.q, rotate(roles.mesh->q, m.gradient));
      // the centre moves with A where A is the ball; one of B goes the other way in the frame of the mesh
      f.weight_gradient.force = roles.sphere_is_a ? gradient : -gradient;
      f.weight_gradient.couple = cross(rotate_inverse(a.q, roles.sphere->x - a.x), f.weight_gradient.force);
    }
    if (f.overlap > 0) features.push_back(f);
  }
}

}  // namespace scree
