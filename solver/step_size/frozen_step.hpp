// The step of a scene whose bodies stay as they are (heat.frozen): no contact limits it, effects do.
#pragma once

#include "core/storage/scene.hpp"
#include "solver/state/step_clock.hpp"

namespace scree {

/// Share of the critical step of an effect that the step of a frozen scene takes. Heun's error of the fastest exchange of heat is then 6 %
/// in its own time, and falls with the square of how much slower another one is. A bed of 8849 balls heated from above
/// (workflows/heated-bed), compared with steps six times shorter: 2e-4 of the largest change of temperature after 31 steps, 3e-6 after 155,
/// 3e-8 after 1240.
inline constexpr double kFrozenShare = 0.25;

/// Of a scene whose bodies stay as they are, before contacts are known: that of the case, or a guess.
StepSize frozen_step_size(const Settings& settings);
/// The same once they are: kFrozenShare of the bound, and a whole number of steps between two frames. A given step stays.
/// Throws UsageError when a given step is above the bound.
void limit_frozen_step(const StepBound& bound, const Settings& settings, StepSize& size);

}  // namespace scree
