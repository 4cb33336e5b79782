#include "solver/contact/pair_state.hpp"

#include <algorithm>
#include <utility>

namespace scree {

void merge(std::vector<WaitingState>& waiting) {
  std::stable_sort(waiting.begin(), waiting.end(), [](const WaitingState& l, const WaitingState& r) { return l.key < r.key; });
  std::size_t kept = 0;
  for (std::size_t k = 0; k < waiting.size(); ++k) {
    if (kept > 0 && waiting[kept - 1].key == waiting[k].key) {
      // kinds are visited in one order: the n-th of one is the n-th of the other
      PairState& into = waiting[kept - 1].state;
      for_each_kind_of_two(into, waiting[k].state, [](auto& first, auto& second) {
        if (first.empty()) first = std::move(second);
      });
      continue;
    }
    if (kept != k) waiting[kept] = std::move(waiting[k]);
    ++kept;
  }
  waiting.resize(kept);
}

}  // namespace scree
