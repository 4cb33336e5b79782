// The broad phase against all pairs: sizes over four decades, negative coordinates, balls on cell borders, one cell.
#include "core/search/multilevel_grid.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>

namespace scree {
namespace {

using Pairs = std::vector<std::pair<std::int32_t, std::int32_t>>;

Pairs grid_pairs(const std::vector<Vec3>& x, const std::vector<double>& r) {
  MultilevelGrid grid;
  grid.build(x, r);
  Pairs pairs;
  for (std::int32_t i = 0; i < static_cast<std::int32_t>(x.size()); ++i) {
    grid.for_each_partner(i, [&](std::int32_t j) { pairs.emplace_back(std::min(i, j), std::max(i, j)); });
  }
  std::sort(pairs.begin(), pairs.end());
  return pairs;  // with duplicates, if there were any
}

Pairs all_pairs(const std::vector<Vec3>& x, const std::vector<double>& r) {
  Pairs pairs;
  for (std::size_t i = 0; i < x.size(); ++i) {
    for (std::size_t j = i + 1; j < x.size(); ++j) {
      const double reach = r[i] + r[j];
      if (squared_length(x[i] - x[j]) < reach * reach) pairs.emplace_back(static_cast<std::int32_t>(i), static_cast<std::int32_t>(j));
    }
  }
  return pairs;
}

TEST(MultilevelGrid, finds_every_pair_once_for_any_ratio_of_sizes) {
  std::mt19937 g(1);
  for (const double ratio : {1.0, 3.0, 10.0, 100.0, 1e4}) {
    std::uniform_real_distribution<double> place(-1, 1), exponent(0, 1);
    std::vector<Vec3> x;
    std::vector<double> r;
    for (int i = 0; i < 2000; ++i) {
      x.push_back({place(g), place(g), place(g)});
      r.push_back(0.15 * std::pow(ratio, -exponent(g)));
    }
    const Pairs expected = all_pairs(x, r);
    EXPECT_FALSE(expected.empty());
    EXPECT_EQ(grid_pairs(x, r), expected) << "ratio " << ratio;
  }
}

TEST(MultilevelGrid, does_not_mind_where_the_origin_is) {
  std::mt19937 g(2);
  std::uniform_int_distribution<int> place(0, 255);
  std::vector<Vec3> x;
  std::vector<double> r;
  for (int i = 0; i < 500; ++i) {
    x.push_back({place(g) / 64.0, place(g) / 64.0, place(g) / 64.0});
    r.push_back(0.25 + place(g) / 1024.0);
  }
  const Pairs home = grid_pairs(x, r);
  EXPECT_EQ(home, all_pairs(x, r));
  for (Vec3& p : x) p -= Vec3{1048576, -1048576, 524288};  // exact in binary: the same pairs
  EXPECT_EQ(grid_pairs(x, r), home);
}

TEST(MultilevelGrid, finds_balls_that_sit_exactly_on_cell_borders) {
  std::vector<Vec3> x;
  std::vector<double> r;
  for (int i = -3; i <= 3; ++i) {
    for (int j = -3; j <= 3; ++j) {
      x.push_back({4.0 * i, 4.0 * j, 0});  // cells of radius-1 balls are 4 wide
      r.push_back(1);
      x.push_back({4.0 * i + 1.999, 4.0 * j, 0});
      r.push_back(1);
    }
  }
  EXPECT_EQ(grid_pairs(x, r), all_pairs(x, r));
}

TEST(MultilevelGrid, takes_all_balls_in_one_place_and_none_at_all) {
  EXPECT_EQ(grid_pairs(std::vector<Vec3>(50), std::vector<double>(50, 1.0)).size(), 50u * 49 / 2);
  EXPECT_TRUE(grid_pairs({}, {}).empty());
  EXPECT_TRUE(grid_pairs({Vec3{1e9, -1e9, 3}}, {0.5}).empty());
}

TEST(MultilevelGrid, answers_what_touches_a_given_ball) {
  std::mt19937 g(3);
  std::uniform_real_distribution<double> place(-1, 1), size(0.01, 0.3);
  std::vector<Vec3> x;
  std::vector<double> r;
  for (int i = 0; i < 1000; ++i) {
    x.push_back({place(g), place(g), place(g)});
    r.push_back(size(g));
  }
  MultilevelGrid grid;
  grid.build(x, r);
  for (int q = 0; q < 50; ++q) {
    const Vec3 centre{place(g), place(g), place(g)};
    const double radius = 2 * size(g);
    std::set<std::int32_t> found, expected;
    grid.for_each_touching(centre, radius, [&](std::int32_t j) { EXPECT_TRUE(found.insert(j).second) << "visited twice"; });
    for (std::size_t j = 0; j < x.size(); ++j) {
      if (length(x[j] - centre) < r[j] + radius) expected.insert(static_cast<std::int32_t>(j));
    }
    EXPECT_EQ(found, expected);
  }
}

}  // namespace
}  // namespace scree
