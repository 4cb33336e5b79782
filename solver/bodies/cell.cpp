#include "solver/bodies/cell.hpp"

#include <algorithm>
#include <cmath>

#include "solver/bodies/kept_sum.hpp"

namespace scree {

namespace {

/// exp(z) - 1 of the little by which a step deforms a cell: the same bits on every machine, as those of a library are not.
/// Truncated after z^5: the rest is z^5 / 720 of the sum, 1e-18 at the largest z that a step may have (effects/cell).
double growth_by(double z) { return z * (1 + z * (1.0 / 2 + z * (1.0 / 6 + z * (1.0 / 24 + z * (1.0 / 120))))); }

}  // namespace

double Cell::largest_of(const Vec3& v) { return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}); }

void Cell::begin(const Vec3& period, const Vec3& remainder) {
  if (!deforms_) centre_ = periodicity_.lower() + 0.5 * periodicity_.period();
  deforms_ = true;
  periodicity_ = Periodicity::about(centre_, period);
  remainder_ = remainder;
}

void Cell::deform(const Vec3& rate, double dt) {
  Vec3 period = periodicity_.period();
  for (int k = 0; k < 3; ++k) {
    growth_[k] = growth_by(rate[k] * dt);
    rate_of_step_[k] = growth_[k] / ((1 + growth_[k]) * dt);
    add_keeping_rest(growth_[k] * period[k], period[k], remainder_[k]);
  }
  periodicity_ = Periodicity::about(centre_, period);
}

}  // namespace scree
