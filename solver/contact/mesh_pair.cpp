// Two meshes: their lists and the features of corners; part of pair_features.hpp.
#include "solver/contact/pair_features.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <utility>

#include "solver/contact/candidate_slack.hpp"
#include "solver/contact/due_candidates.hpp"
#include "solver/contact/edge_features.hpp"
#include "solver/contact/nearest_on_triangle.hpp"

namespace scree {

namespace {

const Vec3& triangle_corner(const SolverShape& shape, std::int32_t t, int k) { return shape.mesh.corner(t, k); }

/// Candidates of one kind that are to be looked at: indices into `slacks`, in which those of the kind begin at `first`.
struct Due {
  std::span<const std::int32_t> indices;
  std::size_t first;
  std::size_t candidate(std::size_t n) const { return static_cast<std::size_t>(indices[n]) - first; }
};

/// Corner features of one side; poses map corner frame to triangle frame.
template <class ToTriangleFrame, class NormalToA>
void corner_features(const PairBody& from, const SolverShape& surface, double surface_scale, std::int64_t kind,
                     const std::vector<CornerCandidate>& candidates, const Due& due, double margin, double size, double way,
                     ToTriangleFrame&& to_triangle_frame, NormalToA&& feature_frame, float* slacks, std::vector<ContactFeature>& features) {
  const double reach = margin / surface_scale;
  thread_local std::vector<double> squared_distances;
  for (std::size_t begin = 0, end = 0; begin < due.indices.size(); begin = end) {
    const std::int32_t corner = candidates[due.candidate(begin)].corner;
    const Vec3 p = (1 / surface_scale) * to_triangle_frame(from.scale * from.shape->corner(corner));
    squared_distances.clear();
    double nearest = std::numeric_limits<double>::infinity();
    Vec3 nearest_point;
    for (end = begin; end < due.indices.size() && candidates[due.candidate(end)].corner == corner; ++end) {
      const std::int32_t t = candidates[due.candidate(end)].triangle;
      const Vec3 q =
          nearest_on_triangle(p, triangle_corner(surface, t, 0), triangle_corner(surface, t, 1), triangle_corner(surface, t, 2)).point;
      const double d2 = squared_length(p - q);
      if (d2 < nearest) {
        nearest = d2;
        nearest_point = q;
      }
      squared_distances.push_back(d2);
    }
    const double distance = std::sqrt(nearest);
    for (std::size_t n = begin; n < end; ++n) {
      const double d2 = squared_distances[n - begin], own = d2 == nearest ? distance : std::sqrt(d2);
      // not within the margin, or not nearer than another one (list_corners)
      const double lacks = std::max(surface_scale * own - margin, 0.5 * surface_scale * (own - distance));
      slacks[due.indices[n]] = slack_on_way(way, lacks, size);
    }
    if (!(nearest < reach * reach)) continue;
    const double gap = surface_scale * distance;
    ContactFeature f{};
    f.key = make_key(kind, corner, 0);
    f.overlap = margin - gap;
    f.weight = 1;
    f.crowd = from.crowd(corner);
    // At gap 0 there is no direction; the guard on overlap over margin stops the run before this can matter.
    const Vec3 direction = distance > 0 ? (1 / distance) * (p - nearest_point) : Vec3{};
    feature_frame(surface_scale * (0.5 * (p + nearest_point)), direction, f);
    features.push_back(f);
  }
}

/// A corner near a triangle, when lists are made.
struct NearCorner {
  std::int32_t corner, triangle;
  double distance;
};

/// Lists what was found near. The nearest point of a surface is on none of its triangles that is further away than another by more than
/// twice the motion since: both distances change by no more than that. Returns the smallest slack of all, or the skin.
double list_corners(std::vector<NearCorner>& near, double margin, double skin, double size, std::vector<CornerCandidate>& candidates) {
  std::sort(near.begin(), near.end(),
            [](const NearCorner& l, const NearCorner& r) { return l.corner != r.corner ? l.corner < r.corner : l.triangle < r.triangle; });
  double first_slack = skin;
  for (std::size_t begin = 0, end = 0; begin < near.size(); begin = end) {
    double nearest = near[begin].distance;
    for (end = begin; end < near.size() && near[end].corner == near[begin].corner; ++end) nearest = std::min(nearest, near[end].distance);
    for (std::size_t i = begin; i < end; ++i) {
      first_slack = std::min(first_slack, static_cast<double>(slack_below(near[i].distance, margin, size)));
      const double lacks = std::max(near[i].distance - margin, 0.5 * (near[i].distance - nearest));
      if (const float slack = slack_on_way(0, lacks, size); slack < skin) candidates.push_back({near[i].corner, near[i].triangle, slack});
    }
  }
  return first_slack;
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
    if (distance < reach) near.push_back({c, other, distance});
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
        if (lacks < skin) lacks = std::max(lacks, slack_of_wedge(a, b, pose, ea, eb, lines, margin, size, skin));
        if (const float slack = slack_on_way(0, lacks, size); slack < skin) lists.edges.push_back({ea, eb, slack});
      }
    }
  }
  for (const auto& [near, candidates] : {std::pair(&near_a, &lists.corners_a), std::pair(&near_b, &lists.corners_b)})
    first_slack = std::min(first_slack, list_corners(*near, margin, skin, size, *candidates));
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

void mesh_corner_features(const PairBody& a, const PairBody& b, const RelativePose& pose, double margin, double size, CandidateLists& lists,
                          std::vector<ContactFeature>& features, std::vector<std::int32_t>& edges) {
  features.clear();
  thread_local std::vector<std::int32_t> due;
  find_due(lists.slacks, lists.way, due);
  // slacks lie in the order of the three lists
  const std::size_t of_b = lists.corners_a.size(), of_edges = of_b + lists.corners_b.size();
  const auto place = [&](std::size_t first) { return std::lower_bound(due.begin(), due.end(), static_cast<std::int32_t>(first)); };
  const auto begin_b = place(of_b), begin_edges = place(of_edges);
  corner_features(
      a, *b.shape, b.scale, kCornerOfA, lists.corners_a, {{due.begin(), begin_b}, 0}, margin, size, lists.way,
      [&](const Vec3& p) { return pose.b_from_a(p); },
      [&](const Vec3& middle, const Vec3& direction, ContactFeature& f) {
        f.x = pose.a_from_b(middle);
        f.n = pose.rotation * direction;
      },
      lists.slacks.data(), features);
  corner_features(
      b, *a.shape, a.scale, kCornerOfB, lists.corners_b, {{begin_b, begin_edges}, of_b}, margin, size, lists.way,
      [&](const Vec3& p) { return pose.a_from_b(p); },
      [&](const Vec3& middle, const Vec3& direction, ContactFeature& f) {
        f.x = middle;
        f.n = -direction;
      },
      lists.slacks.data(), features);
  edges.clear();
  for (auto n = begin_edges; n != due.end(); ++n) edges.push_back(*n - static_cast<std::int32_t>(of_edges));
}

void set_edge_slack(double lacks, double size, std::int32_t edge, CandidateLists& lists) {
  lists.slacks[lists.corners_a.size() + lists.corners_b.size() + static_cast<std::size_t>(edge)] = slack_on_way(lists.way, lacks, size);
}

void mesh_edge_feature(const PairBody& a, const PairBody& b, const RelativePose& pose, double margin, double size, std::int32_t edge,
                       CandidateLists& lists, std::vector<ContactFeature>& features) {
  set_edge_slack(look_at_edges(a, b, pose, margin, size, lists.edges[static_cast<std::size_t>(edge)], features), size, edge, lists);
}

void end_mesh_features(CandidateLists& lists, const std::vector<ContactFeature>& features) {
  if (features.empty() && !lists.slacks.empty()) lists.next_look = least_of(lists.slacks);
}

void mesh_pair_features(const PairBody& a, const PairBody& b, const RelativePose& pose, double margin, double size, CandidateLists& lists,
                        std::vector<ContactFeature>& features) {
  thread_local std::vector<std::int32_t> edges;
  mesh_corner_features(a, b, pose, margin, size, lists, features, edges);
  for (const std::int32_t edge : edges) mesh_edge_feature(a, b, pose, margin, size, edge, lists, features);
  end_mesh_features(lists, features);
}

}  // namespace scree
