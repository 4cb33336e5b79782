#include "solver/run/schedule.hpp"

#include <algorithm>
#include <cmath>

namespace scree {

Schedule make_schedule(const Settings& settings, double step_size, double longest_row, double by_clock) {
  const auto steps = [&](double interval) { return std::max<std::int64_t>(1, std::llround(interval / step_size)); };
  Schedule s;
  s.last = static_cast<std::int64_t>(std::ceil(settings.duration / step_size - 1e-9));
  const double every = settings.frame_interval();
  s.frame = every > 0 ? steps(every) : 1;
  constexpr std::int64_t kLogRowsPerFrame = 10;
  s.log =
      std::max<std::int64_t>(1, std::min(s.frame / kLogRowsPerFrame, static_cast<std::int64_t>(std::min(longest_row / step_size, 0x1p53))));
  s.checkpoint = settings.checkpoint_every > 0 ? steps(settings.checkpoint_every) : 0;
  s.checkpoint_clock = settings.checkpoint_every == 0 && settings.checkpoint_by_clock ? by_clock : 0;
  return s;
}

}  // namespace scree
