// A closed mesh cut into the Voronoi cells of points in it.
#pragma once

#include "mesher/fracture/cut_cells.hpp"

namespace scree {

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
