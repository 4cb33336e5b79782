#include "solver/bodies/cell_motion.hpp"

#include "solver/bodies/kept_sum.hpp"

namespace scree {

void carry_with_cell(ParticleSet& p) {
  const UpperMatrix& growth = p.cell.growth();
  const Vec3& centre = p.cell.centre();
  for_each_awake_row(p, [&](std::size_t i) {
    const Vec3 change = growth.times(p.x[i] - centre);
    for (int k = 0; k < 3; ++k) add_keeping_rest(change[k], p.x[i][k], p.x_remainder[i][k]);
    p.x_listed[i] = p.cell.carried(p.x_listed[i]);
  });
}

void slow_with_cell(ParticleSet& p) {
  // what is taken is small, so that its rounding does not add up over the steps
  const UpperMatrix& taken = p.cell.taken();
  for_each_awake_row(p, [&](std::size_t i) { p.v[i] -= taken.times(p.v[i]); });
}

}  // namespace scree
