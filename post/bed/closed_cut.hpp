// A closed mesh without the part of it that lies beyond a plane about one place.
#pragma once

#include <cstddef>

#include "core/geometry/triangle_mesh.hpp"

namespace scree {

enum class CutOutcome {
  cut,      ///< the part is gone, and a flat face closes the mesh
  nothing,  ///< nothing lies beyond the plane
  deep,     ///< the part is deeper than allowed, as where the surface is hollow about the place: the mesh is unchanged
  refused   ///< the plane meets the mesh in a point of several sheets, or the part lies about the rim: the mesh is unchanged
};

/// Takes off the part beyond the plane that is connected with the place: of a body that is not convex other parts beyond the plane stay.
///
/// How: parts are sets of vertices beyond the plane that edges connect; the nearest to `place` by its vertices and the points of its rim is
/// taken. Triangles of the rim are cut, and polygons in the plane, with holes where the part has some, close the mesh. The points of the
/// rim are shared by both triangles of an edge, so the result is closed in its indices. A point of the rim within `snap` of a vertex
/// becomes that vertex, so no edge shorter than `snap` arises along an edge.
/// in   mesh      closed, outward
/// in   plane     a point of it [m]
/// in   normal    unit; beyond is where it points to
/// in   place     [m]
/// in   deepest   [m] how far beyond the plane the part may reach
/// in   snap      [m]
/// Cost: O(V + T), and the square of the number of corners of the rim.
CutOutcome cut_off(TriangleMesh& mesh, const Vec3& plane, const Vec3& normal, const Vec3& place, double deepest, double snap);

/// Merges the ends of edges shorter than `shortest`: what several cuts about one corner leave, which single precision would fold over.
///
/// How: shortest edges first. An edge stays where its ends have more than two neighbours in common, since the surface would then touch
/// itself, and where a triangle would turn over. No vertex moves: one end takes the place of the other.
/// in/out   mesh   closed     Cost: O(T log T).
void collapse_short_edges(TriangleMesh& mesh, double shortest);

/// Turns the longest edge of triangles lower than `lowest` over it, where both new triangles are higher: a vertex that lies along an edge
/// of a face makes such a triangle, which single precision would turn over.   Cost: O(T log T).
void flip_flat_triangles(TriangleMesh& mesh, double lowest);

/// How many edges do not lie in two triangles that run along them in opposite directions: 0 of a closed mesh.
std::size_t open_edges(const TriangleMesh& mesh);

}  // namespace scree
