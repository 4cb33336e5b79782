// Cells of a very large wall or body: a body that meets it at distant places has one potential per cell, so that distant contacts do
// not share stiffness. Source: docs/reference/contact-law.md section 4, weakness 1.
//
// Its frame is divided into cubes of side l, each with a smooth weight w (product of switches in x, y and z, flat over
// the middle half of the side); the weights of all cubes sum to 1 everywhere. A feature enters the potential of a cell with
// a_j w^(q / (p + 1)), p the exponent of the force: the energy of a single feature is then exactly its U(d), wherever it is.
// The weight is taken at a place that is fixed either in the body (its corner, its centre if a sphere) or in the wall (its
// corner, the middle of its edge), so that its gradient is exact. Cells are meant to be of about half a body's length; at a
// tenth of it energy is still kept, but only with far smaller steps.
#pragma once

#include <vector>

#include "solver/contact/pair_features.hpp"

namespace scree {

/// A feature's part in the potential of one cell.
struct CellShare {
  std::int64_t cell;     ///< number of the cell within the wall
  std::int32_t feature;  ///< index into the pair's features
  double weight;         ///< w, > 0
  Feature6 gradient;     ///< of w, for a virtual motion of A against B, A frame
};

/// Shares of all features of a pair, sorted by cell, then feature.
///
/// in   side   of the cells [m], > 0     in  cells_on_a  they are fixed in A; else in B, which may be a wall
void find_cell_shares(const PairBody& a, const PairBody& b, double side, bool cells_on_a, const std::vector<ContactFeature>& features,
                      std::vector<CellShare>& shares);

}  // namespace scree
