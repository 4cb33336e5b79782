// A barrier that keeps surfaces apart: a potential of each feature's gap that starts at a fifth of the margins and has no end.
//     U(g) = -k_b (g - h)^2 ln(g / h) below h = kBarrierShare of the margin sum
// It is twice continuously differentiable and diverges at touch, so that energy cannot close the gap. Features do not share it:
// where several come that near, each brings its own.
// Source: Li et al., Incremental Potential Contact, ACM Trans. Graph. 39 (2020) 49, eq. 6; docs/reference/validation-plan.md section 3.5.
#pragma once

#include <algorithm>
#include <cmath>

#include "solver/laws/pair_law.hpp"

namespace scree {

inline constexpr double kBarrierShare = 0.2;
/// A run is stopped at this share of the barrier's reach: curvature is 1e6 k_b there, beyond what a step can follow.
inline constexpr double kMinBarrierGap = 1e-3;
/// The derived step resolves the curvature at this share of the reach, 24 k_b; the critical step of log.csv that of the present gaps.
inline constexpr double kBarrierStepGap = 0.25;

struct Barrier {
  double stiffness, reach;  ///< k_b [N/m], h [m]
  explicit Barrier(const PairLaw& law) : stiffness(law.barrier), reach(kBarrierShare * law.margin) {}
  double ratio(double gap) const { return std::max(gap / reach, kMinBarrierGap); }
  bool acts(double gap) const { return gap < reach; }
  double energy(double gap) const {
    const double r = ratio(gap);
    return -stiffness * reach * reach * (1 - r) * (1 - r) * std::log(r);
  }
  /// -dU/dg, > 0
  double force(double gap) const {
    const double r = ratio(gap);
    return stiffness * reach * (1 - r) * ((1 - r) / r - 2 * std::log(r));
  }
  /// d2U/dg2, > 0
  double curvature(double gap) const {
    const double r = ratio(gap), s = (1 - r) / r;
    return stiffness * (s * s + 4 * s - 2 * std::log(r));
  }
};

}  // namespace scree
