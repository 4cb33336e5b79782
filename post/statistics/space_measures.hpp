// Where the bodies of a frame are and how they move: solid fraction, profiles, pair correlation, mixing, slopes.
#pragma once

#include <array>
#include <vector>

#include "post/statistics/contact_measures.hpp"

namespace scree {

/// Motion of a group. Velocity is the mean by mass; the granular temperature is the mean by mass of |v - velocity|^2 / 3, all
/// of it random motion only where the group has no gradient of velocity: see the profiles for that.
struct MotionMeasures {
  double particles = 0, mass = 0;                  ///< [-], [kg]
  Vec3 centre, velocity;                           ///< [m], [m/s]; NaN without particles
  double speed = 0, spin = 0;                      ///< means of |v| by mass [m/s] and of |w| by number [rad/s]
  double granular_temperature = 0;                 ///< [m^2/s^2]
  double temperature = 0, temperature_spread = 0;  ///< of the bodies, mean and standard deviation by mass [K]; NaN in a scene without heat
};
MotionMeasures motion_measures(const FrameView& view, const Group& group);

/// Energies of all particles of the frame [J]: kinetic, of translation and rotation; potential, 0 at the origin, without what a fluid
/// bears.
struct BodyEnergies {
  double kinetic = 0, potential = 0;
};
BodyEnergies energies_of_bodies(const FrameView& view);

/// Solid of the group in its region over the region's volume, from sample points.
double region_solid_fraction(const FrameView& view, const Region& region);

/// Layers across an axis of the container, or rings ('r') about the axis of a cylinder, the vertical middle line of a box. Layers across
/// the vertical axis are whole; others, and rings, lie between the heights below which 10 % and 90 % of all solid lie.
struct ProfileBins {
  char axis = 'z';           ///< x, y, z or r
  double low = 0, high = 0;  ///< [m]
  std::size_t count = 0;
  double width() const { return (high - low) / static_cast<double>(count); }
};
struct Profile {
  std::vector<double> solid_fraction, particles, granular_temperature;
  std::vector<Vec3> velocity;
};
/// Layers: solid by sample points over the volume of the container's part in the layer, whatever way the container lies; motion by the
/// centres in it. Granular temperature is about the mean velocity of the layer. Layers without particles: NaN for motion.
Profile profile(const FrameView& view, const ProfileBins& bins);

/// Pair correlation g(r) of the centres of particles, in shells of equal width up to `reach`.
///
/// How: pairs in a box, along each axis between the places below which 5 % and 95 % of the centres lie, so that the empty layer
/// at a wall does not count; each pair weighted by the share of the box from which it could be seen, so that the sides need no
/// correction: g = 1 for points that do not know of one another. Periodic axes have no sides; shells beyond half of a period are NaN.
/// Source: J. Ohser, D. Stoyan, Biometrical J. 23 (1981) 523 (translation correction).
std::vector<double> pair_correlation(const FrameView& view, std::size_t shells, double reach);

/// Lacey's mixing index of two kinds: 0 apart, 1 mixed at random. `kind` by row: 0, 1, or 2 for neither. Cells are cubes
/// that hold about 12 particles; NaN with fewer than 60. Source: P. Lacey, J. Appl. Chem. 4 (1954) 257, weighted by the particles in each
/// cell.
double mixing_index(const FrameView& view, const std::vector<std::uint8_t>& kind);

/// The same index of the same particles if their two kinds were wholly apart, in two layers along the axis that gives the least: what the
/// cells resolve, and not 0, since cells between the layers hold both. An index is to be read from this value on.
double mixing_index_apart(const FrameView& view, const std::vector<std::uint8_t>& kind);

/// How far each of three size classes is apart from the others: 1 less Lacey's index of the class against all other particles, 1 apart, 0
/// at random. Classes are the finest third of the particles by number, the coarsest third, and those between; diameters are those of
/// spheres of equal volume. Particles of one diameter are in one class: of two sizes, one class is empty, and where one size holds the
/// whole middle third, that is the middle class. NaN for an empty class, and where all are of one size.
std::array<double, 3> size_segregation(const FrameView& view);

/// Angle of the free surface to the horizontal [degrees].
/// cone: heights of the surface against the distance from the vertical line through the centre of mass, straight line through
/// those between 10 % and 90 % of the height of the heap; slope: plane through the surface of the middle 80 % of the plan.
/// The surface is where the highest sample point of a column lies; columns are one mean diameter wide.
/// NaN where there is no such surface, with the reason.
double angle_of_repose_cone(const FrameView& view, std::string* reason = nullptr);
double angle_of_repose_slope(const FrameView& view, std::string* reason = nullptr);

}  // namespace scree
