#include "solver/features/mesh_features.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "core/geometry/nearest_on_triangle.hpp"
#include "solver/features/candidate_slack.hpp"
#include "solver/features/due_candidates.hpp"
#include "solver/features/edge_features.hpp"
#include "solver/features/surface_minima.hpp"

namespace scree {

namespace {

/// The corners of one side that are due, against triangles of the other. Poses map the corner's frame to the triangles'.
template <bool kOfA>
class CornerSide {
 public:
  CornerSide(const PairBody& a, const PairBody& b, const RelativePose& pose, const CandidateLists& lists, const DueCandidates& due)
      : from_(kOfA ? a : b),
        surface_(kOfA ? *b.shape : *a.shape),
        surface_scale_(kOfA ? b.scale : a.scale),
        pose_(pose),
        candidates_(kOfA ? lists.corners_a : lists.corners_b),
        due_(due.indices.data() + (kOfA ? 0 : due.corners_of_b), due.indices.data() + (kOfA ? due.corners_of_b : due.edges)),
        first_(kOfA ? 0 : lists.corners_a.size()) {}

  /// Calls work(corner, begin, end) for each corner, whose triangles are at these places of what is due.
  template <class Work>
  void for_each_corner(Work&& work) const {
    for (std::size_t begin = 0, end = 0; begin < due_.size(); begin = end) {
      const std::int32_t corner = candidate(begin).corner;
      for (end = begin + 1; end < due_.size() && candidate(end).corner == corner;) ++end;
      work(corner, begin, end);
    }
  }

  /// In the frame and scale of the triangles.
  Vec3 place(std::int32_t corner) const {
    const Vec3 p = from_.scale * from_.shape->corner(corner);
    return (1 / surface_scale_) * (kOfA ? pose_.b_from_a(p) : pose_.a_from_b(p));
  }
  const Vec3& triangle_corner(std::size_t n, int k) const { return surface_.mesh.corner(candidate(n).triangle, k); }

  /// The features of a corner, if it has any, and the new slacks of its candidates.   in   looks   (n): what its n-th triangle is to it
  template <class Looks>
  void finish_features(std::int32_t corner, std::size_t begin, std::size_t end, const Vec3& p, const Looks& looks, double margin,
                       double sharing, double size, CandidateLists& lists, std::vector<ContactFeature>& features) const {
    std::size_t nearest = 0;
    for (std::size_t n = 1; n < end - begin; ++n)
      if (looks.squared(n) < looks.squared(nearest)) nearest = n;
    const double distance = looks.distance(nearest), of_all = nearest_of_all(corner, begin, end, surface_scale_ * distance, margin, lists);
    for (std::size_t n = 0; n < end - begin; ++n) {
      const double lacks = lack_of(surface_, surface_scale_ * looks.distance(n), of_all, margin, sharing);
      lists.slacks[static_cast<std::size_t>(due_[begin + n])] = slack_on_way(lists.way, lacks, size);
    }
    const double reach = margin / surface_scale_;
    if (!(looks.squared(nearest) < reach * reach)) return;
    if (surface_.is_convex || !(distance > 0)) {
      add_feature(corner, 0, p, looks.nearest(nearest), distance, margin, features);
      return;
    }
    thread_local std::vector<NearTriangle> near;
    thread_local std::vector<SurfaceMinimum> minima;
    near.clear();
    for (std::size_t n = 0; n < end - begin; ++n)
      near.push_back({candidate(begin + n).triangle, looks.place(n), looks.nearest(n), looks.squared(n)});
    find_minima(surface_, p, near, reach, sharing / surface_scale_, minima);
    for (const SurfaceMinimum& m : minima) {
      ContactFeature& f = add_feature(corner, m.place, p, m.foot, looks.distance(m.near), margin, features);
      f.weight = m.weight;
      if (!m.varies) continue;
      f.faded = true;
      // a vertex of A moves with A; one of B goes the other way in the frame of the surface
      const Vec3 gradient = (kOfA ? 1 : -1) / surface_scale_ * m.gradient, from = from_.scale * from_.shape->corner(corner);
      f.weight_gradient.force = kOfA ? pose_.rotation * gradient : gradient;
      f.weight_gradient.couple = cross(kOfA ? from : pose_.a_from_b(from), f.weight_gradient.force);
    }
  }

 private:
  /// in   p, foot   of the corner, in the frame and scale of the triangles
  ContactFeature& add_feature(std::int32_t corner, std::int64_t place, const Vec3& p, const Vec3& foot, double distance, double margin,
                              std::vector<ContactFeature>& features) const {
    // At gap 0 there is no direction; the guard on overlap over margin stops the run before this can matter.
    const Vec3 direction = distance > 0 ? (1 / distance) * (p - foot) : Vec3{};
    const Vec3 middle = surface_scale_ * (0.5 * (p + foot));
    features.push_back({kOfA ? pose_.a_from_b(middle) : middle,
                        margin - surface_scale_ * distance,
                        kOfA ? pose_.rotation * direction : -direction,
                        1,
                        {},
                        from_.cluster(corner),
                        make_key(kOfA ? kCornerOfA : kCornerOfB, corner, place),
                        false});
    return features.back();
  }
  /// No triangle of a corner is nearer than this [m].   in   looked   distance of the nearest of those that are due [m]
  double nearest_of_all(std::int32_t corner, std::size_t begin, std::size_t end, double looked, double margin,
                        const CandidateLists& lists) const {
    // a convex surface asks for any near one, and once the corner touches, those that wait are not the nearest
    if (surface_.is_convex || looked < margin) return looked;
    double nearest = looked;
    const auto place = [&](std::size_t n) { return static_cast<std::size_t>(due_[n]) - first_; };
    const auto see = [&](std::size_t c) { nearest = std::min(nearest, distance_of_waiting(lists.slacks[first_ + c], lists.way, margin)); };
    for (std::size_t c = place(begin); c > 0 && candidates_[c - 1].corner == corner; --c) see(c - 1);
    for (std::size_t n = begin + 1; n < end; ++n)
      for (std::size_t c = place(n - 1) + 1; c < place(n); ++c) see(c);
    for (std::size_t c = place(end - 1) + 1; c < candidates_.size() && candidates_[c].corner == corner; ++c) see(c);
    return nearest;
  }
  const CornerCandidate& candidate(std::size_t n) const { return candidates_[static_cast<std::size_t>(due_[n]) - first_]; }

  const PairBody& from_;
  const SolverShape& surface_;
  double surface_scale_;
  const RelativePose& pose_;
  const std::vector<CornerCandidate>& candidates_;
  std::span<const std::int32_t> due_;
  std::size_t first_;  ///< index of its first slack
};

/// Calls work(side) for the corners of A and for those of B.
template <class Work>
void for_both_sides(const PairBody& a, const PairBody& b, const RelativePose& pose, const CandidateLists& lists, const DueCandidates& due,
                    Work&& work) {
  work(CornerSide<true>(a, b, pose, lists, due));
  work(CornerSide<false>(a, b, pose, lists, due));
}

/// What the triangles of one corner are to it, found one after another.
class PlainLooks {
 public:
  void clear() { looks_.clear(); }
  void add(const Vec3& p, const NearestOnTriangle& found) { looks_.push_back({found, squared_length(p - found.point)}); }
  double squared(std::size_t n) const { return looks_[n].squared; }
  double distance(std::size_t n) const { return std::sqrt(looks_[n].squared); }
  const Vec3& nearest(std::size_t n) const { return looks_[n].found.point; }
  int place(std::size_t n) const { return looks_[n].found.place; }

 private:
  struct Look {
    NearestOnTriangle found;
    double squared;
  };
  std::vector<Look> looks_;
};

/// The same, found in lanes.
struct LaneLooks {
  const CornerAnswers& answers;
  std::size_t first;
  double squared(std::size_t n) const { return answers.squared[first + n]; }
  double distance(std::size_t n) const { return answers.distance[first + n]; }
  Vec3 nearest(std::size_t n) const { return answers.nearest.at(first + n); }
  int place(std::size_t n) const { return static_cast<int>(answers.place[first + n]); }
};

}  // namespace

void find_due_candidates(const CandidateLists& lists, DueCandidates& due) {
  find_due(lists.slacks, lists.way, due.indices);
  const std::size_t of_b = lists.corners_a.size(), of_edges = of_b + lists.corners_b.size(), count = due.indices.size();
  std::size_t n = 0;
  while (n < count && static_cast<std::size_t>(due.indices[n]) < of_b) ++n;
  due.corners_of_b = n;
  while (n < count && static_cast<std::size_t>(due.indices[n]) < of_edges) ++n;
  due.edges = n;
}

void queue_corners(const PairBody& a, const PairBody& b, const RelativePose& pose, const CandidateLists& lists, const DueCandidates& due,
                   CornerQueue& queue) {
  for_both_sides(a, b, pose, lists, due, [&](const auto& side) {
    side.for_each_corner([&](std::int32_t corner, std::size_t begin, std::size_t end) {
      const Vec3 p = side.place(corner);
      for (std::size_t n = begin; n < end; ++n)
        queue.add(p, side.triangle_corner(n, 0), side.triangle_corner(n, 1), side.triangle_corner(n, 2));
    });
  });
}

void mesh_corner_features(const PairBody& a, const PairBody& b, const RelativePose& pose, double margin, double sharing, double size,
                          const DueCandidates& due, CandidateLists& lists, std::vector<ContactFeature>& features) {
  features.clear();
  thread_local PlainLooks looks;
  for_both_sides(a, b, pose, lists, due, [&](const auto& side) {
    side.for_each_corner([&](std::int32_t corner, std::size_t begin, std::size_t end) {
      const Vec3 p = side.place(corner);
      looks.clear();
      for (std::size_t n = begin; n < end; ++n)
        looks.add(p, nearest_on_triangle(p, side.triangle_corner(n, 0), side.triangle_corner(n, 1), side.triangle_corner(n, 2)));
      side.finish_features(corner, begin, end, p, looks, margin, sharing, size, lists, features);
    });
  });
}

void mesh_corner_features(const PairBody& a, const PairBody& b, const RelativePose& pose, double margin, double sharing, double size,
                          const DueCandidates& due, const CornerLooks& looks, CandidateLists& lists,
                          std::vector<ContactFeature>& features) {
  features.clear();
  std::size_t first = looks.first;
  for_both_sides(a, b, pose, lists, due, [&](const auto& side) {
    side.for_each_corner([&](std::int32_t corner, std::size_t begin, std::size_t end) {
      side.finish_features(corner, begin, end, looks.queue.p.at(first), LaneLooks{looks.answers, first}, margin, sharing, size, lists,
                           features);
      first += end - begin;
    });
  });
}

void mesh_edge_feature(const PairBody& a, const PairBody& b, const RelativePose& pose, double margin, double size, std::int32_t index,
                       CandidateLists& lists, std::vector<ContactFeature>& features) {
  const double lacks = examine_edges(a, b, pose, margin, size, due_edge(lists, index), features);
  lists.slacks[static_cast<std::size_t>(index)] = slack_on_way(lists.way, lacks, size);
}

void end_mesh_features(CandidateLists& lists, const std::vector<ContactFeature>& features) {
  if (features.empty() && !lists.slacks.empty()) lists.next_examination = least_of(lists.slacks);
}

void due_mesh_features(const PairBody& a, const PairBody& b, const RelativePose& pose, double margin, double sharing, double size,
                       const DueCandidates& due, CandidateLists& lists, std::vector<ContactFeature>& features) {
  mesh_corner_features(a, b, pose, margin, sharing, size, due, lists, features);
  for (std::size_t n = due.edges; n < due.indices.size(); ++n) mesh_edge_feature(a, b, pose, margin, size, due.indices[n], lists, features);
  end_mesh_features(lists, features);
}

void mesh_pair_features(const PairBody& a, const PairBody& b, const RelativePose& pose, double margin, double sharing, double size,
                        CandidateLists& lists, std::vector<ContactFeature>& features) {
  thread_local DueCandidates due;
  find_due_candidates(lists, due);
  due_mesh_features(a, b, pose, margin, sharing, size, due, lists, features);
}

}  // namespace scree
