#include "solver/features/area_pressure.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/distance/plain_distance.hpp"
#include "core/distance/triangle_distance.hpp"
#include "solver/features/dual.hpp"

namespace scree {

namespace {

/// A corner of a polygon in the plane across the mean normal.
struct PlanePoint {
  Dual x, y;
};

/// Convex polygon: two triangles share at most six corners, and a cut by the overlap adds one.
struct Polygon {
  std::array<PlanePoint, 16> corner;
  std::size_t count = 0;
  void add(const PlanePoint& p) { corner[count++] = p; }
};

/// What of a polygon lies where `inside` is not negative; inside must be linear.
template <class Inside>
void cut(Polygon& polygon, Inside&& inside) {
  Polygon rest;
  if (polygon.count == 0) return;
  Dual previous = inside(polygon.corner[polygon.count - 1]);
  PlanePoint from = polygon.corner[polygon.count - 1];
  for (std::size_t i = 0; i < polygon.count; ++i) {
    const PlanePoint& to = polygon.corner[i];
    const Dual present = inside(to);
    if ((previous.v < 0) != (present.v < 0)) {
      const Dual s = previous / (previous - present);
      rest.add({from.x + s * (to.x - from.x), from.y + s * (to.y - from.y)});
    }
    if (!(present.v < 0)) rest.add(to);
    previous = present;
    from = to;
  }
  polygon = rest;
}

Vec3 triangle_normal(const Vec3 (&p)[3]) { return cross(p[1] - p[0], p[2] - p[0]); }

/// The side of the contact that is not A: a plane, and the triangle in it, if it ends.
struct OtherSide {
  DualVec point, normal;
  const Vec3* corner = nullptr;  ///< three, A frame
};

/// Sums of one patch.
struct PatchSum {
  AreaPatch patch;
  Vec3 moment, direction;  ///< of d dA: about A's centre, and along the normals
  double area = 0;
  void add(const PatchSum& other, double share) {
    patch.energy += share * other.patch.energy;
    patch.force += share * other.patch.force;
    patch.largest_overlap = std::max(patch.largest_overlap, other.patch.largest_overlap);
    patch.gradient.force += share * other.patch.gradient.force;
    patch.gradient.couple += share * other.patch.gradient.couple;
    moment += share * other.moment;
    direction += share * other.direction;
    area += share * other.area;
  }
};

/// The layer between two triangles.
struct FacingPair {
  std::int32_t of_a, of_b;
  PatchSum sum;
};

constexpr double kFadeFacing = 0.5;  // cosine from which triangles count as facing each other in full

/// Adds the layer between a triangle of A and what faces it.
void add_layer(const Vec3 (&pa)[3], const OtherSide& other, double margin, PatchSum& sum, std::vector<AreaPoint>& points) {
  const Vec3 area_a = triangle_normal(pa);
  const DualVec na = moving_direction(normalised(area_a));
  const Dual facing = Dual(0) - dot(na, other.normal);
  if (!(facing.v > 0)) return;
  const double y = std::min(1.0, facing.v / kFadeFacing);
  const Dual weight = chain(y * y * (3 - 2 * y), y < 1 ? 6 * y * (1 - y) / kFadeFacing : 0.0, facing);
  const DualVec n = normalised(other.normal - na);
  const Vec3 nv = n.value();
  const DualVec e1 = normalised(cross(DualVec(std::abs(nv.x) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0}), n)), e2 = cross(n, e1);

  // A's triangle, anticlockwise as seen from where n points
  DualVec corner[3];
  Polygon polygon;
  for (int k = 0; k < 3; ++k) corner[k] = moving_point(pa[k]);
  for (int k : {0, 2, 1}) polygon.add({dot(corner[k], e1), dot(corner[k], e2)});  // it faces against n
  if (other.corner != nullptr) {
    PlanePoint rim[3];
    for (int k = 0; k < 3; ++k) rim[k] = {dot(DualVec(other.corner[k]), e1), dot(DualVec(other.corner[k]), e2)};
    const Dual turn = (rim[1].x - rim[0].x) * (rim[2].y - rim[0].y) - (rim[1].y - rim[0].y) * (rim[2].x - rim[0].x);
    if (turn.v < 0) std::swap(rim[1], rim[2]);
    for (int k = 0; k < 3; ++k) {
      const PlanePoint &from = rim[k], &to = rim[(k + 1) % 3];
      cut(polygon, [&](const PlanePoint& p) { return (to.x - from.x) * (p.y - from.y) - (to.y - from.y) * (p.x - from.x); });
    }
  }
  // heights along n of both planes are linear in the plane across it
  const auto height = [&](const DualVec& point, const DualVec& normal) {
    const Dual slope_x = dot(normal, e1) / dot(normal, n), slope_y = dot(normal, e2) / dot(normal, n);
    const Dual at_origin = dot(point, n) + slope_x * dot(point, e1) + slope_y * dot(point, e2);
    return [=](const PlanePoint& p) { return at_origin - slope_x * p.x - slope_y * p.y; };
  };
  const auto height_a = height(corner[0], na), height_b = height(other.point, other.normal);
  const auto overlap = [&](const PlanePoint& p) { return Dual(margin) + height_b(p) - height_a(p); };
  cut(polygon, overlap);
  if (polygon.count < 3) return;

  Dual energy;
  const PlanePoint& first = polygon.corner[0];
  for (std::size_t k = 2; k < polygon.count; ++k) {
    const PlanePoint* p[3] = {&first, &polygon.corner[k - 1], &polygon.corner[k]};
    const Dual area = Dual(0.5) * ((p[1]->x - p[0]->x) * (p[2]->y - p[0]->y) - (p[1]->y - p[0]->y) * (p[2]->x - p[0]->x));
    const Dual d[3] = {overlap(*p[0]), overlap(*p[1]), overlap(*p[2])};
    energy = energy + area * (d[0] * d[0] + d[1] * d[1] + d[2] * d[2] + d[0] * d[1] + d[1] * d[2] + d[2] * d[0]);
    const double total = d[0].v + d[1].v + d[2].v, share = weight.v * area.v;
    Vec3 place[3], middle;
    for (int i = 0; i < 3; ++i) {
      place[i] = p[i]->x.v * e1.value() + p[i]->y.v * e2.value() + (0.5 * (height_a(*p[i]).v + height_b(*p[i]).v)) * nv;
      middle += place[i];
      sum.patch.largest_overlap = std::max(sum.patch.largest_overlap, d[i].v);
    }
    sum.patch.force += share * total / 3;
    sum.direction += (share * total / 3) * nv;
    sum.area += share;
    // int d x dA of two linear functions
    sum.moment += (share * total / 12) * middle;
    for (int i = 0; i < 3; ++i) {
      sum.moment += (share * d[i].v / 12) * place[i];
      points.push_back({0.5 * (place[i] + place[(i + 1) % 3]), nv, share / 3});  // mid-edges: exact for quadratics
    }
  }
  energy = weight * energy * Dual(1.0 / 12);  // 1/2 int d^2 = area / 12 of the sum above
  sum.patch.energy += energy.v;
  sum.patch.gradient.force += Vec3{energy.d[0], energy.d[1], energy.d[2]};
  sum.patch.gradient.couple += Vec3{energy.d[3], energy.d[4], energy.d[5]};
}

void finish_patch(std::int64_t kind, std::int32_t triangle, const PatchSum& sum, std::vector<ContactFeature>& features,
                  AreaContact& contact) {
  if (!(sum.patch.force > 0)) return;
  ContactFeature f{};
  f.key = make_key(kind, 0, triangle);
  f.x = (1 / sum.patch.force) * sum.moment;
  f.n = normalised(sum.direction);
  f.overlap = sum.patch.force / sum.area;
  f.weight = 1;
  features.push_back(f);
  contact.patches.push_back(sum.patch);
}

/// Tangent plane of a zone at the foot of a point that moves with A; frame of A.
OtherSide tangent_plane(const WallZone& zone, const Mat3& rotation, const Vec3& centre, const DualVec& p) {
  const Vec3 axis = rotation * zone.direction, at = rotation * zone.point + centre;
  if (zone.kind == WallZone::Kind::plane) return {DualVec(at), DualVec(axis), nullptr};
  DualVec radial = p - DualVec(at);
  if (zone.kind == WallZone::Kind::cylinder) radial = radial - dot(radial, DualVec(axis)) * DualVec(axis);
  const Dual rho = sqrt(dot(radial, radial));
  const DualVec outward = (Dual(1) / rho) * radial;
  return {p + (Dual(zone.radius) - rho) * outward, Dual(-1) * outward, nullptr};
}

}  // namespace

void list_area_zone(const PairBody& a, const PairBody& b, const WallZone& zone, double margin, double skin, double radius_a,
                    CandidateLists& lists) {
  begin_lists(a, b, skin, radius_a, 2 * radius_a, lists);  // the wall is the frame
  // the particles' side of a zone is convex: a triangle is no nearer than its nearest corner
  const SolverShape& shape = *a.shape;
  const Mat3 rotation = matrix_of(conjugate(b.q) * a.q);
  const Vec3 centre = rotate_inverse(b.q, a.x - b.x);
  for (std::int32_t t = 0; t < shape.mesh.triangle_count(); ++t) {
    double gap = 1e300;
    for (int k = 0; k < 3; ++k) {
      Vec3 normal;
      gap = std::min(gap, zone_gap(zone, rotation * (a.scale * shape.mesh.corner(t, k)) + centre, normal));
    }
    if (gap < margin + skin) lists.corners_a.push_back({t, -1, slack_below(gap, margin, radius_a)});
  }
  end_lists(lists);
}

void area_zone_features(const PairBody& a, const PairBody& b, const WallZone& zone, double margin, double motion,
                        const CandidateLists& lists, std::vector<ContactFeature>& features, AreaContact& contact) {
  features.clear();
  contact.patches.clear();
  contact.points.clear();
  const Mat3 rotation = matrix_of(conjugate(a.q) * b.q);
  const Vec3 centre = rotate_inverse(a.q, b.x - a.x);
  for (const CornerCandidate& candidate : lists.corners_a) {
    if (candidate.slack > motion) continue;
    Vec3 p[3];
    for (int k = 0; k < 3; ++k) p[k] = a.scale * a.shape->mesh.corner(candidate.corner, k);
    PatchSum sum;
    add_layer(p, tangent_plane(zone, rotation, centre, moving_point((1.0 / 3) * (p[0] + p[1] + p[2]))), margin, sum, contact.points);
    finish_patch(kCornerOfA, candidate.corner, sum, features, contact);
  }
}

double layer_share_of_a(double radius_a, double radius_b) {
  constexpr double kSameSize = 1e-9;  // the radius of one shape turned, mirrored or scaled differs by some rounding
  if (std::abs(radius_a - radius_b) <= kSameSize * radius_b) return 0.5;
  return radius_a < radius_b ? 1.0 : 0.0;
}

void area_features(const PairBody& a, const PairBody& b, double margin, double motion, double share_of_a, const CandidateLists& lists,
                   std::vector<ContactFeature>& features, AreaContact& contact) {
  features.clear();
  contact.patches.clear();
  contact.points.clear();
  if (lists.edges.empty()) return;
  const Mat3 rotation = matrix_of(conjugate(a.q) * b.q);
  const Vec3 centre = rotate_inverse(a.q, b.x - a.x);
  thread_local std::vector<FacingPair> pairs;
  pairs.clear();
  for (const EdgeCandidate& candidate : lists.edges) {
    if (candidate.slack > motion) continue;
    Vec3 pa[3], pb[3];
    for (int k = 0; k < 3; ++k) {
      pa[k] = a.scale * a.shape->mesh.corner(candidate.edge_a, k);
      pb[k] = rotation * (b.scale * b.shape->mesh.corner(candidate.edge_b, k)) + centre;
    }
    Vec3 normal = normalised(triangle_normal(pb));
    // An open surface has two sides: the one counts on which the triangle of A lies, there where it is nearest. By the normals alone a
    // face of A that looks away, beside the edge on which A stands, would press on the far side of the surface.
    if (b.shape->kind == ShapeKind::surface && !triangle_distance(pa, pb).intersecting) {
      // not by the kernel's normal, whose sign beside an edge would depend on the instruction set
      const PlainNearest nearest = nearest_of_triangles(pa, pb);
      if (dot(normal, nearest.a - nearest.b) < 0) normal = -normal;
    }
    FacingPair pair{candidate.edge_a, candidate.edge_b, {}};
    const std::size_t points = contact.points.size();
    add_layer(pa, {DualVec(pb[0]), DualVec(normal), pb}, margin, pair.sum, contact.points);
    // The backs of two thin bodies face each other as well, with both bodies between them: deep in each other by their planes, and yet
    // apart.
    if (pair.sum.patch.largest_overlap > margin && !(triangle_distance(pa, pb).distance < margin)) {
      contact.points.resize(points);
      continue;
    }
    if (pair.sum.patch.force > 0) pairs.push_back(pair);
  }
  const auto add_patches_of = [&](std::int64_t kind, double share, std::int32_t FacingPair::*triangle) {
    if (share == 0) return;
    for (std::size_t begin = 0, end = 0; begin < pairs.size(); begin = end) {
      PatchSum sum;
      for (end = begin; end < pairs.size() && pairs[end].*triangle == pairs[begin].*triangle; ++end) sum.add(pairs[end].sum, share);
      finish_patch(kind, pairs[begin].*triangle, sum, features, contact);
    }
  };
  add_patches_of(kCornerOfA, share_of_a, &FacingPair::of_a);
  if (share_of_a < 1)
    std::stable_sort(pairs.begin(), pairs.end(), [](const FacingPair& l, const FacingPair& r) { return l.of_b < r.of_b; });
  add_patches_of(kCornerOfB, 1 - share_of_a, &FacingPair::of_b);
}

}  // namespace scree
