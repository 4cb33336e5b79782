// Analytic sphere against mesh: part of pair_features.hpp.
//
// The distance from the sphere's centre to the surface has a local minimum in the inside of a flat region, on a convex
// edge or at a convex corner; each is one contact. A nearest point of one triangle is such a minimum when no neighbour
// comes nearer, which the conormals of the edge and the spokes of the corner tell. The tests allow for rounding, so that a
// contact is never lost between two parts of space; what is then found twice is at the same place and counted once.
#include <algorithm>
#include <cmath>

#include "solver/contact/nearest_on_triangle.hpp"
#include "solver/contact/pair_features.hpp"

namespace scree {

namespace {

constexpr std::int64_t kRegion = 0, kEdge = 1, kCorner = 2;

/// Tolerance on the cosine in the tests for neighbours: far above rounding, far below any angle that matters.
constexpr double kNeighbourCosine = 1e-9;
/// Two minima nearer to each other than this share of their distance from the centre are one.
constexpr double kSamePlace = 1e-7;

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

struct Minimum {
  std::int64_t kind, index;
  Vec3 point;
};

bool edge_holds(const SolverShape& shape, std::int32_t edge, const Vec3& outward) {
  const double allowed = kNeighbourCosine * length(outward);
  return dot(outward, shape.edge_conormal(edge, 0)) <= allowed && dot(outward, shape.edge_conormal(edge, 1)) <= allowed;
}

bool is_perpendicular(const SolverShape& shape, std::int32_t triangle, const Vec3& outward) {
  const Vec3 ab = shape.mesh.corner(triangle, 1) - shape.mesh.corner(triangle, 0);
  const Vec3 ac = shape.mesh.corner(triangle, 2) - shape.mesh.corner(triangle, 0);
  const double allowed = kNeighbourCosine * length(outward);
  return std::abs(dot(outward, ab)) <= allowed * length(ab) && std::abs(dot(outward, ac)) <= allowed * length(ac);
}

/// Whether a vertex inside a straight edge is the foot on it, and not only the end of one of its pieces.
bool is_across(const SolverShape& shape, std::int32_t triangle, std::size_t k, const Vec3& outward) {
  const Vec3 along = shape.mesh.corner(triangle, static_cast<int>((k + 1) % 3)) - shape.mesh.corner(triangle, static_cast<int>(k));
  return std::abs(dot(outward, along)) <= kNeighbourCosine * length(outward) * length(along);
}

/// The minimum that the nearest point of one triangle is, if it is one.
bool find_minimum(const SolverShape& shape, std::int32_t triangle, const Vec3& centre, Minimum& minimum) {
  const auto t = static_cast<std::size_t>(triangle);
  const NearestOnTriangle nearest =
      nearest_on_triangle(centre, shape.mesh.corner(triangle, 0), shape.mesh.corner(triangle, 1), shape.mesh.corner(triangle, 2));
  const Vec3 outward = centre - nearest.point;
  minimum = {kRegion, shape.features.region[t], nearest.point};
  if (nearest.place < 0) return true;
  const auto take_edge = [&](std::size_t k) {
    switch (shape.features.edge_kind(t, k)) {
      case EdgeKind::flat:
        return is_perpendicular(shape, triangle, outward);  // inside the flat region, if this is its foot
      case EdgeKind::concave:
        return false;
      default:
        break;
    }
    minimum.kind = kEdge;
    minimum.index = shape.features.edge_of[t][k];
    return edge_holds(shape, shape.features.edge_of[t][k], outward);
  };
  if (nearest.place < 3) return take_edge(static_cast<std::size_t>(nearest.place));
  const auto k = static_cast<std::size_t>(nearest.place - 3);
  const std::int32_t corner = shape.features.corner_of[static_cast<std::size_t>(shape.mesh.triangles[t][k])];
  if (corner < 0) {  // inside a flat region or on a straight edge
    const std::size_t edge = shape.features.edge_kind(t, k) != EdgeKind::flat ? k : (k + 2) % 3;
    return take_edge(edge) && (minimum.kind != kEdge || is_across(shape, triangle, edge, outward));
  }
  minimum.kind = kCorner;
  minimum.index = corner;
  const auto c = static_cast<std::size_t>(corner);
  for (std::int32_t s = shape.spoke_start[c]; s < shape.spoke_start[c + 1]; ++s) {
    const Vec3 spoke = shape.mesh.vertices[static_cast<std::size_t>(shape.spoke_end[static_cast<std::size_t>(s)])] - shape.corner(corner);
    if (dot(outward, spoke) > kNeighbourCosine * length(outward) * length(spoke)) return false;
  }
  return true;
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
  const double reach = (radius + margin + skin) / roles.mesh->scale;
  if (triangle_pairs_within({&mesh.mesh, &mesh.bvh}, {&point, &point_tree}, placement, reach, scratch, pairs)) return false;
  for (const TrianglePair& pair : pairs) {
    const NearestOnTriangle nearest =
        nearest_on_triangle(placement.translation, mesh.mesh.corner(pair.a, 0), mesh.mesh.corner(pair.a, 1), mesh.mesh.corner(pair.a, 2));
    const double gap = roles.mesh->scale * length(placement.translation - nearest.point) - radius;
    lists.corners_a.push_back({0, pair.a, slack_below(gap, margin, std::max(radius_a, radius_b))});
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
  thread_local std::vector<Minimum> minima;
  minima.clear();
  for (const CornerCandidate& candidate : lists.corners_a) {
    if (candidate.slack > motion) continue;
    Minimum minimum;
    if (find_minimum(shape, candidate.triangle, centre, minimum) && squared_length(centre - minimum.point) < reach * reach) {
      minima.push_back(minimum);
    }
  }
  std::sort(minima.begin(), minima.end(),
            [](const Minimum& l, const Minimum& r) { return l.kind != r.kind ? l.kind < r.kind : l.index < r.index; });
  for (std::size_t i = 0; i < minima.size(); ++i) {
    const Vec3 outward = centre - minima[i].point;
    const double distance = length(outward);
    bool known = !(distance > 0);
    for (std::size_t j = 0; j < i && !known; ++j) known = length(minima[i].point - minima[j].point) <= kSamePlace * distance;
    if (known) continue;
    const Vec3 direction = rotate(roles.mesh->q, (1 / distance) * outward);  // world, mesh to sphere
    ContactFeature f{};
    f.key = (minima[i].kind << 58) | minima[i].index;
    const double gap = roles.mesh->scale * distance - radius;
    f.overlap = margin - gap;
    f.weight = 1;
    const Vec3 point = (roles.sphere->x - a.x) - (radius + 0.5 * gap) * direction;  // mid-gap, from A's centre
    f.x = rotate_inverse(a.q, point);
    f.n = rotate_inverse(a.q, roles.sphere_is_a ? direction : -direction);
    if (f.overlap > 0) features.push_back(f);
  }
}

}  // namespace scree
