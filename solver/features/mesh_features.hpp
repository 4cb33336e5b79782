// The features of two meshes in parts, for the examination of many pairs at once (pairs/pending_pairs.hpp): which candidates are due, then
// corners, then edges, then the end. mesh_pair_features() of pair_features.hpp is all of them, one pair after another.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "solver/features/corner_lanes.hpp"
#include "solver/features/pair_features.hpp"

namespace scree {

/// Candidates that are to be looked at: indices into CandidateLists::slacks, ascending. Slacks lie in the order of the three lists.
struct DueCandidates {
  std::vector<std::int32_t> indices;
  std::size_t corners_of_b = 0, edges = 0;  ///< where these begin in `indices`; corners of A come first
  std::size_t edge_count() const { return indices.size() - edges; }
};
void find_due_candidates(const CandidateLists& lists, DueCandidates& due);

/// Puts the corners that are due into a queue, one place a triangle.
void queue_corners(const PairBody& a, const PairBody& b, const RelativePose& pose, const CandidateLists& lists, const DueCandidates& due,
                   CornerQueue& queue);

/// What has been found of the corners of one pair.
struct CornerLooks {
  const CornerQueue& queue;
  const CornerAnswers& answers;
  std::size_t first;  ///< place of its first in the queue
};

/// Features of corners, the only ones in `features` then; new slacks of what was looked at. The second is told by lanes what it asks.
void mesh_corner_features(const PairBody& a, const PairBody& b, const RelativePose& pose, double margin, double sharing, double size,
                          const DueCandidates& due, CandidateLists& lists, std::vector<ContactFeature>& features);
void mesh_corner_features(const PairBody& a, const PairBody& b, const RelativePose& pose, double margin, double sharing, double size,
                          const DueCandidates& due, const CornerLooks& looks, CandidateLists& lists, std::vector<ContactFeature>& features);

/// Looks at one edge candidate, appended to `features` where it is one, and gives it a new slack.   in   index   in DueCandidates::indices
void mesh_edge_feature(const PairBody& a, const PairBody& b, const RelativePose& pose, double margin, double size, std::int32_t index,
                       CandidateLists& lists, std::vector<ContactFeature>& features);
inline const EdgeCandidate& due_edge(const CandidateLists& lists, std::int32_t index) {
  return lists.edges[static_cast<std::size_t>(index) - lists.corners_a.size() - lists.corners_b.size()];
}

void end_mesh_features(CandidateLists& lists, const std::vector<ContactFeature>& features);

/// All of what is due, one after another.
void due_mesh_features(const PairBody& a, const PairBody& b, const RelativePose& pose, double margin, double sharing, double size,
                       const DueCandidates& due, CandidateLists& lists, std::vector<ContactFeature>& features);

}  // namespace scree
