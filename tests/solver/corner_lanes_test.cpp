// Corners side by side in lanes (solver/features/corner_lanes.hpp) against nearest_on_triangle(): the same points and distances, to the
// bit, in every region of the triangle and on the borders between them, whatever the triangles are that share a vector.
#include "solver/features/corner_lanes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <memory>
#include <random>
#include <vector>

#include "core/geometry/nearest_on_triangle.hpp"

namespace scree {
namespace {

struct Case {
  Vec3 p, a, b, c;
};

class CornerLanes : public testing::Test {
 protected:
  void add(const Case& one) { cases_.push_back(one); }

  /// Looks at all of them, so many at a time, and compares. Counts the regions.
  void compare(std::size_t at_once) {
    const auto queue = std::make_unique<CornerQueue>();
    const auto answers = std::make_unique<CornerAnswers>();
    regions_ = {};
    for (std::size_t begin = 0; begin < cases_.size(); begin += at_once) {
      const std::size_t end = std::min(begin + at_once, cases_.size());
      queue->count = 0;
      for (std::size_t n = begin; n < end; ++n) queue->add(cases_[n].p, cases_[n].a, cases_[n].b, cases_[n].c);
      examine_vertices_at_once(*queue, *answers);
      for (std::size_t n = begin; n < end; ++n) {
        const auto& [p, a, b, c] = cases_[n];
        const NearestOnTriangle expected = nearest_on_triangle(p, a, b, c);
        const double squared = squared_length(p - expected.point);
        const Vec3 nearest = answers->nearest.at(n - begin);
        ASSERT_EQ(std::memcmp(&nearest, &expected.point, sizeof(nearest)), 0) << n << " region " << expected.place;
        ASSERT_EQ(answers->place[n - begin], expected.place) << n;
        ASSERT_EQ(answers->squared[n - begin], squared) << n;
        ASSERT_EQ(answers->distance[n - begin], std::sqrt(squared)) << n;
        ++regions_[static_cast<std::size_t>(expected.place + 1)];
      }
    }
  }

  std::vector<Case> cases_;
  std::array<int, 7> regions_{};
};

TEST_F(CornerLanes, find_the_nearest_points_that_each_triangle_has_alone) {
  std::mt19937 g(7);
  std::uniform_real_distribution<double> u(-1, 1);
  const auto point = [&] { return Vec3{u(g), u(g), u(g)}; };
  for (int n = 0; n < 4000; ++n) {
    const double thin = n % 3 == 0 ? 1e-6 : 1;  // needles among them
    const Vec3 a = point(), ab = point(), ac = ab + thin * point();
    add({2.0 * point(), a, a + ab, a + ac});
  }
  for (const std::size_t at_once : {std::size_t{1}, std::size_t{13}, kCornersAtOnce}) {
    compare(at_once);
    for (const int count : regions_) EXPECT_GT(count, 40);
  }
}

// Points over vertices, edges and their extensions, where the comparisons that choose a region are of equal numbers.
TEST_F(CornerLanes, agree_on_the_borders_of_regions) {
  const Vec3 a{0, 0, 0}, b{4, 0, 0}, c{0, 2, 0};
  for (int x = -2; x <= 6; ++x) {
    for (int y = -2; y <= 4; ++y) {
      for (int z = 0; z <= 1; ++z) {
        const Vec3 p{static_cast<double>(x), static_cast<double>(y), static_cast<double>(z)};
        for (const auto& [i, j, k] : {std::array{a, b, c}, std::array{b, c, a}, std::array{c, a, b}, std::array{a, c, b}})
          add({p, i, j, k});
      }
    }
  }
  compare(kCornersAtOnce);
  for (const int count : regions_) EXPECT_GT(count, 0);
}

}  // namespace
}  // namespace scree
