// A closed mesh moved inwards by a margin: with the margin around it, the body is as large as it was drawn, its edges and corners rounded.
//
// Every vertex moves by the shortest way delta with n_i . delta = -eps for the distinct normals n_i of its faces: exact for three or fewer,
// so that flat faces stay flat and cubes cubes; least squares for more. No vertex moves by more than kLongestMove eps: needle corners
// would ask for 60.
// What is thinner than two margins cannot be inset fully: corner i goes t_i of its way, from 1 down, reduced around every triangle that
// turns over or crosses another and evened out over neighbours, until nothing does. All corners of a flat face have one t, and so it
// stays flat. t = 0 is the mesh as drawn, so this ends.
// Of a face of more than three corners the outline counts: where it is sound and the triangles that it was drawn with are not, as those of
// a face that is not convex may be, it has others (face_outline.hpp).
// Only corners have ways and shares; what lies between them on straight edges and flat faces follows (flat_faces.hpp), so that how finely a
// surface is split does not matter.
// Source: docs/reference/contact-law.md section 7; sphero-polyhedra: Pournin & Liebling, Powders and Grains 2005, 1375.
#pragma once

#include <vector>

#include "core/geometry/triangle_mesh.hpp"

namespace scree {

inline constexpr double kLongestMove = 4;  ///< of a vertex, over the margin

struct Inset {
  TriangleMesh mesh;          ///< triangles as they were, or others in a face where they would turn over: as many, of the same vertices
  std::vector<double> share;  ///< V: t of each corner; of other vertices the least of their faces' corners
};

/// in   mesh   closed, outward; what it crosses itself with stays where it is drawn     in   margin   [m], > 0
/// Fails: never.   Cost: a check for crossings for each round of reductions, O(T log T); one where nothing is thin. And vertices times
/// triangles of each face that has other triangles: half a second for one of 10 000.
Inset inset(const TriangleMesh& mesh, double margin);

/// How far the surface at `margin` around an inset mesh is from the one that was drawn: mean over the area, and largest [m].
struct InsetDeviation {
  double mean = 0, largest = 0;
};
/// Cost: seven distances a triangle; more along edges of triangles that are larger than the margin.
InsetDeviation deviation_of_inset(const TriangleMesh& drawn, const TriangleMesh& moved, double margin);

}  // namespace scree
