// The rows of bodies for pairs of balls, compiled once for every instruction set (Highway's foreach_target). A vector of three numbers is
// read as four, the fourth of which begins the next body and is not used; behind the last body there is nothing to be read.
#include "solver/lanes/ball_rows.hpp"

#include <algorithm>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "solver/lanes/ball_rows.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace scree::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

HWY_NOINLINE void collect_rows(const ParticleSet& p, std::size_t begin, std::size_t end, BallRow* rows) {
  using Four = hn::CappedTag<double, 4>;
  constexpr std::size_t kWidth = hn::MaxLanes(Four());
  const Four d;
  const std::size_t whole = std::min(end, p.size() - 1);
  for (std::size_t i = begin; i < whole; ++i) {
    BallRow& row = rows[i];
    for (std::size_t j = 0; j < 4; j += kWidth) {
      hn::Store(hn::LoadU(d, &p.x[i].x + j), d, &row.x.v.x + j);
      hn::Store(hn::LoadU(d, &p.v[i].x + j), d, &row.v.v.x + j);
      hn::Store(hn::LoadU(d, &p.w[i].x + j), d, &row.w.v.x + j);
    }
  }
  for (std::size_t i = std::max(begin, whole); i < end; ++i) rows[i] = {{p.x[i]}, {p.v[i]}, {p.w[i]}};
}

}  // namespace scree::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace scree {
namespace {
HWY_EXPORT(collect_rows);
}

void collect_ball_rows(const ParticleSet& p, std::size_t begin, std::size_t end, BallRow* rows) {
  HWY_DYNAMIC_DISPATCH(collect_rows)(p, begin, end, rows);
}

}  // namespace scree
#endif
