#include "solver/state/effect.hpp"

#include <fmt/format.h>

namespace scree {

std::vector<ItemHash> Effect::hashes(const EffectRecord& record) const {
  if (record.empty()) return {};
  ItemHash h;
  for (const StateArray& array : record) {
    for (const double value : array.reals) h.add(value);
    for (const std::int64_t value : array.integers) h.add(value);
  }
  return {h};
}

std::string exact(double value) { return fmt::format("{:.17g}", value); }

}  // namespace scree
