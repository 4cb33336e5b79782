#include "solver/neighbours/work_shares.hpp"

#include <gtest/gtest.h>
#include <omp.h>

#include <numeric>

namespace scree {
namespace {

TEST(WorkShares, meets_every_item_once_for_any_threads_and_counts) {
  for (const std::size_t count : {0u, 1u, 63u, 64u, 65u, 1000u, 4097u}) {
    for (const int threads : {1, 2, 3, 8}) {
      WorkShares shares(count, threads, 64);
      std::vector<std::atomic<int>> met(count);
#pragma omp parallel num_threads(threads)
      shares.take(omp_get_thread_num(), [&](std::size_t item) { ++met[item]; });
      for (const auto& times : met) ASSERT_EQ(times, 1) << count << " items, " << threads << " threads";
    }
  }
}

TEST(WorkShares, one_thread_does_the_work_of_all_in_ascending_order) {
  WorkShares shares(1000, 4, 64);
  std::vector<std::size_t> met, all(1000);
  shares.take(0, [&](std::size_t item) { met.push_back(item); });
  std::iota(all.begin(), all.end(), std::size_t{0});
  EXPECT_EQ(met, all);
}

TEST(WorkShares, a_thread_that_is_done_helps_the_others) {
  WorkShares shares(1000, 2, 64);
  std::vector<std::size_t> met;
  shares.take(1, [&](std::size_t item) { met.push_back(item); });
  ASSERT_EQ(met.size(), 1000u);
  EXPECT_EQ(met.front(), 500u);  // its own share comes first
}

}  // namespace
}  // namespace scree
