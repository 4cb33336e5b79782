#include "solver/neighbours/travel_bounds.hpp"

#include "solver/bodies/body_passes.hpp"

namespace scree {

namespace {

constexpr double kSumRounding = 1 + 1e-9;  // far above that of the sums below

/// Places go with a cell that deforms, and ways grow by what its stretch does to a branch.   in   begin, end   rows
void carry_listed_places(const Cell& cell, double branch, std::size_t begin, std::size_t end, std::vector<Vec3>& x,
                         std::vector<double>& way) {
  if (!cell.deforms()) return;
#pragma omp parallel for schedule(static)
  for (std::size_t i = begin; i < end; ++i) {
    x[i] = cell.carried(x[i]);
    way[i] += kSumRounding * 0.5 * cell.growth().largest_stretch() * branch;
  }
}

}  // namespace

void TravelBounds::restart(const ParticleSet& p, double branch) {
  branch_ = branch;
  way_.assign(p.size(), 0.0);
  x_ = p.x;
  q_ = p.q;
}

void TravelBounds::add_motion_of_owned(const ParticleSet& p) {
  carry_listed_places(p.cell, branch_, 0, p.owned, x_, way_);
#pragma omp parallel
  for_awake_rows_of_thread(p, [&](std::size_t begin, std::size_t end) {
    if (p.cell.periodicity().any()) {
      for (std::size_t i = begin; i < end; ++i) add_motion(p, i);
    } else {
      add_way_of_rows(p, kSumRounding, begin, end, x_, q_, way_);
    }
  });
}

void TravelBounds::add_to_balls(const ParticleSet& p, double way) {
  const auto count = static_cast<std::ptrdiff_t>(p.owned);
#pragma omp parallel for schedule(static)
  for (std::ptrdiff_t i = 0; i < count; ++i) {
    const auto row = static_cast<std::size_t>(i);
    way_[row] += kSumRounding * way;
    x_[row] = p.x[row];
  }
}

void TravelBounds::add_motion_of_ghosts(const ParticleSet& p) {
  carry_listed_places(p.cell, branch_, p.owned, p.size(), x_, way_);
#pragma omp parallel for schedule(static)
  for (std::size_t i = p.owned; i < p.size(); ++i) add_motion(p, i);
}

void TravelBounds::add_motion(const ParticleSet& p, std::size_t i) {
  Vec3 shift = p.x[i] - x_[i];
  if (const Periodicity& periodicity = p.cell.periodicity(); periodicity.any()) shift = periodicity.nearest(shift);
  x_[i] = p.x[i];
  if (p.ball_radius[i] > 0) {  // as it turns, its surface stays where it is
    way_[i] += kSumRounding * length(shift);
    return;
  }
  // A point at R from the centre moves by 2 R sin(angle / 2), two unit quaternions differ by 2 sin(angle / 4).
  const Quat &q = p.q[i], &old = q_[i];
  const double w = q.w - old.w, x = q.x - old.x, y = q.y - old.y, z = q.z - old.z;
  way_[i] += kSumRounding * (length(shift) + 2 * p.radius[i] * std::sqrt(w * w + x * x + y * y + z * z));
  q_[i] = q;
}

}  // namespace scree
