// A closed mesh cut into the Voronoi cells of points in it.
#pragma once

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/geometry/triangle_mesh.hpp"
#include "mesher/fracture/voronoi_cells.hpp"

namespace scree {

/// One face between two cells: a polygon with holes, in the bisector plane of their generators.
struct CutFace {
  std::int32_t cell_a = 0, cell_b = 0;           ///< cell_a < cell_b
  std::vector<std::vector<std::int32_t>> loops;  ///< vertices; the rim, then holes; seen from b, the rim is counter-clockwise
  std::vector<Triangle> triangles;               ///< the same area; counter-clockwise seen from b
};

/// The cells as closed surfaces that share their vertices and faces: what one cell has, the one behind it has, turned round.
struct CutMesh {
  std::vector<Vec3> vertices;               ///< [m] those of the mesh first
  std::vector<std::vector<Triangle>> skin;  ///< of each cell: its share of the mesh's surface, outward
  std::vector<CutFace> faces;               ///< by cell_a, cell_b
};

/// Cuts a mesh into the cells of generators. The mesh is closed and manifold along every edge, faces outward and does not pass through
/// itself; cavities, tunnels and several components are as good as a ball.
///
/// How: every vertex of the result is named by what meets in it, and lies on one side of a plane or the other by an exact sign. Each
/// triangle is cut by the planes of the cells that it passes through: what remains is convex. The edges that a bisector plane leaves on the
/// surface, together with those pieces of Voronoi edges that lie in the body, are the rim of the faces in that plane. A Voronoi edge is in
/// the body between the triangles through which it enters and leaves. Faces are then cut into triangles, once for both sides. in   mesh
/// coordinates within 1 in size times `size`, a power of two Fails: DegenerateCut (move the generators and begin again); InputError where
/// the surface passes through itself. Cost: O(triangles x cells that they pass through x faces of a cell).
CutMesh cut_mesh(const TriangleMesh& mesh, double size, const Generators& generators);

}  // namespace scree
