// Plane faces of bodies that lie against each other: where bonds of bodies placed face to face act.
#pragma once

#include <vector>

#include "decomposer/packing/build_scene.hpp"

namespace scree {

/// Adds a bond for each pair of flat faces, one of each of two bodies of these materials, that face each other at a distance of at most
/// that of the section and have area in common: with the moments of the common area, half way between both, and the distance of the centres
/// of both bodies along the normal as height. Faces are those of convex outline; spheres have none. Bodies of both ends fixed are left out.
/// Returns how many.   Cost: pairs of bodies near each other times pairs of their faces.
std::size_t bond_faces_between(const CaseBond& given, double distance, Scene& scene);

/// What a bond has of its section: stiffness by its height, strengths, damping.
void fill_bond(const CaseBond& given, Bond& bond);

}  // namespace scree
