// A bond: what holds two bodies together over a plane face until it breaks. The law is in solver/laws/bond.hpp.
#pragma once

#include <cstdint>
#include <vector>

#include "core/geometry/vec3.hpp"
#include "core/storage/h5.hpp"

namespace scree {

/// A strength that a bond does not have.
inline constexpr double kNeverBreaks = 1e300;

/// As the scene has it, at the scale of its bodies. The two frames lie on each other where the bond is at rest: x along the normal of the
/// face from a to b, y and z along its principal axes, y that of moment_1.
struct Bond {
  std::int64_t a = 0, b = 0;              ///< ids of bodies, a < b
  Vec3 point_a, point_b;                  ///< centroid of the face from the centre of each body, in the axes of its mesh [m]
  Quat frame_a, frame_b;                  ///< axes of the bond to the axes of each mesh
  double area = 0;                        ///< [m^2]
  double moment_1 = 0, moment_2 = 0;      ///< [m^4] about y and z
  double height = 0;                      ///< [m] of the bonded material between both bodies
  double rim_radius = 0;                  ///< [m]
  double normal_stiffness = 0;            ///< k_n [N/m^3]: stress over displacement
  double tangential_stiffness = 0;        ///< k_t [N/m^3]
  double tension = kNeverBreaks;          ///< [Pa] at the rim
  double cohesion = kNeverBreaks;         ///< [Pa]
  double friction = 0;                    ///< [-] tangent of the angle of friction of the material
  double fracture_energy = kNeverBreaks;  ///< [J/m^2]
  double damping = 0;                     ///< [-] share of critical damping of each of its motions
};

/// Group /bonds of a scene file; bond n is row n.
void write_bonds(const h5::Group& group, const std::vector<Bond>& bonds);
/// Fails: InputError for what is missing, of another size, or cannot be a bond.
std::vector<Bond> read_bonds(const h5::Group& group);

}  // namespace scree
