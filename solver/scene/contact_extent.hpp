// How much of a shape can be in contact at once: what the derived step reckons with where stiffness grows with it.
#pragma once

#include <cstdint>

#include "solver/scene/solver_scene.hpp"

namespace scree {

/// Largest area that a body may have in contact at scale 1 [m^2]: its largest flat region, or the cap that its bounding sphere
/// presses into a layer of the given thickness.
double largest_contact_area(const SolverShape& shape, double thickness);

/// The largest number of triangles that come within `thickness` of a plane on which the mesh lies: of how many a face, an edge or a
/// corner of it consists for gather = "pairs".   Cost: O(T) for each of at most kSpringDirections planes.
std::int64_t triangles_on_plane(const TriangleMesh& mesh, double thickness);
/// So many normals of triangles and of vertices each are tried: all of them of a mesh that anybody would gather in pairs.
inline constexpr std::size_t kSpringDirections = 2000;

}  // namespace scree
