#include "core/storage/time_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/base/error.hpp"
#include "core/storage/json_object.hpp"

namespace scree {

double TimeTable::at(double when) const {
  if (time.empty()) return 0;
  const auto next = std::upper_bound(time.begin(), time.end(), when);
  if (next == time.begin()) return value.front();
  if (next == time.end()) return value.back();
  const auto i = static_cast<std::size_t>(next - time.begin());
  const double share = (when - time[i - 1]) / (time[i] - time[i - 1]);
  return value[i - 1] + share * (value[i] - value[i - 1]);
}

double TimeTable::integral(double from, double to) const {
  if (time.empty() || !(to > from)) return 0;
  double sum = value.front() * std::max(0.0, std::min(to, time.front()) - from);
  for (std::size_t i = 1; i < time.size(); ++i) {
    const double start = std::max(from, time[i - 1]), end = std::min(to, time[i]);
    if (!(end > start)) continue;
    const double slope = (value[i] - value[i - 1]) / (time[i] - time[i - 1]);
    sum += (end - start) * (value[i - 1] + slope * (0.5 * (start + end) - time[i - 1]));
  }
  return sum + value.back() * std::max(0.0, to - std::max(from, time.back()));
}

double TimeTable::least() const { return value.empty() ? 0 : *std::min_element(value.begin(), value.end()); }
double TimeTable::largest() const { return value.empty() ? 0 : *std::max_element(value.begin(), value.end()); }

std::optional<std::string> TimeTable::fault(const char* values) const {
  if (time.size() != value.size() || time.empty())
    return fmt::format("has {} times and {} {}; expected as many, and at least one", time.size(), value.size(), values);
  for (std::size_t i = 1; i < time.size(); ++i) {
    if (!(time[i - 1] < time[i])) return "the times must ascend";
  }
  return {};
}

nlohmann::json TimeTable::json() const {
  if (is_constant()) return value.front();
  return {{"time", time}, {"value", value}};
}

TimeTable TimeTable::read(const JsonObject& o, const char* key, const char* values) {
  if (!o.at(key).is_object()) return constant(o.number(key));
  const JsonObject table = o.object(key);
  TimeTable read{table.numbers("time"), table.numbers("value")};
  if (const auto fault = read.fault(values)) throw InputError("{}: {}", table.where(), *fault);
  return read;
}

}  // namespace scree
