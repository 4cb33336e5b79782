// gather = "pairs": one spring for every pair of triangles closer than the margin, as the seed work sums them. Kept for
// comparison only: stiffness and damping grow with the number of triangles (docs/reference/validation-plan.md section 3.2).
#pragma once

#include "solver/features/pair_features.hpp"

namespace scree {

/// Makes the list of two meshes: candidates are triangle pairs, kept in `edges`. Returns false when they intersect.
bool list_triangle_contacts(const PairBody& a, const PairBody& b, double margin, double skin, double radius_a, double radius_b,
                            MeshDistanceScratch& scratch, CandidateLists& lists);

/// One feature of weight 1 for every triangle pair below the margin, at its closest points; key (0, triangle a, triangle b).
void triangle_contact_features(const PairBody& a, const PairBody& b, double margin, double motion, const CandidateLists& lists,
                               std::vector<ContactFeature>& features);

}  // namespace scree
