// The lists of two meshes; part of pair_features.hpp.
#include "solver/features/pair_features.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/geometry/nearest_on_triangle.hpp"
#include "solver/features/candidate_slack.hpp"
#include "solver/features/due_candidates.hpp"
#include "solver/features/edge_features.hpp"

namespace scree {

namespace {

const Vec3& triangle_corner(const SolverShape& shape, std::int32_t t, int k) { return shape.mesh.corner(t, k); }

/// A corner near a triangle, when lists are made.
struct NearCorner {
  std::int32_t corner, triangle;
  double distance;
};

/// Lists what was found near.   in   surface   of the triangles     Returns the smallest slack of all, or the skin.
double list_corners(const SolverShape& surface, std::vector<NearCorner>& near, double margin, double sharing, double skin, double size,
                    std::vector<CornerCandidate>& candidates) {
  std::sort(near.begin(), near.end(),
            [](const NearCorner& l, const NearCorner& r) { return l.corner != r.corner ? l.corner < r.corner : l.triangle < r.triangle; });
  double first_slack = skin;
  for (std::size_t begin = 0, end = 0; begin < near.size(); begin = end) {
    double nearest = near[begin].distance;
    for (end = begin; end < near.size() && near[end].corner == near[begin].corner; ++end) nearest = std::min(nearest, near[end].distance);
    for (std::size_t i = begin; i < end; ++i) {
      first_slack = std::min(first_slack, static_cast<double>(slack_below(near[i].distance, margin, size)));
      const double lacks = lack_of(surface, near[i].distance, nearest, margin, sharing);
      if (const float slack = slack_on_way(0, lacks, size); slack < skin) candidates.push_back({near[i].corner, near[i].triangle, slack});
    }
  }
  return first_slack;
}

}  // namespace

bool list_mesh_pair(const PairBody& a, const PairBody& b, double margin, double sharing, double skin, double radius_a, double radius_b,
                    MeshDistanceScratch& scratch, CandidateLists& lists) {
  begin_lists(a, b, skin, radius_a, radius_b, lists);
  const SolverShape& shape_a = *a.shape;
  const SolverShape& shape_b = *b.shape;
  const Placement placement = relative_placement(a.x, a.q, a.scale, b.x, b.q, b.scale);
  const double reach = margin + skin;
  const double reach_of_corners = reach + (shape_a.is_convex && shape_b.is_convex ? 0.0 : sharing);
  thread_local std::vector<TrianglePair> pairs;
  const bool intersecting = triangle_pairs_within({&shape_a.mesh, &shape_a.bvh}, {&shape_b.mesh, &shape_b.bvh}, placement,
                                                  reach_of_corners / a.scale, scratch, pairs);
  if (intersecting) return false;

  // what the triangles own: see core/geometry/features.hpp
  const RelativePose pose(a, b);
  const double size = std::min(radius_a, radius_b);
  const bool has_wall = shape_a.is_two_sided || shape_b.is_two_sided;
  double first_slack = skin;
  thread_local std::vector<NearCorner> near_a, near_b;
  near_a.clear();
  near_b.clear();
  /// Adds corner k of a triangle of `from`, if the triangle owns it, against a triangle of `to`.
  const auto add_corner = [&](const SolverShape& from, std::int32_t triangle, std::size_t k, double from_scale, const SolverShape& to,
                              std::int32_t other, double to_scale, const auto& to_frame, std::vector<NearCorner>& near) {
    const auto t = static_cast<std::size_t>(triangle);
    if (!from.features.owns_corner(t, k)) return;
    const std::int32_t c = from.features.corner_of[static_cast<std::size_t>(from.mesh.triangles[t][k])];
    const Vec3 p = (1 / to_scale) * to_frame(from_scale * from.corner(c));
    const Vec3 nearest =
        nearest_on_triangle(p, triangle_corner(to, other, 0), triangle_corner(to, other, 1), triangle_corner(to, other, 2)).point;
    const double distance = to_scale * length(p - nearest);
    if (distance < (to.is_convex ? reach : reach_of_corners)) near.push_back({c, other, distance});
  };
  for (const TrianglePair& pair : pairs) {
    const auto ta = static_cast<std::size_t>(pair.a), tb = static_cast<std::size_t>(pair.b);
    for (std::size_t k = 0; k < 3; ++k) {
      add_corner(
          shape_a, pair.a, k, a.scale, shape_b, pair.b, b.scale, [&](const Vec3& p) { return pose.b_from_a(p); }, near_a);
      add_corner(
          shape_b, pair.b, k, b.scale, shape_a, pair.a, a.scale, [&](const Vec3& p) { return pose.a_from_b(p); }, near_b);
      const std::int32_t ea = shape_a.features.owned_edge(ta, k);
      if (ea < 0) continue;
      for (std::size_t m = 0; m < 3; ++m) {
        const std::int32_t eb = shape_b.features.owned_edge(tb, m);
        if (eb < 0) continue;
        const EdgeLines lines(a, b, pose, ea, eb);
        const double distance = lines.distance();
        if (!(distance < reach)) continue;
        first_slack = std::min(first_slack, static_cast<double>(slack_below(distance, margin, size)));
        double lacks = std::max(distance - margin, slack_of_ends(lines, lines.s(), lines.t(), margin, size));
        if (has_wall && lacks < skin) lacks = std::max(lacks, slack_of_side(a, b, pose, ea, eb, lines));
        if (lacks < skin) lacks = std::max(lacks, slack_of_wedge(a, b, pose, ea, eb, lines, margin, size, skin));
        if (const float slack = slack_on_way(0, lacks, size); slack < skin) lists.edges.push_back({ea, eb, slack});
      }
    }
  }
  first_slack = std::min(first_slack, list_corners(shape_b, near_a, margin, sharing, skin, size, lists.corners_a));
  first_slack = std::min(first_slack, list_corners(shape_a, near_b, margin, sharing, skin, size, lists.corners_b));
  const auto by_edges = [](const EdgeCandidate& l, const EdgeCandidate& r) {
    return l.edge_a != r.edge_a ? l.edge_a < r.edge_a : l.edge_b < r.edge_b;
  };
  std::sort(lists.edges.begin(), lists.edges.end(), by_edges);
  // pieces of one straight edge come from several triangles
  lists.edges.erase(
      std::unique(lists.edges.begin(), lists.edges.end(),
                  [](const EdgeCandidate& l, const EdgeCandidate& r) { return l.edge_a == r.edge_a && l.edge_b == r.edge_b; }),
      lists.edges.end());
  for (const auto* corners : {&lists.corners_a, &lists.corners_b}) {
    for (const CornerCandidate& c : *corners) lists.slacks.push_back(c.slack);
  }
  for (const EdgeCandidate& e : lists.edges) lists.slacks.push_back(e.slack);
  fill_up(lists.slacks);
  lists.first_slack = first_slack;  // what was left out counts: it tells how near the surfaces are
  return true;
}

}  // namespace scree
