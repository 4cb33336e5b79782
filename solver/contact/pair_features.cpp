#include "solver/contact/pair_features.hpp"

#include <algorithm>
#include <cmath>

#include "solver/contact/nearest_on_triangle.hpp"

namespace scree {

namespace {

constexpr std::int64_t kCornerOfA = 0, kCornerOfB = 1, kEdgeEdge = 2;

std::int64_t make_key(std::int64_t kind, std::int64_t i, std::int64_t j) { return (kind << 60) | (i << 30) | j; }

/// Squared distance of two segments. Source: Ericson (2005), section 5.1.9.
double squared_segment_distance(const Vec3& p, const Vec3& u, const Vec3& q, const Vec3& v) {
  const Vec3 r = p - q;
  const double uu = dot(u, u), vv = dot(v, v), vr = dot(v, r), ur = dot(u, r), uv = dot(u, v);
  const double det = uu * vv - uv * uv;
  double s = det > 0 ? std::clamp((uv * vr - ur * vv) / det, 0.0, 1.0) : 0.0;
  double t = vv > 0 ? std::clamp((uv * s + vr) / vv, 0.0, 1.0) : 0.0;
  s = uu > 0 ? std::clamp((uv * t - ur) / uu, 0.0, 1.0) : 0.0;
  return squared_length(r + s * u - t * v);
}

/// S(y) = y^2 (3 - 2 y) on [0, 1] and its derivative: the smooth switch of the fading.
double smooth_switch(double y, double& derivative) {
  derivative = 0;
  if (y <= 0) return 0;
  if (y >= 1) return 1;
  derivative = 6 * y * (1 - y);
  return y * y * (3 - 2 * y);
}

const Vec3& triangle_corner(const SolverShape& shape, std::int32_t t, int k) { return shape.mesh.corner(t, k); }

/// Frame of the larger body, in which the smaller one's motion is measured: a small body that spins beside a wide
/// floor uses up its own radius, not the floor's.
bool larger_is_a(double radius_a, double radius_b) { return radius_a > radius_b; }

}  // namespace

float slack_below(double distance, double margin, double size) {
  constexpr double kDistanceRounding = 1e-12;  // of the body size: far above the error of the double formulas
  const double slack = distance - margin - kDistanceRounding * size;
  return slack <= 0 ? 0.0f : std::nextafterf(static_cast<float>(slack), 0.0f);
}

double motion_since_listed(const CandidateLists& lists, const RelativePose& pose, double radius_a, double radius_b) {
  const Vec3 centre = larger_is_a(radius_a, radius_b) ? pose.centre : -transpose_times(pose.rotation, pose.centre);
  // A point at distance R from the centre moves by 2 R sin(angle / 2), and two unit quaternions differ by 2 sin(angle / 4):
  // twice that is never less. Of the two quaternions of a rotation the nearer one counts.
  const Quat &p = pose.turn, &q = lists.turn;
  const double side = p.w * q.w + p.x * q.x + p.y * q.y + p.z * q.z < 0 ? -1 : 1;
  const double w = p.w - side * q.w, x = p.x - side * q.x, y = p.y - side * q.y, z = p.z - side * q.z;
  return length(centre - lists.centre) + 2 * std::sqrt(w * w + x * x + y * y + z * z) * std::min(radius_a, radius_b);
}

void begin_lists(const PairBody& a, const PairBody& b, double skin, double radius_a, double radius_b, CandidateLists& lists) {
  lists.corners_a.clear();
  lists.corners_b.clear();
  lists.edges.clear();
  const RelativePose pose(a, b);
  lists.centre = larger_is_a(radius_a, radius_b) ? pose.centre : -transpose_times(pose.rotation, pose.centre);
  lists.turn = pose.turn;
  lists.skin = skin;
  lists.first_slack = skin;
}

void end_lists(CandidateLists& lists) {
  double first = lists.skin;
  for (const auto* corners : {&lists.corners_a, &lists.corners_b}) {
    for (const CornerCandidate& c : *corners) first = std::min(first, static_cast<double>(c.slack));
  }
  for (const EdgeCandidate& e : lists.edges) first = std::min(first, static_cast<double>(e.slack));
  lists.first_slack = first;
}

bool list_mesh_pair(const PairBody& a, const PairBody& b, double margin, double skin, double radius_a, double radius_b,
                    MeshDistanceScratch& scratch, CandidateLists& lists) {
  begin_lists(a, b, skin, radius_a, radius_b, lists);
  const SolverShape& shape_a = *a.shape;
  const SolverShape& shape_b = *b.shape;
  const Placement placement = relative_placement(a.x, a.q, a.scale, b.x, b.q, b.scale);
  const double reach = margin + skin;
  thread_local std::vector<TrianglePair> pairs;
  const bool intersecting =
      triangle_pairs_within({&shape_a.mesh, &shape_a.bvh}, {&shape_b.mesh, &shape_b.bvh}, placement, reach / a.scale, scratch, pairs);
  if (intersecting) return false;

  // what the triangles own: see core/geometry/features.hpp
  const RelativePose pose(a, b);
  const double size = std::min(radius_a, radius_b);
  for (const TrianglePair& pair : pairs) {
    const auto ta = static_cast<std::size_t>(pair.a), tb = static_cast<std::size_t>(pair.b);
    for (std::size_t k = 0; k < 3; ++k) {
      if (shape_a.features.owns_corner(ta, k)) {
        const std::int32_t c = shape_a.features.corner_of[static_cast<std::size_t>(shape_a.mesh.triangles[ta][k])];
        const Vec3 p = (1 / b.scale) * pose.b_from_a(a.scale * shape_a.corner(c));
        const Vec3 nearest = nearest_on_triangle(p, triangle_corner(shape_b, pair.b, 0), triangle_corner(shape_b, pair.b, 1),
                                                 triangle_corner(shape_b, pair.b, 2))
                                 .point;
        const double distance = b.scale * length(p - nearest);
        if (distance < reach) lists.corners_a.push_back({c, pair.b, slack_below(distance, margin, size)});
      }
      if (shape_b.features.owns_corner(tb, k)) {
        const std::int32_t c = shape_b.features.corner_of[static_cast<std::size_t>(shape_b.mesh.triangles[tb][k])];
        const Vec3 p = (1 / a.scale) * pose.a_from_b(b.scale * shape_b.corner(c));
        const Vec3 nearest = nearest_on_triangle(p, triangle_corner(shape_a, pair.a, 0), triangle_corner(shape_a, pair.a, 1),
                                                 triangle_corner(shape_a, pair.a, 2))
                                 .point;
        const double distance = a.scale * length(p - nearest);
        if (distance < reach) lists.corners_b.push_back({c, pair.a, slack_below(distance, margin, size)});
      }
      const std::int32_t ea = shape_a.features.owned_edge(ta, k);
      if (ea < 0) continue;
      const ShapeEdge edge_a = shape_a.edge(ea);
      for (std::size_t m = 0; m < 3; ++m) {
        const std::int32_t eb = shape_b.features.owned_edge(tb, m);
        if (eb < 0) continue;
        const ShapeEdge edge_b = shape_b.edge(eb);
        const double distance =
            std::sqrt(squared_segment_distance(a.scale * edge_a.start, a.scale * edge_a.along, pose.a_from_b(b.scale * edge_b.start),
                                               pose.rotation * (b.scale * edge_b.along)));
        if (distance < reach) lists.edges.push_back({ea, eb, slack_below(distance, margin, size)});
      }
    }
  }
  const auto by_corner = [](const CornerCandidate& l, const CornerCandidate& r) {
    return l.corner != r.corner ? l.corner < r.corner : l.triangle < r.triangle;
  };
  std::sort(lists.corners_a.begin(), lists.corners_a.end(), by_corner);
  std::sort(lists.corners_b.begin(), lists.corners_b.end(), by_corner);
  const auto by_edges = [](const EdgeCandidate& l, const EdgeCandidate& r) {
    return l.edge_a != r.edge_a ? l.edge_a < r.edge_a : l.edge_b < r.edge_b;
  };
  std::sort(lists.edges.begin(), lists.edges.end(), by_edges);
  // pieces of one straight edge come from several triangles
  lists.edges.erase(
      std::unique(lists.edges.begin(), lists.edges.end(),
                  [](const EdgeCandidate& l, const EdgeCandidate& r) { return l.edge_a == r.edge_a && l.edge_b == r.edge_b; }),
      lists.edges.end());
  end_lists(lists);
  return true;
}

double zone_gap(const WallZone& zone, const Vec3& p, Vec3& normal) {
  const Vec3 r = p - zone.point;
  switch (zone.kind) {
    case WallZone::Kind::plane:
      normal = zone.direction;
      return dot(r, zone.direction);
    case WallZone::Kind::cylinder: {
      const Vec3 radial = r - dot(r, zone.direction) * zone.direction;
      const double rho = length(radial);
      normal = rho > 0 ? (-1 / rho) * radial : Vec3{};
      return zone.radius - rho;
    }
    case WallZone::Kind::sphere: {
      const double rho = length(r);
      normal = rho > 0 ? (-1 / rho) * r : Vec3{};
      return zone.radius - rho;
    }
    case WallZone::Kind::mesh:
      break;
  }
  SCREE_ASSERT(false, "a mesh zone has no closed-form gap");
  return 0;
}

void list_zone_pair(const PairBody& a, const PairBody& b, const WallZone& zone, double margin, double skin, double radius_a,
                    CandidateLists& lists) {
  begin_lists(a, b, skin, radius_a, 2 * radius_a, lists);  // the wall is the frame
  const RelativePose pose(a, b);
  const auto corner_count = static_cast<std::int32_t>(a.shape->features.corners.size());
  for (std::int32_t c = 0; c < corner_count; ++c) {
    Vec3 normal;
    const double gap = zone_gap(zone, pose.b_from_a(a.scale * a.shape->corner(c)), normal) - a.scale * a.shape->rounding;
    if (gap < margin + skin) {
      lists.corners_a.push_back({c, -1, slack_below(gap, margin, radius_a)});
    }
  }
  end_lists(lists);
}

void list_sphere_pair(const PairBody& a, const PairBody& b, double margin, double skin, double radius_a, double radius_b,
                      CandidateLists& lists) {
  begin_lists(a, b, skin, radius_a, radius_b, lists);
  const double gap = length(a.x - b.x) - a.scale * a.shape->rounding - b.scale * b.shape->rounding;
  lists.first_slack = std::min(skin, static_cast<double>(slack_below(gap, margin, radius_a + radius_b)));
}

void sphere_pair_features(const PairBody& a, const PairBody& b, double margin, std::vector<ContactFeature>& features) {
  features.clear();
  const double radius_a = a.scale * a.shape->rounding, radius_b = b.scale * b.shape->rounding;
  const Vec3 between = a.x - b.x;
  const double distance = length(between);
  const double gap = distance - radius_a - radius_b;
  if (gap >= margin || distance <= 0) return;
  ContactFeature f{};
  f.key = make_key(kCornerOfA, 0, 0);
  f.n = rotate_inverse(a.q, (1 / distance) * between);
  f.x = (-(radius_a + 0.5 * gap)) * f.n;
  f.overlap = margin - gap;
  f.weight = 1;
  features.push_back(f);
}

void zone_pair_features(const PairBody& a, const RelativePose& pose, const WallZone& zone, double margin, double motion,
                        const CandidateLists& lists, std::vector<ContactFeature>& features) {
  features.clear();
  for (const CornerCandidate& candidate : lists.corners_a) {
    if (candidate.slack > motion) continue;
    const Vec3 p = a.scale * a.shape->corner(candidate.corner);
    Vec3 normal;
    const double gap = zone_gap(zone, pose.b_from_a(p), normal) - a.scale * a.shape->rounding;
    if (gap >= margin) continue;
    ContactFeature f{};
    f.key = make_key(kCornerOfA, candidate.corner, 0);
    f.n = pose.rotation * normal;
    f.x = p - (a.scale * a.shape->rounding + 0.5 * gap) * f.n;
    f.overlap = margin - gap;
    f.weight = 1;
    features.push_back(f);
  }
}

namespace {

/// Corner features of one side. `side` is +1 when the corners are A's; poses map corner frame to triangle frame.
template <class ToTriangleFrame, class NormalToA>
void corner_features(const SolverShape& corner_shape, double corner_scale, const SolverShape& surface, double surface_scale,
                     std::int64_t kind, const std::vector<CornerCandidate>& candidates, double margin, double motion,
                     ToTriangleFrame&& to_triangle_frame, NormalToA&& feature_frame, std::vector<ContactFeature>& features) {
  const double reach = margin / surface_scale;
  for (std::size_t i = 0; i < candidates.size();) {
    const std::int32_t corner = candidates[i].corner;
    double best = reach * reach;
    Vec3 best_point;
    bool found = false;
    Vec3 p;
    bool placed = false;
    for (; i < candidates.size() && candidates[i].corner == corner; ++i) {
      if (candidates[i].slack > motion) continue;
      if (!placed) {
        p = (1 / surface_scale) * to_triangle_frame(corner_scale * corner_shape.corner(corner));
        placed = true;
      }
      const std::int32_t t = candidates[i].triangle;
      const Vec3 q =
          nearest_on_triangle(p, triangle_corner(surface, t, 0), triangle_corner(surface, t, 1), triangle_corner(surface, t, 2)).point;
      const double d2 = squared_length(p - q);
      if (d2 < best) {
        best = d2;
        best_point = q;
        found = true;
      }
    }
    if (!found) continue;
    const double distance = std::sqrt(best);
    const double gap = surface_scale * distance;
    ContactFeature f{};
    f.key = make_key(kind, corner, 0);
    f.overlap = margin - gap;
    f.weight = 1;
    // At gap 0 there is no direction; the guard on overlap over margin stops the run before this can matter.
    const Vec3 direction = distance > 0 ? (1 / distance) * (p - best_point) : Vec3{};
    feature_frame(surface_scale * (0.5 * (p + best_point)), direction, f);
    features.push_back(f);
  }
}

/// A vector from an edge into one of its two faces, zero where there is none. It is not the conormal, but of a direction perpendicular
/// to the edge it lies on the same side, and it takes no root.
Vec3 into_face(const SolverShape& shape, std::int32_t edge, int side) {
  const FeatureEdge& ends = shape.features.edges[static_cast<std::size_t>(edge)];
  const std::int32_t face = ends.face[side];
  if (face < 0) return {};
  const Vec3& start = shape.mesh.vertices[static_cast<std::size_t>(ends.vertex_a)];
  // two of the three lie on the edge: they add nothing across it
  return (shape.mesh.corner(face, 0) - start) + (shape.mesh.corner(face, 1) - start) + (shape.mesh.corner(face, 2) - start);
}

void edge_features(const PairBody& a, const PairBody& b, const RelativePose& pose, double margin, double motion,
                   const std::vector<EdgeCandidate>& candidates, std::vector<ContactFeature>& features) {
  for (const EdgeCandidate& candidate : candidates) {
    if (candidate.slack > motion) continue;
    const ShapeEdge ea = a.shape->edge(candidate.edge_a);
    const ShapeEdge eb = b.shape->edge(candidate.edge_b);
    // letters of docs/reference/contact-law.md section 3.2: u, v edge vectors, s, t parameters, r = x_A - x_B = g n
    const Vec3 pa = a.scale * ea.start, u = a.scale * ea.along;
    const Vec3 pb = pose.a_from_b(b.scale * eb.start), v = pose.rotation * (b.scale * eb.along);
    const Vec3 r0 = pa - pb;
    const double uu = dot(u, u), uv = dot(u, v), vv = dot(v, v), ur = dot(u, r0), vr = dot(v, r0);
    const double det = uu * vv - uv * uv;
    const double sine2 = det / (uu * vv);
    // Below this the fade S(sine2 / kFadeParallel) is under 1e-11 of a contact: nothing is lost by leaving it out.
    constexpr double kParallelCutoff = 1e-8;
    if (!(sine2 > kParallelCutoff)) continue;
    const double s = (uv * vr - vv * ur) / det, t = (uu * vr - uv * ur) / det;
    if (s <= 0 || s >= 1 || t <= 0 || t >= 1) continue;
    const Vec3 xa = pa + s * u, xb = pb + t * v;
    const Vec3 r = xa - xb;
    const double g = length(r);
    if (g >= margin || !(g > 0)) continue;
    const Vec3 n = (1 / g) * r;
    // How far the normal leans out of the wedge over each face. It is perpendicular to both edges, so for most the sides tell:
    // conormals are needed where it leans out.
    const Vec3 n_b = transpose_times(pose.rotation, n);
    Vec3 conormal[4];
    double y[4];
    bool outside = false, leans = false;
    for (int i = 0; i < 4 && !outside; ++i) {
      const double sign = i < 2 ? -1 : 1;
      const SolverShape& shape = i < 2 ? *a.shape : *b.shape;
      const std::int32_t edge = i < 2 ? candidate.edge_a : candidate.edge_b;
      y[i] = 0;
      if (!(sign * dot(i < 2 ? n : n_b, into_face(shape, edge, i & 1)) > 0)) continue;
      conormal[i] = shape.edge_conormal(edge, i & 1);
      if (i >= 2) conormal[i] = pose.rotation * conormal[i];
      y[i] = sign * dot(n, conormal[i]);
      leans = leans || y[i] > 0;
      outside = y[i] >= kFadeWedge;
    }
    if (outside) continue;

    ContactFeature f{};
    f.key = make_key(kEdgeEdge, candidate.edge_a, candidate.edge_b);
    f.x = 0.5 * (xa + xb);
    f.n = n;
    f.overlap = margin - g;
    f.weight = 1;
    if (!leans && std::min({s, 1 - s, t, 1 - t}) >= kFadeEnd && sine2 >= kFadeParallel) {  // nothing fades
      features.push_back(f);
      continue;
    }

    // The weight is a product of switches; each adds weight / switch * slope times the gradient of its argument.
    double of_s, of_t, of_sine, of_y[4] = {};
    const double switch_s = smooth_switch(std::min(s, 1 - s) / kFadeEnd, of_s);
    const double switch_t = smooth_switch(std::min(t, 1 - t) / kFadeEnd, of_t);
    const double switch_sine = smooth_switch(sine2 / kFadeParallel, of_sine);
    double switch_y[4] = {1, 1, 1, 1};
    f.weight = switch_s * switch_t * switch_sine;
    for (int i = 0; i < 4; ++i) {
      if (!(y[i] > 0)) continue;
      switch_y[i] = smooth_switch(1 - y[i] / kFadeWedge, of_y[i]);
      f.weight *= switch_y[i];
    }
    // A weight this small adds less than rounding to the eighth-power sum.
    constexpr double kWeightCutoff = 1e-12;
    if (f.weight < kWeightCutoff) continue;
    of_s *= f.weight / switch_s / kFadeEnd * (s < 0.5 ? 1 : -1);
    of_t *= f.weight / switch_t / kFadeEnd * (t < 0.5 ? 1 : -1);
    of_sine *= f.weight / switch_sine / kFadeParallel;
    f.faded = of_s != 0 || of_t != 0 || of_sine != 0;

    // For a virtual motion of A, B held: of the directions y with s and t held, and what they add to those of s and t
    Vec3 across, turning;
    for (int i = 0; i < 4; ++i) {
      if (of_y[i] == 0) continue;
      f.faded = true;
      const double sign = i < 2 ? -1 : 1;
      const double c = -sign * f.weight / switch_y[i] * of_y[i] / kFadeWedge;
      const Vec3 tp = conormal[i] - dot(conormal[i], n) * n;
      across += (c / g) * tp;
      of_s += c / g * dot(tp, u);
      of_t -= c / g * dot(tp, v);
      if (i < 2) turning += c * cross(conormal[i], n);
    }
    // ds = (vv b1 - uv b2) / -det and dt = (uv b1 - uu b2) / -det, where a translation has b1 = u, b2 = v as coefficients and a
    // rotation about A's centre has b1 = x_A x u + u x r, b2 = x_A x v
    const double p = -(vv * of_s + uv * of_t) / det, q = -(uv * of_s + uu * of_t) / det;
    f.weight_gradient.force = across + p * u - q * v;
    f.weight_gradient.couple = cross(xa, f.weight_gradient.force) + p * cross(u, r) + turning;
    if (of_sine != 0) f.weight_gradient.couple += (of_sine * -2 * uv / (uu * vv)) * cross(u, v);
    features.push_back(f);
  }
}

}  // namespace

void mesh_pair_features(const PairBody& a, const PairBody& b, const RelativePose& pose, double margin, double motion,
                        const CandidateLists& lists, std::vector<ContactFeature>& features) {
  features.clear();
  corner_features(
      *a.shape, a.scale, *b.shape, b.scale, kCornerOfA, lists.corners_a, margin, motion, [&](const Vec3& p) { return pose.b_from_a(p); },
      [&](const Vec3& middle, const Vec3& direction, ContactFeature& f) {
        f.x = pose.a_from_b(middle);
        f.n = pose.rotation * direction;
      },
      features);
  corner_features(
      *b.shape, b.scale, *a.shape, a.scale, kCornerOfB, lists.corners_b, margin, motion, [&](const Vec3& p) { return pose.a_from_b(p); },
      [&](const Vec3& middle, const Vec3& direction, ContactFeature& f) {
        f.x = middle;
        f.n = -direction;
      },
      features);
  edge_features(a, b, pose, margin, motion, lists.edges, features);
}

}  // namespace scree
