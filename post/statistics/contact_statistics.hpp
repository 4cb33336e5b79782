// What a frame's contacts say about the packing: which bodies touch, how hard, and in which directions.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <unordered_set>
#include <vector>

#include "core/storage/frame_file.hpp"

namespace scree {

/// Mean and quantiles of a sample; zero when it is empty.
struct Distribution {
  std::size_t count = 0;
  double mean = 0, smallest = 0, largest = 0;
  double q05 = 0, q25 = 0, median = 0, q75 = 0, q95 = 0;
};

/// Quantiles are interpolated linearly between order statistics (definition 7 of Hyndman and Fan, 1996).
Distribution distribution_of(std::vector<double> sample);

struct ContactStatistics {
  double time = 0;                     ///< [s]
  std::size_t particles = 0;           ///< bodies that are free to move
  std::size_t contacts = 0;            ///< contact points that carry a normal force
  std::size_t pairs_of_particles = 0;  ///< pairs of particles with at least one contact point
  std::size_t pairs_with_walls = 0;    ///< particle and wall (or fixed body)
  std::size_t rattlers = 0;            ///< particles with fewer than two neighbours, walls included
  double coordination = 0;             ///< neighbours per particle
  double coordination_without_rattlers = 0;
  double contacts_per_particle = 0;    ///< contact points per particle: several per neighbour for meshes
  double max_overlap_ratio = 0;        ///< overlap over the sum of margins; 0 when no margin is stored
  Distribution contact_force;          ///< normal force per contact point [N]
  Distribution pair_force;             ///< size of the resultant force per pair [N]
  std::vector<double> contact_forces;  ///< the sample itself [N]
  Mat3 fabric;                         ///< mean of n n^T over contacts among particles; trace 1, or 0 when none
  Mat3 fabric_with_walls;              ///< the same over all contacts
  Vec3 fabric_principal;               ///< eigenvalues of fabric, ascending
};

/// Statistics of one frame.
///
/// How: contact points that carry a normal force count. Coordination is (2 N_pp + N_pw) / N over distinct pairs;
/// without rattlers it is (2 N_pp + N_pw - N_1) / (N - N_0 - N_1), where N_0 and N_1 particles have no and one
/// neighbour. Fabric is the mean dyad of the unit normals.
/// Source: C. Thornton, Numerical simulations of deviatoric shear deformation of granular media, Geotechnique 50
/// (2000) 43, eq. 2; M. Satake, Fabric tensor in granular materials, 1982.
/// in   boundary   ids of walls and fixed bodies
/// Cost: O(n log n) of the contacts.
ContactStatistics contact_statistics(const Frame& frame, const std::unordered_set<std::int64_t>& boundary);

nlohmann::json json_of(const ContactStatistics& statistics);
/// A readable table of some lines.
std::string table_of(const ContactStatistics& statistics);

}  // namespace scree
