#pragma once

#include "core/geometry/triangle_mesh.hpp"

namespace scree {

/// Mass properties of a solid of density 1.
struct MassProperties {
  double volume = 0;         ///< [m^3], signed: negative for an inward mesh
  Vec3 centre;               ///< centre of mass, mesh axes [m]
  Mat3 inertia;              ///< about the centre of mass, mesh axes, density 1 [m^5]
  Vec3 principal_moments;    ///< ascending, density 1 [m^5]
  Quat body_from_principal;  ///< rotates a vector of the principal frame into mesh axes, right-handed
};

/// Volume, centre of mass and inertia of the solid that a closed mesh bounds.
///
/// How: exact polynomial integrals over the tetrahedra that each triangle spans with the centre of the
/// bounding box, so that a mesh far from the origin loses no digits.
/// Source: F. Tonon, Explicit exact formulas for the 3-D tetrahedron inertia tensor, J. Math. Stat. 1 (2005) 8.
/// in   mesh   closed, outward
/// Fails: never; the caller checks volume > 0 and closedness (see mesher).   Cost: O(T).
MassProperties mass_properties(const TriangleMesh& mesh);

/// Of a ball of the given radius [m] about the origin.
MassProperties sphere_mass_properties(double radius);

/// Fills principal_moments and body_from_principal from inertia.
void find_principal_frame(MassProperties& mass);

}  // namespace scree
