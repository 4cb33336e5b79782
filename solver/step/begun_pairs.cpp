#include "solver/step/begun_pairs.hpp"

#include <algorithm>

namespace scree {

BegunPairs& BegunPairs::of_thread() {
  thread_local BegunPairs pairs;
  return pairs;
}

void BegunPairs::add(const CandidateLists& lists) {
  const BegunPair& begun = pairs_[count_];
  const PairView& view = begun.view;
  queue_.poses[count_] = EdgePose(view.pose, view.a, view.b, view.reach);
  for (const std::int32_t edge : begun.edges) {
    const EdgeCandidate& candidate = lists.edges[static_cast<std::size_t>(edge)];
    queue_.add(count_, view.a.shape->edge_rows[static_cast<std::size_t>(candidate.edge_a)],
               view.b.shape->edge_rows[static_cast<std::size_t>(candidate.edge_b)]);
  }
  ++count_;
}

/// The features of the edges of a pair, and their slacks.   in   first   of its edges in the queue
void BegunPairs::complete(BegunPair& begun, std::size_t first, CandidateLists& lists) const {
  const PairView& view = begun.view;
  const double size = std::min(view.radius_a, view.radius_b);
  std::vector<ContactFeature>& features = begun.features;
  for (std::size_t n = 0; n < begun.edges.size(); ++n) {
    const std::int32_t edge = begun.edges[n];
    if (!answers_.found(first + n)) {
      mesh_edge_feature(view.a, view.b, view.pose, view.reach, size, edge, lists, features);
      continue;
    }
    ContactFeature& f = features.emplace_back();
    answers_.set(first + n, f);
    name_edge_feature(view.a, view.b, lists.edges[static_cast<std::size_t>(edge)], f);
    set_edge_slack(0, size, edge, lists);
  }
  end_mesh_features(lists, features);
}

}  // namespace scree
