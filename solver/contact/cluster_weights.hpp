// What vertices that lie in clusters count for in D = (sum a_j d_j^8)^(1/8): so much that D is the overlap d of a smooth body, at every
// depth and however finely it is meshed.
//
// On a smooth surface of reduced radius R* the features of a contact lie within sqrt(2 R* d). With weights whose radius r = c sqrt(R eps)
// is fixed (scene/density_weights.hpp), ever more of them lie within it as d grows, and D = d (d / d0)^(1/8). With a radius that follows D,
// r = c sqrt(R D), their number stays the same: of vertices of density rho with w = 3 / (pi r^2 rho), the depths d - s^2 / (2 R*) give
//
//   D^8 = (2/3) R* d^9 / r^2   for each of the two bodies, so   D^9 = 2 / (3 c^2) d^9 (R*/R_1 + R*/R_2) = d^9   for c^2 = 2/3,
//
// whatever the radii of the two. Static tables give the cluster of a vertex at D = eps, b_j = 1 / w_j - 1; a cluster grows with the area of
// its radius, so that
//
//   a_j(D) = fade_j / (1 + b_j D / eps)
//
// and D is the root of D^8 = sum a_j(D) d_j^8. An isolated vertex has b = 0. The root is an exact function of the poses; its derivatives
// are those at fixed weights times `cluster_share` = 1 / (1 + m / 8), m the mean of b D / (eps + b D) over the sum.
// What the critical step is found from (linearise of the models) takes the settled weights as fixed: its slopes of D are too large by at
// most an eighth, on the safe side.
#pragma once

#include "solver/contact/pair_force.hpp"

namespace scree {

/// Gives features their weights with their clusters.
/// in       eps       margin of one body [m]
/// in       follow    the radius follows D; else D is eps for this purpose, as cells, a barrier and a law that pulls need it
/// in/out   features  their weights, the gradients of the weights, and cluster_share
/// Cost: 5 passes over the features; nothing where no feature has a cluster.   Fails: never.
void solve_weights(double eps, bool follow, PairFeatures& features);

/// The same where the bodies attract each other: the attraction has clusters of its own, of tables made for its range, with a radius that
/// follows its own D, of how far features are within the range. Features beyond touch have no part in the push.
/// out      features  pull_weight and pull_share too; pull_weight is empty where no feature has a cluster
void solve_weights_separately(double eps, bool follow, const PullView& pull, PairFeatures& features);

}  // namespace scree
