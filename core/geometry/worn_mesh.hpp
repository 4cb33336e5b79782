// How a surface recedes where it is worn: vertices move, the topology stays.
#pragma once

#include <vector>

#include "core/geometry/triangle_mesh.hpp"

namespace scree {

/// What a mesh loses at one time.
struct WearOfMesh {
  std::vector<double> volume;       ///< T, >= 0: that each triangle is to lose, in units of the mesh cubed
  std::vector<signed char> pushed;  ///< T: 1: pressed along its normal, -1: against it, 0: not known. What is pressed recedes that way
};

/// Vertices of the mesh after it has lost the sum of the volumes.
///
/// How: a vertex takes a third of the volume of each of its triangles, and moves along the mean of the ways of these triangles, weighted by
/// those volumes, so that a crease between a face that is worn and one that is not stays in the latter. To the first order it moves by its
/// volume over a third of the area about it across that way. A common factor then makes the swept volume exact: that of a triangle whose
/// corners move in straight lines is the integral of its area times the mean displacement, a polynomial that Simpson's rule takes exactly.
/// Of a closed mesh this is the change of its volume.
/// in   mesh   any; open sheets move to the side away from what presses on them
/// Fails: throws InputError saying why, where a triangle would turn over or vanish, or no factor gives the volume (the mesh is too coarse
/// or too thin for so much wear at a time).   Cost: O(T).   Threads: safe.
std::vector<Vec3> worn_vertices(const TriangleMesh& mesh, const WearOfMesh& wear);

/// The volume that a mesh lost on the way of its vertices to other places, positive where triangles recede along the sides given.
/// in   to     V   in  pushed   T, of the triangles; 0 counts as -1, as of a closed mesh
double swept_volume(const TriangleMesh& mesh, const std::vector<Vec3>& to, const std::vector<signed char>& pushed);

}  // namespace scree
