// What contacts and motion of the bodies of a periodic cell add up to: its stress times its volume.
#pragma once

#include <array>

#include "core/geometry/upper_matrix.hpp"

namespace scree {

struct RunState;

/// Sums over all ranks, of exact terms: no order of pairs or ranks changes a bit of them. Compression is positive. [J]
struct CellSums {
  /// Row i, column j: f_i r_j, f on A from B, r = x_a - x_b by the image that touches; of planes across z zz alone.
  std::array<Vec3, 3> contact;
  std::array<Vec3, 3> kinetic;  ///< m u_i u_j
  UpperMatrix lost;             ///< f_i r_j of damping and friction alone
  double at(int i, int j) const { return contact[static_cast<std::size_t>(i)][j] + kinetic[static_cast<std::size_t>(i)][j]; }
  /// What works against L; the rest has no L.
  UpperMatrix upper() const { return {{at(0, 0), at(1, 1), at(2, 2)}, {at(1, 2), at(0, 2), at(0, 1)}}; }
  /// The mean of both of each pair of shears: the stress. They differ by what turns the bodies.
  UpperMatrix symmetric() const { return {upper().diagonal, 0.5 * Vec3{at(1, 2) + at(2, 1), at(0, 2) + at(2, 0), at(0, 1) + at(1, 0)}}; }
};

/// Of the present forces and velocities. Collective.   Threads: parallel inside.
/// Source: the mean stress of Love and Weber, with the kinetic part; J. H. Irving, J. G. Kirkwood, J. Chem. Phys. 18 (1950) 817.
CellSums cell_sums(const RunState& s);
/// The same without what is not on a diagonal, which is 0 then: all that a step needs of a cell that is not sheared.
CellSums diagonal_cell_sums(const RunState& s);

}  // namespace scree
