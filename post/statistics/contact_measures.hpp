// What the contacts of a frame say of a group of particles: which bodies touch, how hard, in which directions; stress, chains.
#pragma once

#include <functional>
#include <vector>

#include "post/statistics/frame_view.hpp"

namespace scree {

/// A part of the packing. Empty functions and no region: all of it.
struct Group {
  std::string name;                        ///< "all", "region NAME", "material NAME", "shape NAME"
  const Region* region = nullptr;          ///< particles by centre, contacts by contact point
  std::int32_t material = -1, shape = -1;  ///< particles of it, contacts of which one body is
  bool holds(const FrameView& view, std::size_t row) const;
  bool holds_contact(const FrameView& view, std::size_t contact) const;
};

struct ContactMeasures {
  double coordination = 0, coordination_without_rattlers = 0, rattlers = 0;  ///< neighbours per particle; share of particles
  double points_per_particle = 0;                                            ///< contact points per particle
  double normal_force = 0, largest_normal_force = 0, tangential_force = 0;   ///< mean and largest over contact points [N]
  double tensile = 0, tensile_force = 0;  ///< share of contact points that pull, and how hard on average [N]
  Mat3 fabric, force_fabric;              ///< trace 1, NaN without contacts among particles
  double fabric_anisotropy = 0, force_fabric_anisotropy = 0;
  Mat3 stress;                                 ///< [Pa], compression positive
  double pressure = 0, deviatoric_stress = 0;  ///< trace / 3; sqrt(3/2 s:s) of the deviator [Pa]
  double cohesive_pressure = 0;                ///< the part of `pressure` of contacts that pull, as tension: >= 0 [Pa]
};

/// Measures of one group; what has no value in this frame is NaN.
///
/// How, and from where:
/// - Contact points that carry a normal force count, those that pull too. Neighbours of a particle are distinct bodies or walls.
///   Coordination number and rattlers (fewer than two neighbours): C. Thornton, Geotechnique 50 (2000) 43, eq. 2, for the particles of
///   the group.
/// - Fabric: mean of n n over contact points among particles (M. Satake, 1982); force fabric: sum of |f_n| n n over sum of |f_n|.
///   Anisotropy of a tensor F: a = sqrt(3/2 A:A) with A = 15/2 dev(F), so that a distribution of normals
///   (1 + A : n n) / 4 pi gives A back (G. Rothenburg, R. Bathurst 1989; N. Guo, J. Zhao, Comput. Geotech. 47 (2013) 1).
/// - Stress: sum of f_i (x_centre - x_contact)_j over the contacts of the particles, divided by `volume` (Love, Weber), the
///   part of each branch that lies in the region where there is one (I. Goldhirsch, Granular Matter 12 (2010) 239, with a
///   weight of 1 inside). Of walls only the particle's part counts. The symmetric part is given.
/// in   volume   [m^3], that the stress is taken over
ContactMeasures contact_measures(const FrameView& view, const Group& group, double volume);

/// Chains of strongly loaded particles.
struct ForceChains {
  std::vector<std::vector<std::int64_t>> chains;  ///< ids, each chain ascending, 3 or more
  std::size_t members = 0;
};

/// A particle is strongly loaded when its largest principal stress is above the mean of all loaded particles. Two that touch
/// belong to one chain when the line between their centres is within 45 degrees of the direction of that stress in both.
/// Chains are what hangs together so, with three particles or more; they may branch.
/// Source: J. Peters, M. Muthuswamy, J. Wibowo, A. Tordesillas, Phys. Rev. E 72 (2005) 041307, without its walk along a chain.
ForceChains force_chains(const FrameView& view);

/// Densities of normal and tangential force over the mean normal force of the frame, of the contact points that press: bins of equal width
/// from 0 to `largest`.
struct ForceDistribution {
  std::vector<double> normal, tangential;  ///< probability densities; NaN without contacts
};
ForceDistribution force_distribution(const FrameView& view, std::size_t bins, double largest);

/// sqrt(3/2 A:A) with A = 15/2 times the deviator of a tensor of trace 1.
double anisotropy(const Mat3& fabric);

}  // namespace scree
