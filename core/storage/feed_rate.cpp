#include "core/storage/feed_rate.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace scree {

double FeedRate::amount(double elapsed) const {
  if (time.empty() || !(elapsed > 0)) return 0;
  double sum = rate.front() * std::clamp(elapsed, 0.0, std::max(0.0, time.front()));
  for (std::size_t i = 1; i < time.size(); ++i) {
    const double from = std::max(0.0, time[i - 1]), to = std::min(elapsed, time[i]);
    if (!(to > from)) continue;
    const double slope = (rate[i] - rate[i - 1]) / (time[i] - time[i - 1]);
    sum += (to - from) * (rate[i - 1] + slope * (0.5 * (from + to) - time[i - 1]));
  }
  return sum + rate.back() * std::max(0.0, elapsed - std::max(0.0, time.back()));
}

double FeedRate::largest() const { return rate.empty() ? 0 : *std::max_element(rate.begin(), rate.end()); }

std::optional<std::string> FeedRate::fault() const {
  if (time.size() != rate.size() || time.empty())
    return fmt::format("has {} times and {} rates; expected as many, and at least one", time.size(), rate.size());
  for (std::size_t i = 0; i < time.size(); ++i) {
    if (i > 0 && !(time[i - 1] < time[i])) return "the times must ascend";
    if (!(rate[i] >= 0)) return fmt::format("a rate of {:g}; expected at least 0", rate[i]);
  }
  if (!(largest() > 0)) return "no rate in it is above 0: nothing would come in";
  return {};
}

}  // namespace scree
