#include "core/storage/feed_rate.hpp"

#include <fmt/format.h>

namespace scree {

std::optional<std::string> FeedRate::fault() const {
  if (const auto of_table = rate.fault("rates")) return of_table;
  if (!(rate.least() >= 0)) return fmt::format("a rate of {:g}; expected at least 0", rate.least());
  if (!(largest() > 0)) return "no rate in it is above 0: nothing would come in";
  return {};
}

}  // namespace scree
