// Friction springs that go from one feature to another.
//
// Where the nearest point of a corner, or of a ball, passes from a facet to the next one, a feature ends and another begins in its place.
// The spring goes over to it, turned to its normal; else each facet would take what friction stores, and a body creep over a fine mesh.
//
// Features of the same owner, a corner of either body or a ball, are compared: of what is left once equal keys have found each other, the
// spring and the feature whose normals lie nearest to each other, then the next nearest, ties in the order of keys. A spring goes to one
// feature, and only over less than 60 degrees: beyond that the two are contacts of their own. What is left of springs ends: the weight of
// their features has gone to nothing before. Edge pairs, patches of a layer and pairs of triangles hand over nothing.
// Source: docs/reference/contact-law.md section 3.4.
#pragma once

#include <cstdint>
#include <vector>

#include "solver/contact/pair_state.hpp"
#include "solver/features/pair_features.hpp"

namespace scree {

class MeanTurn;

/// Least cosine between the normals of a spring and of the feature that it goes to.
inline constexpr double kHandOverCosine = 0.5;

/// Whether features with such a key hand over their springs: corners, and what a ball touches.
inline bool is_handed_over(std::int64_t key) { return key < kEdgeEdge << 60; }
/// Of features with such keys: what has moved on, a corner or a ball, whatever it touches there (SurfaceMinimum::place). Balls in
/// checkpoints before version 5 told that in bits 58 and 59, where the number of a corner does not reach.
inline std::int64_t owner_of_key(std::int64_t key) { return (key & ~(std::int64_t{3} << 58)) >> 30; }

struct HandedOver {
  std::int64_t feature;  ///< key
  const FrictionSpring* spring;
};

/// The features that go on with the spring of another one.
///
/// in   features   of now, ascending keys     in  push   where not null, features that press on nothing [N] take no spring
/// in   springs    of the last step
/// Valid until the thread calls it again.
const std::vector<HandedOver>& find_handed_over(const std::vector<ContactFeature>& features, const std::vector<double>* push,
                                                const std::vector<FrictionSpring>& springs, const MeanTurn& turned);

}  // namespace scree
