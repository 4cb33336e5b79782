// The friction spring of one contact: laws/friction-inl.hpp in plain numbers.
#pragma once

#include <limits>

#include "solver/laws/real.hpp"

namespace scree {

/// Share of itself by which rounding moves the stiffness of a feature, times the overlap over the distance of the two bodies: the
/// stiffness goes with powers of the overlap up to the seventh, and the overlap is a difference of places. The worst of 1e7 values in a
/// stiff heap at rest is 35 epsilon.
inline constexpr double kStiffnessRounding = 64 * std::numeric_limits<double>::epsilon();

/// A normal that has come to the opposite of what it was, but for this, leaves its spring no direction: the spring goes. Far above
/// rounding, far below what a contact turns by in a step.
inline constexpr double kOppositeNormal = 1e-9;

#define SCREE_LAW inline
#include "solver/laws/friction-inl.hpp"
#undef SCREE_LAW

}  // namespace scree
