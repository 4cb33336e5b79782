// The vacancy map loses no place that is free, and draws uniformly from what it leaves open.
#include <gtest/gtest.h>

#include <random>

#include "decomposer/packing/vacancy_map.hpp"

namespace scree {
namespace {

const Box3 kBox{{-1, 2, 0}, {2, 4, 1.5}};

Vec3 any_place(std::mt19937& g) {
  std::uniform_real_distribution<double> u(0, 1);
  const Vec3 e = kBox.extent();
  return kBox.lower + Vec3{u(g) * e.x, u(g) * e.y, u(g) * e.z};
}

/// Draws until every open voxel has been hit with near certainty; calls visit(point).
template <class Visit>
void draw_many(VacancyMap& map, std::uint64_t count, Visit&& visit) {
  for (std::uint64_t n = 0; n < count; ++n) {
    const RandomNumbers random(1, 2, n);
    visit(map.draw(random, 3, {random.uniform(0), random.uniform(1), random.uniform(2)}));
  }
}

TEST(VacancyMap, draws_lie_in_the_box_and_are_uniform_when_nothing_is_closed) {
  VacancyMap map(kBox, 0.3, 0.5);
  int low = 0, total = 0;
  draw_many(map, 20000, [&](const Vec3& p) {
    for (int k = 0; k < 3; ++k) ASSERT_TRUE(p[k] >= kBox.lower[k] && p[k] <= kBox.upper[k]);
    low += p.x < kBox.lower.x + 0.3 * kBox.extent().x ? 1 : 0;
    ++total;
  });
  EXPECT_NEAR(static_cast<double>(low) / total, 0.3, 0.015);  // over four standard errors
}

TEST(VacancyMap, a_closed_voxel_has_no_free_place_and_every_free_place_is_in_an_open_one) {
  VacancyMap map(kBox, 0.15, 0.2);
  std::mt19937 g(7);
  struct Ball {
    Vec3 centre;
    double distance;
  };
  std::vector<Ball> balls;
  for (int n = 0; n < 150; ++n) {
    balls.push_back({any_place(g), 0.3 + 0.01 * (n % 7)});
    map.close(balls.back().centre, balls.back().distance);
  }
  const auto is_free = [&](const Vec3& p) {
    for (const Ball& b : balls) {
      if (length(p - b.centre) < b.distance) return false;
    }
    return true;
  };
  double free = 0, all = 0;
  for (int n = 0; n < 200000; ++n, ++all) free += is_free(any_place(g)) ? 1 : 0;
  // The free volume by draws from the map is draws that are free times open volume over draws; it must be the true one.
  double hits = 0, draws = 0;
  draw_many(map, 200000, [&](const Vec3& p) {
    hits += is_free(p) ? 1 : 0;
    ++draws;
  });
  const double truth = free / all, found = map.open_share() * hits / draws;
  EXPECT_GT(truth, 0.005);
  EXPECT_NEAR(found, truth, 0.05 * truth);
  EXPECT_GT(hits / draws, 3 * truth);  // and that is what it is for
}

TEST(VacancyMap, is_full_when_one_ball_closes_the_whole_box) {
  VacancyMap map(kBox, 0.5, 0.5);
  EXPECT_FALSE(map.is_full());
  map.close(kBox.centre(), 10);
  EXPECT_TRUE(map.is_full());
}

TEST(VacancyMap, a_box_without_extent_along_an_axis_is_one_layer) {
  VacancyMap map({{0, 0, 1}, {1, 1, 1}}, 0.1, 0.2);
  draw_many(map, 100, [&](const Vec3& p) { EXPECT_EQ(p.z, 1); });
}

}  // namespace
}  // namespace scree
