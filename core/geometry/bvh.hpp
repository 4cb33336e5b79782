// One static bounding volume hierarchy per shape, in the shape's own frame, never refitted.
#pragma once

#include <cstdint>
#include <vector>

#include "core/geometry/triangle_mesh.hpp"
#include "core/geometry/wide_bvh.hpp"

namespace scree {

/// Binary tree over triangles, depth first: the first child of inner node i is i + 1.
struct BvhNode {
  float lower[3], upper[3];     ///< conservative: rounded outward from the double coordinates
  std::int32_t second_child;    ///< inner: index of the second child; leaf: -1
  std::int32_t first, count;    ///< leaf: range in Bvh::order; inner: count is 0
};

struct Bvh {
  std::vector<BvhNode> nodes;          ///< empty for a shape without triangles
  std::vector<std::int32_t> order;     ///< triangle indices, leaf by leaf
  WideBvh wide;                        ///< the same triangles for the SIMD descent of two meshes
};

/// Triangles in a leaf at most; a leaf pair is one or a few SIMD batches.
inline constexpr int kBvhLeafSize = 4;

/// Depth of a tree at most, the root being at depth 0: a stack of twice this serves every descent.
inline constexpr int kBvhMaxDepth = 72;

/// Builds with the surface area heuristic over 16 bins; equal for equal input.   Cost: O(T log T).
Bvh build_bvh(const TriangleMesh& mesh);

}  // namespace scree
