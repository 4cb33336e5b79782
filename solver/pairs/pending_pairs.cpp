#include "solver/pairs/pending_pairs.hpp"

#include <algorithm>
#include <utility>

#include "solver/features/candidate_slack.hpp"
#include "solver/features/edge_features.hpp"

namespace scree {

PendingPairs& PendingPairs::of_thread() {
  thread_local PendingPairs pairs;
  return pairs;
}

void PendingPairs::add(std::int32_t k, double moved, const PairView& view, const CandidateLists& lists, DueCandidates& due) {
  PendingPair& pending = pairs_[count_];
  pending.k = k;
  pending.moved = moved;
  if (&view != &pending.view) pending.view = view;
  std::swap(pending.due, due);
  queue_corners(view.a, view.b, view.pose, lists, pending.due, corners_);
  if (pending.due.edge_count() > 0) {
    edges_.poses[count_] = EdgePose(view.pose, view.a, view.b, view.reach);
    edges_.has_walls = edges_.has_walls || view.b.shape->is_two_sided;
  }
  for (std::size_t n = pending.due.edges; n < pending.due.indices.size(); ++n) {
    const EdgeCandidate& candidate = due_edge(lists, pending.due.indices[n]);
    edges_.add(count_, view.a.shape->edge_rows[static_cast<std::size_t>(candidate.edge_a)],
               view.b.shape->edge_rows[static_cast<std::size_t>(candidate.edge_b)]);
  }
  ++count_;
}

void PendingPairs::complete(PendingPair& pending, Places& first, CandidateLists& lists) const {
  const PairView& view = pending.view;
  const double size = std::min(view.radius_a, view.radius_b);
  std::vector<ContactFeature>& features = pending.features;
  mesh_corner_features(view.a, view.b, view.pose, view.reach, sharing_of_vertices(view), size, pending.due,
                       {corners_, found_corners_, first.corner}, lists, features);
  first.corner += pending.due.edges;
  const float used_up = slack_on_way(lists.way, 0, size);
  for (std::size_t n = pending.due.edges; n < pending.due.indices.size(); ++n, ++first.edge) {
    const std::int32_t index = pending.due.indices[n];
    if (!found_edges_.found(first.edge)) {
      mesh_edge_feature(view.a, view.b, view.pose, view.reach, size, index, lists, features);
      continue;
    }
    features.push_back(found_edges_.feature(first.edge));
    name_edge_feature(view.a, view.b, due_edge(lists, index), features.back());
    lists.slacks[static_cast<std::size_t>(index)] = used_up;
  }
  end_mesh_features(lists, features);
}

}  // namespace scree
