#include "core/base/nearest_name.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

namespace scree {

std::string nearest_name(const std::string& word, const std::vector<std::string>& candidates) {
  // Restricted Damerau-Levenshtein distance: a swap of neighbours ("desnity") counts as one edit.
  const auto distance = [](const std::string& a, const std::string& b) {
    std::vector<std::size_t> before(b.size() + 1), last(b.size() + 1), now(b.size() + 1);
    std::iota(last.begin(), last.end(), std::size_t{0});
    for (std::size_t i = 1; i <= a.size(); ++i) {
      now[0] = i;
      for (std::size_t j = 1; j <= b.size(); ++j) {
        now[j] = std::min({last[j] + 1, now[j - 1] + 1, last[j - 1] + (a[i - 1] == b[j - 1] ? 0U : 1U)});
        if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) now[j] = std::min(now[j], before[j - 2] + 1);
      }
      std::swap(before, last);
      std::swap(last, now);
    }
    return last[b.size()];
  };
  // A third of the word may be wrong: "frction" finds "friction", while "colour" does not find "count".
  const std::size_t allowed = std::max<std::size_t>(1, word.size() / 3);
  std::string nearest;
  std::size_t best = allowed + 1;
  for (const std::string& candidate : candidates) {
    const std::size_t edits = distance(word, candidate);
    if (edits < best && edits < candidate.size()) {
      best = edits;
      nearest = candidate;
    }
  }
  return nearest;
}

}  // namespace scree
