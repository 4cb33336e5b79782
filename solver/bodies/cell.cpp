#include "solver/bodies/cell.hpp"

#include "solver/bodies/kept_sum.hpp"

namespace scree {

namespace {

/// exp(z) - 1 of the little by which a step deforms a cell: the same bits on every machine, as those of a library are not.
/// Truncated after z^5: the rest is z^5 / 720 of the sum, 1e-18 at the largest z that a step may have (effects/cell).
UpperMatrix growth_by(const UpperMatrix& z) {
  const Vec3 one{1, 1, 1};
  UpperMatrix series{(1.0 / 120) * one, {}};
  for (const double of_term : {1.0 / 24, 1.0 / 6, 1.0 / 2, 1.0}) {
    series = z * series;
    series.diagonal = of_term * one + series.diagonal;
  }
  return z * series;
}

}  // namespace

void Cell::begin(const UpperMatrix& edges, const UpperMatrix& remainder) {
  if (!deforms_) {
    Vec3 first = periodicity_.period();
    if (!periodicity_.is_periodic(2)) first.z = edges.diagonal.z;
    centre_ = periodicity_.lower() + 0.5 * first;
  }
  deforms_ = true;
  set_edges(edges);
  remainder_ = remainder;
}

void Cell::set_edges(const UpperMatrix& edges) {
  edges_ = edges;
  Vec3 period = edges.diagonal;
  if (!periodicity_.is_periodic(2)) period.z = 0;
  periodicity_ = Periodicity::at_corner(centre_ - 0.5 * edges.diagonal, period, edges.above);
}

void Cell::deform(const UpperMatrix& rate, double dt) {
  growth_ = growth_by(dt * rate);
  taken_.above = -inverse({growth_.diagonal + Vec3{1, 1, 1}, growth_.above}).above;
  rate_of_step_.above = (1 / dt) * taken_.above;
  for (int k = 0; k < 3; ++k) {
    taken_.diagonal[k] = growth_.diagonal[k] / (1 + growth_.diagonal[k]);
    rate_of_step_.diagonal[k] = growth_.diagonal[k] / ((1 + growth_.diagonal[k]) * dt);
  }
  UpperMatrix now = edges_;
  const UpperMatrix change = growth_ * now;
  for (int k = 0; k < 6; ++k) add_keeping_rest(change[k], now[k], remainder_[k]);
  set_edges(now);
}

}  // namespace scree
