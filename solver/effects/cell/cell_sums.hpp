// What contacts and motion of the bodies of a periodic cell add up to: its stress times its volume.
#pragma once

#include <array>

#include "core/geometry/vec3.hpp"

namespace scree {

struct RunState;

/// Sums over all ranks, of exact terms: no order of pairs or ranks changes a bit of them. Compression is positive. [J]
struct CellSums {
  std::array<Vec3, 3> contact;  ///< row i, column j: f_i r_j, f on A from B, r = x_a - x_b by the image that touches
  std::array<Vec3, 3> kinetic;  ///< m u_i u_j
  Vec3 lost;                    ///< diagonal of f_i r_j of damping and friction alone
  Vec3 diagonal() const { return {contact[0].x + kinetic[0].x, contact[1].y + kinetic[1].y, contact[2].z + kinetic[2].z}; }
};

/// Of the present forces and velocities. Collective.   Threads: parallel inside.
/// Source: the mean stress of Love and Weber, with the kinetic part; J. H. Irving, J. G. Kirkwood, J. Chem. Phys. 18 (1950) 817.
CellSums cell_sums(const RunState& s);
/// The same without what is not on a diagonal, which is 0 then: all that a step needs.
CellSums diagonal_cell_sums(const RunState& s);

}  // namespace scree
