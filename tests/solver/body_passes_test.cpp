// Passes over bodies in lanes have the bits of plain code, for any number of rows and any first row.
#include "solver/bodies/body_passes.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <random>

namespace scree {
namespace {

constexpr std::size_t kRows = 23;

ParticleSet bodies() {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const auto vector = [&] { return Vec3{uniform(random), uniform(random), uniform(random)}; };
  ParticleSet p;
  for (std::size_t i = 0; i < kRows; ++i) {
    p.x.push_back(vector());
    p.x_listed.push_back(p.x.back() + 0.1 * vector());
    p.v.push_back(vector());
    p.w.push_back(vector());
    p.q.push_back({uniform(random), uniform(random), uniform(random), uniform(random)});
    p.dissipative_force.push_back(vector());
    p.dissipative_torque.push_back(vector());
    p.dissipated.push_back(uniform(random));
    p.inverse_mass.push_back(i % 5 == 3 ? 0 : 2 + uniform(random));
    p.radius.push_back(2 + uniform(random));
    p.ball_radius.push_back(i % 7 == 2 ? 0 : p.radius.back());
  }
  p.owned = kRows;
  return p;
}

/// Calls check(begin, end) for all ranges of rows.
template <class Check>
void for_all_ranges(Check&& check) {
  for (std::size_t begin = 0; begin <= kRows; ++begin) {
    for (std::size_t end = begin; end <= kRows; ++end) check(begin, end);
  }
}

TEST(BodyPasses, dissipation_is_the_power_of_the_dissipative_forces_on_bodies_that_are_not_fixed) {
  constexpr double dt = 0.37;
  const ParticleSet before = bodies();
  for_all_ranges([&](std::size_t begin, std::size_t end) {
    ParticleSet p = before;
    add_dissipation_of_rows(p, dt, begin, end);
    for (std::size_t i = 0; i < kRows; ++i) {
      const double power = dot(p.dissipative_force[i], p.v[i]) + dot(p.dissipative_torque[i], p.w[i]);
      const bool counts = i >= begin && i < end && p.inverse_mass[i] > 0;
      EXPECT_EQ(p.dissipated[i], counts ? before.dissipated[i] - dt * power : before.dissipated[i]) << begin << ' ' << end << ' ' << i;
    }
  });
}

TEST(BodyPasses, the_way_of_a_body_is_that_of_its_farthest_point_and_of_a_ball_that_of_its_centre) {
  constexpr double rounding = 1 + 1e-9;
  const ParticleSet p = bodies();
  for_all_ranges([&](std::size_t begin, std::size_t end) {
    std::vector<Vec3> x = p.x_listed;
    std::vector<Quat> q(kRows, Quat{0.9, 0.1, 0.2, 0.3});
    std::vector<double> way(kRows, 0.25);
    add_way_of_rows(p, rounding, begin, end, x, q, way);
    for (std::size_t i = 0; i < kRows; ++i) {
      const bool counts = i >= begin && i < end;
      EXPECT_EQ(x[i], counts ? p.x[i] : p.x_listed[i]);
      double gone = length(p.x[i] - p.x_listed[i]);
      if (!(p.ball_radius[i] > 0)) {
        const double a = p.q[i].w - 0.9, b = p.q[i].x - 0.1, c = p.q[i].y - 0.2, d = p.q[i].z - 0.3;
        gone += 2 * p.radius[i] * std::sqrt(a * a + b * b + c * c + d * d);
        EXPECT_EQ(q[i], counts ? p.q[i] : (Quat{0.9, 0.1, 0.2, 0.3}));
      }
      EXPECT_EQ(way[i], counts ? 0.25 + rounding * gone : 0.25) << begin << ' ' << end << ' ' << i;
    }
  });
}

TEST(BodyPasses, the_first_body_that_goes_far_is_found_and_none_where_none_does) {
  ParticleSet p = bodies();
  for (Vec3& v : p.v) v = {0.1, 0, 0};
  for (const std::size_t fast : {std::size_t{0}, std::size_t{6}, kRows - 1}) {
    p.v[fast] = p.v[kRows - 1] = {0, -9, 0};
    for_all_ranges([&](std::size_t begin, std::size_t end) {
      const std::size_t first = begin <= fast && fast < end ? fast : begin < kRows && end == kRows ? kRows - 1 : end;
      EXPECT_EQ(find_row_that_goes_far(p, 0.1, 0.3, begin, end), first) << fast << ' ' << begin << ' ' << end;
    });
    p.v[fast] = {0.1, 0, 0};
  }
}

TEST(BodyPasses, a_body_beyond_its_limit_or_nowhere_is_seen_and_speeds_that_are_no_numbers_are_not_the_largest) {
  ParticleSet p = bodies();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for_all_ranges([&](std::size_t begin, std::size_t end) {
    double squared = 0, farthest = 0;
    for (std::size_t i = begin; i < end; ++i) {
      squared = std::max(squared, squared_length(p.v[i]));
      farthest = std::max(farthest, squared_length(p.x[i] - p.x_listed[i]));
    }
    EXPECT_EQ(find_rows_moved(p, farthest, begin, end).squared_speed, squared);
    EXPECT_FALSE(find_rows_moved(p, farthest, begin, end).beyond);
    EXPECT_EQ(find_rows_moved(p, farthest * (1 - 1e-15), begin, end).beyond, end > begin);
    for (std::size_t i = begin; i < end; ++i) {
      ParticleSet lost = p;
      lost.x[i].y = lost.v[i].z = nan;
      double of_others = 0;
      for (std::size_t k = begin; k < end; ++k) of_others = std::max(of_others, k == i ? 0.0 : squared_length(p.v[k]));
      EXPECT_TRUE(find_rows_moved(lost, 100.0, begin, end).beyond);
      EXPECT_EQ(find_rows_moved(lost, 100.0, begin, end).squared_speed, of_others);
    }
  });
}

}  // namespace
}  // namespace scree
