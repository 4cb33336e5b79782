// Which vertices and edges of a mesh can carry a contact.
//
// A vertex or an edge inside a flat region carries none, and collinear pieces of one edge count as one edge:
// how finely a flat face is meshed cannot matter (docs/reference/contact-law.md section 3.1 of the design papers; the
// construction follows the refinement-independent one measured there).
//
//   corner        a vertex at which the surface is not flat and not a straight edge
//   feature edge  a maximal straight run of convex mesh edges between two flat regions
//
// A solid is touched from outside: its concave edges are never nearest. A wall is touched from both sides, whatever the order of the
// vertices in its triangles: each fold of it is convex seen from one side, so all of them are feature edges. From which side a fold is
// convex its conormals tell: away from their sum.
//
// Ownership: every corner is owned by one of its triangles, every piece of a feature edge by one of its two.
// A list of triangle pairs closer than a margin therefore yields every feature pair closer than that margin,
// without a search: go through the pairs and take what the triangles own.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/geometry/triangle_mesh.hpp"

namespace scree {

enum class EdgeKind : std::uint8_t { flat = 0, convex = 1, concave = 2, boundary = 3, non_manifold = 4 };

/// Two faces belong to one flat region when their normals differ by less than this angle [rad]. It must stay
/// above the noise of single-precision files (6e-8 times mesh size over triangle size) and far below the
/// smallest real crease; a larger value would turn finely faceted curved surfaces into flat ones.
inline constexpr double kFlatAngle = 1e-4;

/// From where a surface is touched: a solid from outside alone, which the winding of its triangles tells; a wall from both sides.
enum class Sides : std::uint8_t { outside, both };

/// A maximal straight run of mesh edges, as indices: what it is made of follows from the mesh (see conormal).
struct FeatureEdge {
  std::int32_t vertex_a = 0, vertex_b = 0;  ///< vertices at its ends
  std::int32_t face[2] = {-1, -1};          ///< the triangles at its first piece that bound its convex side; -1: none, or not known
};

/// Unit, in the plane of the edge's face, across the edge, into the face; zero where there is no face.
Vec3 conormal(const TriangleMesh& mesh, const FeatureEdge& edge, int side);

/// About 38 bytes a triangle of a closed surface on which every edge is sharp and two of three are convex.
struct FeatureTable {
  std::vector<std::int32_t> corners;                 ///< vertex index of each corner, ascending
  std::vector<std::int32_t> corner_of;               ///< V: corner index of the vertex, or -1
  std::vector<FeatureEdge> edges;                    ///< no concave ones: they are never nearest
  std::vector<std::array<std::int32_t, 3>> edge_of;  ///< T x 3: feature edge that edge k -> k+1 is a piece of, or -1
  std::vector<std::uint16_t> marks;  ///< T: which features a triangle owns, and kinds of edges; read them by the functions below
  std::vector<std::int32_t> region;  ///< T: flat region of the triangle
  std::int32_t region_count = 0;

  /// Whether the triangle owns the corner at its vertex k; corner_of tells which one.
  bool owns_corner(std::size_t triangle, std::size_t k) const { return (marks[triangle] >> k & 1) != 0; }
  /// Feature edge owned through edge k -> k+1 of the triangle, or -1.
  std::int32_t owned_edge(std::size_t triangle, std::size_t k) const {
    return (marks[triangle] >> (3 + k) & 1) != 0 ? edge_of[triangle][k] : -1;
  }
  /// Kind of edge k -> k+1 of the triangle.
  EdgeKind edge_kind(std::size_t triangle, std::size_t k) const { return static_cast<EdgeKind>(marks[triangle] >> (6 + 3 * k) & 7); }

  /// Bytes held.
  std::size_t memory() const;
};

/// Finds corners, feature edges and flat regions.
///
/// in   mesh   any: closed, open or non-manifold. An edge of more than two faces counts as sharp and convex from outside; from both sides
///             the widest angle between its faces decides
/// in   sides  both: the winding of triangles does not matter, and no edge of two faces is concave. Edges that are convex by the winding
///             come first, with the indices that they have from outside
/// Fails: never.   Cost: O(T log T).   Threads: safe on distinct outputs.
FeatureTable find_features(const TriangleMesh& mesh, Sides sides = Sides::outside);

}  // namespace scree
