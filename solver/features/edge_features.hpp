// Convex edges of one mesh against those of another: features that fade smoothly at the ends of an edge, where two edges are parallel, and
// where the normal leans out of the wedge between the faces of an edge.
// Source: docs/reference/contact-law.md sections 3.1 and 3.2.
#pragma once

#include "solver/features/edge_fading.hpp"
#include "solver/features/pair_features.hpp"

namespace scree {

/// Appends the feature below `margin` that two edges are at the present pose, if they are one. Returns the motion before which they are
/// none [m]; 0 where they are.
/// in   size   bounding radius of the smaller body [m]
double examine_edges(const PairBody& a, const PairBody& b, const RelativePose& pose, double margin, double size,
                     const EdgeCandidate& candidate, std::vector<ContactFeature>& features);

/// Key and cluster of such a feature: what of it does not depend on the pose.
inline void name_edge_feature(const PairBody& a, const PairBody& b, const EdgeCandidate& candidate, ContactFeature& f) {
  f.key = make_key(kEdgeEdge, candidate.edge_a, candidate.edge_b);
  if (a.weights != nullptr || b.weights != nullptr)
    f.cluster = 4 / (a.weight_of_ends(candidate.edge_a) + b.weight_of_ends(candidate.edge_b)) - 1;
}

}  // namespace scree
