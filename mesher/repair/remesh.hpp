// A new, even mesh around what a mesh encloses.
#pragma once

#include "core/geometry/triangle_mesh.hpp"

namespace scree {

/// Remeshes with edges of about `edge_length`.
///
/// How: the winding number of the old mesh is taken on a body-centred cubic lattice, whose tetrahedra are cut where it
/// passes one half: new vertices lie on the old surface. The result is closed, manifold and oriented
/// whatever the old mesh was: holes are spanned, overlapping parts united, inner walls gone, cavities kept. Sharp edges are
/// chamfered by about half an edge length, and what is thinner than one may vanish.
/// Source: F. Labelle, J. Shewchuk, Isosurface stuffing, SIGGRAPH 2007 (lattice); A. Doi, A. Koide, An efficient method of
/// triangulating equi-valued surfaces by using tetrahedral cells, 1991.
/// in   mesh   finite, with its triangles turned outward as far as possible (see turn_outward)
/// in   edge_length   [m], > 0; throws UsageError when the lattice would have more than kMaxLatticePoints
/// Cost: O(lattice points log T); for closed meshes O(lattice points near the surface).
TriangleMesh remesh(const TriangleMesh& mesh, double edge_length);

inline constexpr double kMaxLatticePoints = 5e7;

/// Volume of the points around which the surface winds [m^3], sampled: that of overlapping parts once, and up to the gaps of an open mesh.
double enclosed_volume(const TriangleMesh& mesh);

}  // namespace scree
