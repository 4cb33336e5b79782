#include "solver/step_size/frozen_step.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/error.hpp"

namespace scree {

StepSize frozen_step_size(const Settings& settings) {
  StepSize size;
  size.given = settings.step > 0;
  size.step = size.given ? settings.step : settings.duration > 0 ? settings.duration / 1000 : 1;
  size.limited_by = "nothing moves: a thousandth of the duration";
  return size;
}

void limit_frozen_step(const StepBound& bound, const Settings& settings, StepSize& size) {
  if (size.given) {
    if (!(size.step > bound.step)) return;
    throw UsageError("time.step = {:g} s is above the critical step {:.4g} s of the {}; use at most {:.3g} s, or leave it out", size.step,
                     bound.step, bound.reason, kFrozenShare * bound.step);
  }
  if (std::isinf(bound.step)) return;
  const double every = settings.frame_interval();
  const double longest = kFrozenShare * bound.step;
  size.step = every > 0 ? every / std::max(1.0, std::ceil(every / longest)) : longest;
  size.limited_by = bound.reason;
}

}  // namespace scree
