#include "solver/step/run_totals.hpp"

#include <algorithm>

#include "core/base/error.hpp"

namespace scree {

namespace {

constexpr std::size_t kSumsWithoutWalls = 6, kSumsOfWall = 3;

}  // namespace

void add(WallTotals& other, WallTotals& to) {
  std::vector<ExactSum*> sums;
  for_each_sum(to, [&](ExactSum& sum) { sums.push_back(&sum); });
  auto next = sums.begin();
  for_each_sum(other, [&](const ExactSum& sum) { (*next++)->add(sum); });
}

std::vector<std::int64_t> words_of(RunTotals totals) {
  std::vector<std::int64_t> words;
  for_each_sum(totals, [&](const ExactSum& sum) {
    const ExactSum::Words w = sum.words();
    words.insert(words.end(), w.begin(), w.end());
  });
  return words;
}

RunTotals totals_from(const std::vector<std::int64_t>& words) {
  const std::size_t sums = words.size() / ExactSum::kWords;
  if (words.size() % ExactSum::kWords != 0 || sums < kSumsWithoutWalls || (sums - kSumsWithoutWalls) % kSumsOfWall != 0) {
    throw InputError("totals: {} numbers are no whole sums; the file is damaged", words.size());
  }
  RunTotals totals((sums - kSumsWithoutWalls) / kSumsOfWall);
  auto next = words.begin();
  for_each_sum(totals, [&](ExactSum& sum) {
    ExactSum::Words w;
    std::copy_n(next, ExactSum::kWords, w.begin());
    sum.set_words(w);
    next += ExactSum::kWords;
  });
  return totals;
}

}  // namespace scree
