// Triangles of one mesh that pass through each other.
#pragma once

#include <cstdint>
#include <vector>

#include "core/geometry/triangle_mesh.hpp"

namespace scree {

struct CrossingPair {
  std::int32_t first, second;  ///< triangle indices, first < second
};

enum class CrossingAt {
  no_corner,    ///< pairs that share a vertex are not looked at
  corners_too,  ///< pairs that share one vertex cross where the edge opposite of it meets the other triangle
};

/// Pairs of triangles that intersect or touch, other than at vertices that they share.
///
/// How: a bounding volume hierarchy descends against itself; the exact triangle test decides.
/// in   mesh   finite, welded, without zero-area triangles
/// Fails: never.   Cost: O(T log T) for surfaces that do not cluster.
/// Limits: triangles that share two vertices are not tested; a fold right at an edge goes unseen.
std::vector<CrossingPair> find_crossing_pairs(const TriangleMesh& mesh, CrossingAt where = CrossingAt::no_corner);

}  // namespace scree
