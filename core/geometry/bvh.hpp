// One static bounding volume hierarchy per shape, in the shape's own frame, never refitted: eight wide and in single
// precision, laid out for SIMD, so that one vector holds eight boxes or eight triangles.
//
//   BvhNode   boxes of up to 8 children, component by component        lower[c][k], upper[c][k]
//   BvhLeaf   up to 8 triangles, coordinate by coordinate              corner[3 v + c][k]
//
// Coordinates are from the middle of the mesh, so that a shape far from its own origin loses none of them. It only
// filters: whoever descends adds an allowance for rounding and decides in double precision on the mesh's own vertices.
// About 51 bytes a triangle.
#pragma once

#include <cstdint>
#include <vector>

#include "core/geometry/triangle_mesh.hpp"

namespace scree {

inline constexpr int kBvhWidth = 8;

/// Slots from count on repeat slot 0 and mean nothing.
struct alignas(32) BvhNode {
  float lower[3][kBvhWidth], upper[3][kBvhWidth];  ///< rounded outward
  std::int32_t child[kBvhWidth];                   ///< >= 0: node; < 0: leaf ~child
  std::int32_t count = 0;
};

struct alignas(32) BvhLeaf {
  float corner[9][kBvhWidth];        ///< rounded to nearest
  std::int32_t triangle[kBvhWidth];  ///< index in the mesh
  std::int32_t count = 0;
};

struct Bvh {
  std::vector<BvhNode> nodes;   ///< the root is node 0; empty for a shape without triangles
  std::vector<BvhLeaf> leaves;  ///< full but for a few
  Vec3 middle;                  ///< what boxes and corners are relative to, in the mesh's coordinates
  float size = 0;               ///< largest absolute coordinate, from the middle
  float radius = 0;             ///< largest distance of a corner from the mesh's origin, rounded up

  /// Bytes held.
  std::size_t memory() const { return nodes.capacity() * sizeof(BvhNode) + leaves.capacity() * sizeof(BvhLeaf); }
};

/// How: halves at multiples of 8 triangles, by surface area below 4096 triangles and at the median above, so that
/// leaves are full; then the binary tree becomes the wide one with the least sum of areas of nodes and leaves, by dynamic
/// programming (H. Ylitie, T. Karras, S. Laine, Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs,
/// HPG 2017, section 3.1).
/// Limits: coordinates below 1e18 in absolute value.   Cost: O(T log^2 T).
Bvh build_bvh(const TriangleMesh& mesh);

}  // namespace scree
