// Plane faces of bodies that lie against each other: where bonds of bodies placed face to face act.
#pragma once

#include <cstdint>
#include <map>

#include "decomposer/packing/packing_report.hpp"

namespace scree {

/// Of each piece by id, the id of the body that it was cut from.
using WholeBodies = std::map<std::int64_t, std::int64_t>;

/// Whether two bodies are pieces of the same one.
inline bool are_of_one_body(const WholeBodies& whole, std::int64_t a, std::int64_t b) {
  const auto found_a = whole.find(a), found_b = whole.find(b);
  return found_a != whole.end() && found_b != whole.end() && found_a->second == found_b->second;
}

/// Adds a bond for each pair of flat faces, one of each of two bodies of these materials, that face each other at a distance of at most
/// that of the section and have area in common: with the moments of the common area, half way between both, and the distance of the centres
/// of both bodies along the normal as height. Faces are those of convex outline; spheres have none. Pairs that are both fixed, and pieces
/// of one body, are left out. Returns how many.   Cost: pairs of bodies near each other times pairs of their faces.
std::size_t bond_faces_between(const CaseBond& given, double distance, const WholeBodies& whole, Scene& scene);

/// What a bond has of its section: stiffness by its height, strengths, damping.
void fill_bond(const CaseBond& given, Bond& bond);

}  // namespace scree
