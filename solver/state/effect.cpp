#include "solver/state/effect.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/base/error.hpp"

namespace scree {

std::vector<ItemHash> Effect::hashes(const RunState& s) const {
  const EffectRecord kept = record(s);
  if (kept.empty()) return {};
  ItemHash h;
  for (const StateArray& array : kept) {
    for (const double value : array.reals) h.add(value);
    for (const std::int64_t value : array.integers) h.add(value);
  }
  return {h};
}

ArrayFormat sum_format(const char* name) { return {name, "", static_cast<std::int64_t>(ExactSum::kWords), false}; }

StateArray array_of(const ExactSum& sum) {
  const ExactSum::Words words = sum.words();
  return {.integers = {words.begin(), words.end()}};
}

ExactSum sum_of(const StateArray& array) {
  ExactSum::Words words{};
  if (array.integers.size() != words.size())
    throw InputError("a total of {} numbers instead of {}; the file is damaged", array.integers.size(), words.size());
  std::copy(array.integers.begin(), array.integers.end(), words.begin());
  ExactSum sum;
  sum.set_words(words);
  return sum;
}

std::string exact(double value) { return fmt::format("{:.17g}", value); }

}  // namespace scree
