// The numbers by which papers describe the shape of a particle.
#pragma once

#include <string>
#include <vector>

#include "core/geometry/mass_properties.hpp"
#include "core/geometry/triangle_mesh.hpp"

namespace scree {

/// All of a closed mesh at density 1. None but the lengths, sieve opening, volume, area and moments depends on scale.
struct Descriptors {
  double volume = 0;           ///< [m^3]
  double area = 0;             ///< [m^2]
  double volume_diameter = 0;  ///< of the ball of equal volume [m]
  double area_diameter = 0;    ///< of the ball of equal surface [m]
  double hull_volume = 0;      ///< [m^3]
  double sphericity = 0;       ///< surface of the ball of equal volume over surface (Wadell); ball 1, cube 0.806
  double convexity = 0;        ///< volume over that of the convex hull
  Vec3 lengths;                ///< L >= I >= S: sides of the box along the principal axes of inertia [m]
  double elongation = 0;       ///< I / L (Zingg)
  double flatness = 0;         ///< S / I (Zingg)
  double angularity = 0;       ///< see describe
  double sieve_opening = 0;    ///< side of the smallest square opening that it passes [m], see sieve_opening.hpp
  double sieve_ratio = 0;      ///< volume_diameter / sieve_opening: by which sieve openings become diameters of equal volume
  Vec3 principal_moments;      ///< ascending, density 1 [m^5]
};

/// Describes a solid.
///
/// How: angularity is the mean angle by which the surface turns at its convex edges, weighted by edge length times angle,
/// over pi: 0 for a smooth body, 1/2 for a box, 0.608 for a tetrahedron. Flat edges weigh nothing, so that the meshing of
/// faces does not matter; a smooth surface tends to 0 as its mesh is refined.
/// Source: H. Wadell, J. Geol. 40 (1932) 443; T. Zingg, Schweiz. Mineral. Petrogr. Mitt. 15 (1935) 39; S. Blott, K. Pye,
/// Particle shape: a review, Sedimentology 55 (2008) 31.
/// in   mesh   closed, outward (see check_mesh).   Cost: O(T log T).
Descriptors describe(const TriangleMesh& mesh);

/// Heads and values in the order of the CSV.
struct DescriptorColumn {
  const char* name;
  const char* unit;
  double (*value)(const Descriptors&);
};
const std::vector<DescriptorColumn>& descriptor_columns();

/// "mean 0.81, standard deviation 0.02, from 0.77 to 0.85" of elongation, flatness, sphericity, convexity, angularity and
/// diameter, one line each.
std::string distribution_of(const std::vector<Descriptors>& all);

}  // namespace scree
