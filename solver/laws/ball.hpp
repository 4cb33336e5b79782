// The contact of a ball, in plain numbers: laws/ball-inl.hpp.
#pragma once

#include <cmath>

#include "solver/laws/damping.hpp"
#include "solver/laws/friction.hpp"
#include "solver/laws/real.hpp"
#include "solver/laws/rolling.hpp"

namespace scree {

/// 1 over sqrt(2 U / (F D)) of a Hertz contact, whose U is 2/5 F D.
inline constexpr double kHertzEnergyFactor = 1.118033988749894848;

#define SCREE_LAW inline
#include "solver/laws/ball-inl.hpp"
#undef SCREE_LAW

}  // namespace scree
