// Cells of a very large wall or body: a body that meets it at distant places has one potential per cell, so that distant contacts do
// not share stiffness. Source: docs/reference/contact-law.md section 4, weakness 1.
//
// Its frame is divided into cubes of side l, each with a smooth weight w (product of switches in x, y and z, flat over
// the middle half of the side); the weights of all cubes sum to 1 everywhere. A feature enters the potential of a cell with
// a_j w^(q / (p + 1)), p the exponent of the force: the energy of a single feature is then exactly its U(d), wherever it is.
// The weight is taken at a place that is fixed either in the body (its corner, its centre if a sphere) or in the wall (its
// corner, the middle of its edge), so that its gradient is exact. Cells are meant to be of about half a body's length; at a
// tenth of it energy is still kept, but only with far smaller steps.
//
// Where both bodies of a pair have cells, the larger ones count; where both are of the same size, the energy is the mean of that with
// the cells of A and that with the cells of B, so that which of the two is A does not matter.
#pragma once

#include <vector>

#include "solver/features/pair_features.hpp"

namespace scree {

/// The side of a pair that has the cells.
enum class CellSide { none, a, b, both };

/// A feature's part in the potential of one cell.
struct CellShare {
  std::int64_t cell;     ///< number of the cell within its side
  std::int32_t feature;  ///< index into the pair's features
  double weight;         ///< w, > 0
  Feature6 gradient;     ///< of w, for a virtual motion of A against B, A frame
};

/// Shares of all features of a pair, sorted by cell, then feature.
///
/// in   size   of a cell's side [m], > 0     in  side   in which they are fixed, not none; B may be a wall
void find_cell_shares(const PairBody& a, const PairBody& b, double size, CellSide side, const std::vector<ContactFeature>& features,
                      std::vector<CellShare>& shares);

/// Part of the energy that the cells of one side have.
inline double energy_share(CellSide side) { return side == CellSide::both ? 0.5 : 1; }

}  // namespace scree
