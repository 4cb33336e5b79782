// The broad phase against all pairs: sizes over many decades, negative coordinates, balls on cell borders, one cell,
// an empty world, periodic axes.
#include "core/search/multilevel_grid.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>

#include "core/base/error.hpp"

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
  for (const double ratio : {1.0, 3.0, 10.0, 100.0, 1e4, 1e12}) {
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

TEST(MultilevelGrid, finds_every_pair_of_a_power_law_with_a_few_giants) {
  // number density r^-3: a level has four times the balls of the next coarser one
  std::mt19937 g(4);
  std::uniform_real_distribution<double> place(-1, 1), u(0, 1);
  for (const double ratio : {10.0, 100.0, 1e3, 1e4}) {
    std::vector<Vec3> x;
    std::vector<double> r;
    for (int i = 0; i < 4000; ++i) {
      x.push_back({place(g), place(g), place(g)});
      r.push_back(0.5 / ratio / std::sqrt(1 - u(g) * (1 - 1 / (ratio * ratio))));
    }
    r[17] = 0.5;
    r[18] = 0.5 / ratio;
    EXPECT_EQ(grid_pairs(x, r), all_pairs(x, r)) << "ratio " << ratio;
  }
}

TEST(MultilevelGrid, parts_cells_that_its_sort_key_cannot_tell_apart) {
  // 1024 cells apart along each axis, all in one run of the key
  std::vector<Vec3> x;
  std::vector<double> r;
  std::mt19937 g(5);
  std::uniform_real_distribution<double> place(0, 4), turn(-8, 8);
  const double cell = 4 * (1 + 0x1p-10);
  for (int i = 0; i < 3000; ++i) {
    Vec3 p{place(g), place(g), place(g)};
    for (int c = 0; c < 3; ++c) p[c] += 1024 * cell * std::floor(turn(g) / 4);
    x.push_back(p);
    r.push_back(1);
  }
  const Pairs expected = all_pairs(x, r);
  EXPECT_GT(expected.size(), 1000u);
  EXPECT_EQ(grid_pairs(x, r), expected);
}

TEST(MultilevelGrid, finds_the_pairs_of_lonely_balls_in_an_empty_world) {
  std::mt19937 g(6);
  std::uniform_real_distribution<double> place(-1e6, 1e6), near(-1, 1);
  std::vector<Vec3> x;
  for (int i = 0; i < 1000; ++i) {
    x.push_back({place(g), place(g), place(g)});
    x.push_back(x.back() + Vec3{near(g), near(g), near(g)});
  }
  const std::vector<double> r(x.size(), 0.5);
  const Pairs expected = all_pairs(x, r);
  EXPECT_GT(expected.size(), 100u);
  EXPECT_EQ(grid_pairs(x, r), expected);
}

TEST(MultilevelGrid, serves_again_after_balls_came_went_and_jumped) {
  std::mt19937 g(7);
  std::uniform_real_distribution<double> somewhere(-1, 1), size(0.02, 0.2);
  MultilevelGrid grid;
  std::vector<Vec3> x;
  std::vector<double> r;
  for (const std::size_t count : {300u, 900u, 10u, 0u, 500u}) {
    x.resize(count);
    r.resize(count);
    for (std::size_t i = 0; i < count; ++i) {
      if (i % 3 != 0) x[i] = {somewhere(g), somewhere(g), somewhere(g)};
      r[i] = size(g);
    }
    grid.build(x, r);
    Pairs pairs;
    for (std::int32_t place = 0; place < static_cast<std::int32_t>(count); ++place) {
      const std::int32_t i = grid.order()[static_cast<std::size_t>(place)];
      grid.for_each_partner_at(place, [&](std::int32_t j) { pairs.emplace_back(std::min(i, j), std::max(i, j)); });
    }
    std::sort(pairs.begin(), pairs.end());
    EXPECT_EQ(pairs, all_pairs(x, r)) << count;
  }
}

/// A pair i < j with the image of j that touches i.
struct ImagePair {
  std::int32_t i, j;
  PeriodicImage image;
  auto operator<=>(const ImagePair&) const = default;
};

std::vector<ImagePair> periodic_grid_pairs(const std::vector<Vec3>& x, const std::vector<double>& r, const Vec3& period) {
  MultilevelGrid grid;
  grid.build(x, r, period);
  std::vector<ImagePair> pairs;
  for (std::int32_t i = 0; i < static_cast<std::int32_t>(x.size()); ++i) {
    grid.for_each_partner(i, [&](std::int32_t j, const PeriodicImage& image) {
      pairs.push_back(i < j ? ImagePair{i, j, image} : ImagePair{j, i, {-image[0], -image[1], -image[2]}});
    });
  }
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

/// Every pair with every image up to `turns` periods away, a ball with its own images included.
std::vector<ImagePair> all_periodic_pairs(const std::vector<Vec3>& x, const std::vector<double>& r, const Vec3& period, int turns) {
  std::vector<ImagePair> pairs;
  const auto range = [&](double length) { return length > 0 ? turns : 0; };
  for (std::size_t i = 0; i < x.size(); ++i)
    for (std::size_t j = i; j < x.size(); ++j)
      for (int a = -range(period.x); a <= range(period.x); ++a)
        for (int b = -range(period.y); b <= range(period.y); ++b)
          for (int c = -range(period.z); c <= range(period.z); ++c) {
            if (i == j && a == 0 && b == 0 && c == 0) continue;
            const Vec3 image = x[j] + Vec3{a * period.x, b * period.y, c * period.z};
            const double reach = r[i] + r[j];
            if (squared_length(x[i] - image) < reach * reach)
              pairs.push_back({static_cast<std::int32_t>(i), static_cast<std::int32_t>(j), {a, b, c}});
          }
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

TEST(MultilevelGrid, finds_every_pair_through_every_periodic_border_with_its_image) {
  std::mt19937 g(8);
  std::uniform_real_distribution<double> u(0, 1);
  for (const double ratio : {1.0, 10.0, 1e3}) {
    for (const Vec3& period : {Vec3{1, 0, 0}, Vec3{0, 1.3, 0}, Vec3{0.7, 0, 2.1}, Vec3{1, 1.9, 0.6}, Vec3{0.601, 0.9, 5}}) {
      std::vector<Vec3> x;
      std::vector<double> r;
      for (int i = 0; i < 300; ++i) {
        // unwrapped: up to two periods out on either side
        x.push_back({-1 + 2 * u(g), -1 + 2 * u(g), -1 + 2 * u(g)});
        r.push_back(0.15 * std::pow(ratio, -u(g)));
      }
      r[0] = 0.15;  // of the shortest period, 0.6: exactly the limit
      const std::vector<ImagePair> expected = all_periodic_pairs(x, r, period, 4);
      EXPECT_GT(std::count_if(expected.begin(), expected.end(), [](const ImagePair& p) { return p.image != PeriodicImage{}; }), 0);
      EXPECT_EQ(periodic_grid_pairs(x, r, period), expected)
          << "ratio " << ratio << ", period " << period.x << " " << period.y << " " << period.z;
    }
  }
}

TEST(MultilevelGrid, finds_balls_exactly_on_a_periodic_border) {
  // a lattice of touching balls whose first and last planes are one period apart; all coordinates exact
  std::vector<Vec3> x;
  for (int i = 0; i < 8; ++i)
    for (int j = 0; j < 8; ++j) x.push_back({i * 0.5, j * 0.5 - 2, 0});
  const std::vector<double> r(x.size(), 0.25 + 0x1p-20);
  const Vec3 period{4, 4, 0};
  const std::vector<ImagePair> found = periodic_grid_pairs(x, r, period);
  EXPECT_EQ(found.size(), 2u * 64);  // two neighbours a ball on the torus, each shared
  EXPECT_EQ(found, all_periodic_pairs(x, r, period, 2));
}

TEST(MultilevelGrid, answers_what_touches_a_given_ball_through_a_border) {
  std::mt19937 g(9);
  std::uniform_real_distribution<double> u(0, 1);
  const Vec3 period{1, 0, 1.5};
  std::vector<Vec3> x;
  std::vector<double> r;
  for (int i = 0; i < 600; ++i) {
    x.push_back({3 * u(g) - 1, u(g), 3 * u(g) - 1});
    r.push_back(0.2 * std::pow(1e3, -u(g)));
  }
  MultilevelGrid grid;
  grid.build(x, r, period);
  for (int q = 0; q < 60; ++q) {
    const Vec3 centre{3 * u(g) - 1, u(g), 3 * u(g) - 1};
    const double radius = 0.25 * u(g) + 1e-3;
    std::set<std::pair<std::int32_t, PeriodicImage>> found, expected;
    grid.for_each_touching(centre, radius, [&](std::int32_t j, const PeriodicImage& image) {
      EXPECT_TRUE(found.insert({j, image}).second) << "visited twice";
    });
    for (std::size_t j = 0; j < x.size(); ++j)
      for (int a = -4; a <= 4; ++a)
        for (int c = -4; c <= 4; ++c)
          if (length(x[j] + Vec3{a * period.x, 0, c * period.z} - centre) < r[j] + radius)
            expected.insert({static_cast<std::int32_t>(j), PeriodicImage{a, 0, c}});
    EXPECT_EQ(found, expected);
  }
}

TEST(MultilevelGrid, refuses_bodies_wider_than_half_a_period_and_bodies_that_escaped) {
  MultilevelGrid grid;
  const std::vector<Vec3> x = {{0.1, 0.2, 0.3}};
  const std::vector<double> r = {0.25};
  EXPECT_NO_THROW(grid.build(x, r, {1, 0, 0}));
  try {
    grid.build(x, r, {2, 0.99, 0});
    FAIL() << "a body 0.5 wide in a period of 0.99";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("periodic axis y"), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find("0.99"), std::string::npos) << error.what();
  }
  EXPECT_THROW(grid.build(std::vector<Vec3>{{0, 0, 1e30}}, r), InputError);
  EXPECT_THROW(grid.build(std::vector<Vec3>{{0, 0, 1e11}}, r, {0, 0, 2}), InputError);
}

TEST(MultilevelGrid, answers_a_large_ball_among_small_ones_without_walking_empty_cells) {
  // 1e12 cells of the smallest level lie in the ball: walking them would take hours
  std::mt19937 g(10);
  std::uniform_real_distribution<double> place(-1e4, 1e4);
  std::vector<Vec3> x;
  for (int i = 0; i < 1000; ++i) x.push_back({place(g), place(g), place(g)});
  MultilevelGrid grid;
  grid.build(x, std::vector<double>(x.size(), 1.0));
  int found = 0, expected = 0;
  grid.for_each_touching({}, 1e4, [&](std::int32_t) { ++found; });
  for (const Vec3& p : x) expected += length(p) < 1e4 + 1;
  EXPECT_EQ(found, expected);
}

}  // namespace
}  // namespace scree
