// Round numbers for the legend of a scale of colours.
#pragma once

#include <cmath>
#include <vector>

namespace scree {

/// Multiples of 1, 2 or 5 times a power of ten within a range: three to eight of them. Both ends where the range is empty or not finite.
inline std::vector<double> legend_ticks(double low, double high) {
  constexpr int kMin = 3;
  if (!(high > low) || !std::isfinite(high - low)) return {low, high};
  const double power = std::pow(10.0, std::floor(std::log10(high - low)));
  for (const double step : {power, 0.5 * power, 0.2 * power, 0.1 * power}) {
    constexpr double kRounding = 1e-9;  // an end that is a tick itself counts
    const double first = std::ceil(low / step - kRounding), last = std::floor(high / step + kRounding);
    if (last - first + 1 < kMin) continue;
    std::vector<double> ticks;
    for (double k = first; k <= last; ++k) ticks.push_back(k * step + 0.0);  // no -0
    return ticks;
  }
  return {low, high};
}

}  // namespace scree
