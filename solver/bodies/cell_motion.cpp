#include "solver/bodies/cell_motion.hpp"

#include "solver/bodies/kept_sum.hpp"

namespace scree {

void carry_with_cell(ParticleSet& p) {
  const Vec3 &growth = p.cell.growth(), &centre = p.cell.centre();
  for_each_awake_row(p, [&](std::size_t i) {
    for (int k = 0; k < 3; ++k) add_keeping_rest(growth[k] * (p.x[i][k] - centre[k]), p.x[i][k], p.x_remainder[i][k]);
    p.x_listed[i] = p.cell.carried(p.x_listed[i]);
  });
}

void slow_with_cell(ParticleSet& p) {
  const Vec3& growth = p.cell.growth();
  // what is taken is small, so that its rounding does not add up over the steps
  const Vec3 taken{growth.x / (1 + growth.x), growth.y / (1 + growth.y), growth.z / (1 + growth.z)};
  for_each_awake_row(p, [&](std::size_t i) { p.v[i] -= Vec3{taken.x * p.v[i].x, taken.y * p.v[i].y, taken.z * p.v[i].z}; });
}

}  // namespace scree
