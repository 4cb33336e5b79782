// Two meshes: their lists and the features of corners; part of pair_features.hpp.
#include "solver/contact/pair_features.hpp"

#include <algorithm>
#include <cmath>

#include "solver/contact/edge_features.hpp"
#include "solver/contact/nearest_on_triangle.hpp"

namespace scree {

namespace {

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

const Vec3& triangle_corner(const SolverShape& shape, std::int32_t t, int k) { return shape.mesh.corner(t, k); }

/// Corner features of one side. `side` is +1 when the corners are A's; poses map corner frame to triangle frame.
template <class ToTriangleFrame, class NormalToA>
void corner_features(const PairBody& from, const SolverShape& surface, double surface_scale, std::int64_t kind,
                     const std::vector<CornerCandidate>& candidates, double margin, double motion, ToTriangleFrame&& to_triangle_frame,
                     NormalToA&& feature_frame, std::vector<ContactFeature>& features) {
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
        p = (1 / surface_scale) * to_triangle_frame(from.scale * from.shape->corner(corner));
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
    f.crowd = from.crowd(corner);
    // At gap 0 there is no direction; the guard on overlap over margin stops the run before this can matter.
    const Vec3 direction = distance > 0 ? (1 / distance) * (p - best_point) : Vec3{};
    feature_frame(surface_scale * (0.5 * (p + best_point)), direction, f);
    features.push_back(f);
  }
}

}  // namespace

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
  /// Adds corner k of a triangle of `from`, if the triangle owns it, against a triangle of `to`.
  const auto add_corner = [&](const SolverShape& from, std::int32_t triangle, std::size_t k, double from_scale, const SolverShape& to,
                              std::int32_t other, double to_scale, const auto& to_frame, std::vector<CornerCandidate>& candidates) {
    const auto t = static_cast<std::size_t>(triangle);
    if (!from.features.owns_corner(t, k)) return;
    const std::int32_t c = from.features.corner_of[static_cast<std::size_t>(from.mesh.triangles[t][k])];
    const Vec3 p = (1 / to_scale) * to_frame(from_scale * from.corner(c));
    const Vec3 nearest =
        nearest_on_triangle(p, triangle_corner(to, other, 0), triangle_corner(to, other, 1), triangle_corner(to, other, 2)).point;
    const double distance = to_scale * length(p - nearest);
    if (distance < reach) candidates.push_back({c, other, slack_below(distance, margin, size)});
  };
  for (const TrianglePair& pair : pairs) {
    const auto ta = static_cast<std::size_t>(pair.a), tb = static_cast<std::size_t>(pair.b);
    for (std::size_t k = 0; k < 3; ++k) {
      add_corner(
          shape_a, pair.a, k, a.scale, shape_b, pair.b, b.scale, [&](const Vec3& p) { return pose.b_from_a(p); }, lists.corners_a);
      add_corner(
          shape_b, pair.b, k, b.scale, shape_a, pair.a, a.scale, [&](const Vec3& p) { return pose.a_from_b(p); }, lists.corners_b);
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

void mesh_pair_features(const PairBody& a, const PairBody& b, const RelativePose& pose, double margin, double motion,
                        const CandidateLists& lists, std::vector<ContactFeature>& features) {
  features.clear();
  corner_features(
      a, *b.shape, b.scale, kCornerOfA, lists.corners_a, margin, motion, [&](const Vec3& p) { return pose.b_from_a(p); },
      [&](const Vec3& middle, const Vec3& direction, ContactFeature& f) {
        f.x = pose.a_from_b(middle);
        f.n = pose.rotation * direction;
      },
      features);
  corner_features(
      b, *a.shape, a.scale, kCornerOfB, lists.corners_b, margin, motion, [&](const Vec3& p) { return pose.a_from_b(p); },
      [&](const Vec3& middle, const Vec3& direction, ContactFeature& f) {
        f.x = middle;
        f.n = -direction;
      },
      features);
  edge_features(a, b, pose, margin, motion, lists.edges, features);
}

}  // namespace scree
