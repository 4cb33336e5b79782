#include "solver/state/run_totals.hpp"

namespace scree {

void add(WallTotals& other, WallTotals& to) {
  std::vector<ExactSum*> sums;
  for_each_sum(to, [&](ExactSum& sum) { sums.push_back(&sum); });
  auto next = sums.begin();
  for_each_sum(other, [&](const ExactSum& sum) { (*next++)->add(sum); });
}

}  // namespace scree
