// Images in a periodic cell that is sheared, against all images near a point.
#include "core/geometry/periodic.hpp"

#include <gtest/gtest.h>

#include <random>

namespace scree {
namespace {

constexpr double kRounding = 1e-12;  // of lengths of about 1, with shears of 50 of them

class Sheared : public testing::Test {
 protected:
  std::mt19937_64 random_{3};
  Vec3 draw(double low, double high) {
    std::uniform_real_distribution<double> between(low, high);
    const double x = between(random_), y = between(random_);
    return {x, y, between(random_)};
  }
  Periodicity cell() { return Periodicity::at_corner(draw(-2, 2), draw(0.7, 1.3), draw(-50, 50)); }
};

TEST_F(Sheared, the_nearest_image_of_two_points_is_found_where_it_is_in_reach) {
  int in_reach = 0;
  for (int trial = 0; trial < 3000; ++trial) {
    const Periodicity c = cell();
    const Vec3 period = c.period(), least = c.least_shear();
    const double reach = 0.5 * std::min({period.x, period.y, period.z});
    Vec3 a = draw(-3, 3), b = draw(-3, 3), image;
    c.wrap(a, image);
    c.wrap(b, image);
    const Periodicity reduced = Periodicity::at_corner(c.lower(), period, least);
    double shortest = 1e300;
    for (int x = -3; x <= 3; ++x)
      for (int y = -3; y <= 3; ++y)
        for (int z = -2; z <= 2; ++z) shortest = std::min(shortest, length(b - a + reduced.shift({1.0 * x, 1.0 * y, 1.0 * z})));
    const Vec3 found = c.nearest(b - a), back = c.nearest(a - b);
    EXPECT_EQ(found, -back);
    if (shortest >= reach) continue;
    ++in_reach;
    EXPECT_NEAR(length(found), shortest, kRounding);
  }
  EXPECT_GT(in_reach, 300);
}

TEST_F(Sheared, a_point_comes_into_the_box_by_a_whole_number_of_edges) {
  for (int trial = 0; trial < 2000; ++trial) {
    const Periodicity c = cell();
    const Vec3 start = draw(-5, 5);
    Vec3 x = start, image;
    const Vec3 moved = c.wrap(x, image);
    for (int k = 0; k < 3; ++k) {
      EXPECT_GE(x[k], c.lower()[k] - kRounding);
      EXPECT_LE(x[k], c.lower()[k] + c.period()[k] + kRounding);
      EXPECT_EQ(image[k], std::round(image[k]));
      EXPECT_NEAR(c.way_of(x, image)[k], start[k], kRounding);
    }
    EXPECT_EQ(start + moved, x);
  }
}

TEST_F(Sheared, a_shear_by_whole_periods_is_none) {
  for (int trial = 0; trial < 500; ++trial) {
    const Vec3 lower = draw(-1, 1), period = draw(0.7, 1.3), shear = 0.02 * draw(-50, 50);
    const Periodicity c = Periodicity::at_corner(lower, period, shear);
    // b by 7 a, c by -3 b and 5 a
    const Periodicity other = Periodicity::at_corner(
        lower, period, {shear.x - 3 * period.y, shear.y - 3 * (shear.z + 7 * period.x) + 5 * period.x, shear.z + 7 * period.x});
    Vec3 a = draw(-2, 2), image;
    Vec3 b = a;
    c.wrap(a, image);
    other.wrap(b, image);
    EXPECT_NEAR(length(a - b), 0, kRounding);
    const Vec3 d = 0.4 * draw(-0.7, 0.7);
    EXPECT_NEAR(length(c.nearest(d) - d), 0, kRounding);
    EXPECT_NEAR(length(c.least_shear() - other.least_shear()), 0, kRounding);
    for (int k = 0; k < 3; ++k) EXPECT_LE(std::abs(c.least_shear()[k]), (0.5 + kRounding) * (k == 0 ? period.y : period.x));
  }
}

TEST_F(Sheared, the_least_of_the_lengths_bounds_the_distance_of_images) {
  for (int trial = 0; trial < 500; ++trial) {
    const Periodicity c = cell().with_least_shear();
    const double least = std::min({c.period().x, c.period().y, c.period().z});
    for (int x = -3; x <= 3; ++x)
      for (int y = -3; y <= 3; ++y)
        for (int z = -3; z <= 3; ++z) {
          if (x == 0 && y == 0 && z == 0) continue;
          EXPECT_GE(length(c.shift({1.0 * x, 1.0 * y, 1.0 * z})), least * (1 - kRounding));
        }
  }
}

TEST(UpperMatrix, its_inverse_and_product) {
  const UpperMatrix m{{2, -3, 0.5}, {0.7, -1.1, 0.3}}, one = m * inverse(m);
  for (int k = 0; k < 6; ++k) EXPECT_NEAR(one[k], k < 3 ? 1 : 0, 1e-15);
  const Vec3 v{0.3, -0.8, 1.7}, once = inverse(m).times(m.times(v));
  EXPECT_NEAR(length(once - v), 0, 1e-15);
  EXPECT_GE(m.largest_stretch() * length(v), length(m.times(v)));
}

}  // namespace
}  // namespace scree
