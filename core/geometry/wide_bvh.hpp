// An eight-wide hierarchy in single precision, laid out for SIMD: one vector holds eight boxes or eight triangles.
//
//   WideNode   boxes of up to 8 children, component by component        lower[c][k], upper[c][k]
//   WideLeaf   up to 8 triangles, coordinate by coordinate              corner[3 v + c][k]
//
// Coordinates are from the middle of the mesh, so that a shape far from its own origin loses none of them. It only
// filters: whoever descends adds an allowance for rounding and decides in double precision on the mesh's own vertices.
// About 51 bytes a triangle.
#pragma once

#include <cstdint>
#include <vector>

#include "core/geometry/triangle_mesh.hpp"

namespace scree {

inline constexpr int kWideWidth = 8;

/// Slots from count on repeat slot 0 and mean nothing.
struct alignas(32) WideNode {
  float lower[3][kWideWidth], upper[3][kWideWidth];  ///< rounded outward
  std::int32_t child[kWideWidth];                    ///< >= 0: node; < 0: leaf ~child
  std::int32_t count = 0;
};

struct alignas(32) WideLeaf {
  float corner[9][kWideWidth];          ///< rounded to nearest
  std::int32_t triangle[kWideWidth];    ///< index in the mesh
  std::int32_t count = 0;
};

struct WideBvh {
  std::vector<WideNode> nodes;   ///< the root is node 0; empty for a shape without triangles
  std::vector<WideLeaf> leaves;  ///< full but for a few
  Vec3 middle;                   ///< what boxes and corners are relative to, in the mesh's coordinates
  float size = 0;                ///< largest absolute coordinate, from the middle
  float radius = 0;              ///< largest distance of a corner from the mesh's origin, rounded up
};

/// How: halves at multiples of 8 triangles, by surface area below 4096 triangles and at the median above, so that
/// leaves are full; then the binary tree becomes the wide one with the least sum of areas of nodes and leaves, by dynamic
/// programming (H. Ylitie, T. Karras, S. Laine, Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs,
/// HPG 2017, section 3.1).
/// Limits: coordinates below 1e18 in absolute value.   Cost: O(T log^2 T).
WideBvh build_wide_bvh(const TriangleMesh& mesh);

}  // namespace scree
