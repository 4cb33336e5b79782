// Weights of vertices by density: docs/reference/contact-law.md section 6.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>

#include "solver/scene/density_weights.hpp"
#include "tests/solver/contact_cases.hpp"

namespace scree {
namespace {

/// The sum of the definition, over all vertices.
std::vector<double> by_definition(const SolverShape& shape, double radius) {
  std::vector<double> weights;
  const auto count = static_cast<std::int32_t>(shape.features.corners.size());
  for (std::int32_t i = 0; i < count; ++i) {
    double sum = 0;
    for (std::int32_t j = 0; j < count; ++j) {
      const double y = length(shape.corner(i) - shape.corner(j)) / radius;
      if (y < 1) sum += std::pow(1 - y * y, 2);
    }
    weights.push_back(1 / sum);
  }
  return weights;
}

TEST(DensityWeights, are_those_of_the_definition) {
  for (const double radius : {0.02, 0.1, 0.5, 5.0}) {
    const SolverShape shape = make_solver_shape(make_solid("rock", test::scaled(test::rock(3, 3), .5)));
    const std::vector<double> expected = by_definition(shape, radius), got = density_weights(shape, radius);
    if (*std::min_element(expected.begin(), expected.end()) == 1) {
      EXPECT_TRUE(got.empty()) << radius;
      continue;
    }
    ASSERT_EQ(got.size(), expected.size());
    for (std::size_t i = 0; i < got.size(); ++i) EXPECT_NEAR(got[i], expected[i], 1e-13 * expected[i]) << radius;
  }
}

TEST(DensityWeights, are_1_where_no_two_vertices_lie_within_the_radius) {
  const SolverShape cube = make_solver_shape(make_solid("cube", test::grid_box(8, {1, 1, 1})));
  EXPECT_TRUE(density_weights(cube, 0.999).empty()) << "vertices inside faces and edges are no features";
  const std::vector<double> clustered = density_weights(cube, 1.25);  // three neighbours at 1, none else: K = (1 - .64)^2
  ASSERT_EQ(clustered.size(), 8u);
  for (const double w : clustered) EXPECT_NEAR(w, 1 / (1 + 3 * .36 * .36), 1e-14);
}

TEST(DensityWeights, of_a_body_belong_to_the_half_octave_of_its_scale) {
  EXPECT_EQ(half_octave(1), 1);
  EXPECT_EQ(half_octave(1.18), 1);
  EXPECT_EQ(half_octave(0.85), 1);
  EXPECT_NEAR(half_octave(1.2), std::sqrt(2), 1e-15);
  EXPECT_NEAR(half_octave(0.84), std::sqrt(0.5), 1e-15);
  EXPECT_EQ(half_octave(1024), 1024);
  for (double scale = 1e-6; scale < 1e6; scale *= 1.037) {
    EXPECT_LE(std::abs(std::log2(scale / half_octave(scale))), .25 * (1 + 1e-12)) << scale;
    EXPECT_EQ(half_octave(4 * scale), 4 * half_octave(scale)) << scale;
  }
}

/// Mean duration [s] of impacts of a locked icosphere in six orientations, three of the finest, and the largest overlap over the margins.
std::array<double, 2> mean_impact(int level, double speed, bool by_density) {
  std::mt19937 g(7 + static_cast<unsigned>(level));
  double sum = 0, depth = 0;
  const int orientations = level < 6 ? 6 : 3;
  for (int s = 0; s < orientations; ++s) {
    test::LockedIcosphere impact{level, speed, 200};
    impact.orientation = test::random_quaternion(g);
    impact.by_density = by_density;
    const auto r = impact.run();
    EXPECT_NEAR(r.restitution, .5, 2.5e-3) << level;
    sum += r.duration / orientations;
    depth = std::max(depth, r.largest_overlap / test::kMargin);
  }
  return {sum, depth};
}

/// Duration [s] of an impact of unit mass on a linear spring without tension, restitution .5: for D = d that of a smooth body. It ends
/// with a free flight, from where the dashpot would pull to where the overlap is gone.
double duration_of_one_spring() {
  double zeta = 0, low = 0, high = 0.9;
  double turned = 0, root = 1;
  for (int n = 0; n < 100; ++n) {
    zeta = 0.5 * (low + high);
    root = std::sqrt(1 - zeta * zeta);
    turned = std::numbers::pi - std::atan2(2 * zeta * root, 1 - 2 * zeta * zeta);
    (std::exp(-zeta / root * turned) > .5 ? low : high) = zeta;
  }
  return (turned + std::sin(turned)) / (root * std::sqrt(test::kStiffness));
}

// The set-up of section 6 (unit mass, R = .5, margins together .02), at three speeds.
TEST(DensityWeights, duration_of_an_impact_tends_to_that_of_one_spring_as_an_icosphere_is_refined) {
  const double exact = duration_of_one_spring();
  for (const double speed : {.3, 1.0, 1.9}) {
    std::vector<double> duration;
    for (int level = 2; level <= 6; ++level) {
      const auto [time, depth] = mean_impact(level, speed, true);
      std::printf("icosphere L%d at %.1f m/s: %.2f ms (one spring: %.2f), overlap up to %.2f of the margins\n", level, speed, 1e3 * time,
                  1e3 * exact, depth);
      duration.push_back(time / exact);
    }
    const bool shallow = speed < 1;  // a tenth of the margins: less than facets of level 4 are high
    EXPECT_NEAR(duration[2], 1, shallow ? .05 : .03) << "level 4";
    EXPECT_NEAR(duration[3], 1, shallow ? .03 : .01) << "level 5";
    EXPECT_NEAR(duration[4], 1, shallow ? .015 : .0075) << "level 6";
    EXPECT_NEAR(duration[4] / duration[3], 1, shallow ? .01 : .005);
    const auto [least, most] = std::minmax_element(duration.begin(), duration.end());
    EXPECT_LE(*most, (shallow ? 1.2 : 1.1) * *least) << "facets of level 3, not yet a crowd, make up most of it";
  }
  const double coarse = mean_impact(2, 1, false)[0], fine = mean_impact(6, 1, false)[0];
  EXPECT_GE(coarse, 1.4 * fine) << "unit weights have no limit";
}

// Vertices alone give D = d for any two radii (contact/clusters.hpp). Crossing edges of two fine meshes add as much again to D^9, at every
// depth.
TEST(DensityWeights, make_the_overlap_of_two_fine_balls_of_any_radii_that_of_smooth_ones_within_11_percent) {
  std::mt19937 g(5);
  for (const double other : {.5, .25, .1}) {
    const int level = other == .5 ? 5 : other == .25 ? 5 : 4;
    test::TwoBodies pair(test::scaled(test::icosphere(5), .5), test::scaled(test::icosphere(level), other), 1, test::kMargin, 1, 0);
    double worst = 0, least = 1e300, most = 0;
    for (int s = 0; s < 4; ++s) {
      for (int i = 0; i < 2; ++i) pair.body[i].q = test::random_quaternion(g);
      for (const double d : {.25, .5, .75}) {
        pair.body[1].x = {0, 0, 0};
        pair.body[0].x = {0, 0, .5 + other + test::kMargin * (1 - d)};
        const double D = std::sqrt(2 * pair.force(0).elastic);  // U = D^2 / 2
        worst = std::max(worst, std::abs(D / (d * test::kMargin) - 1));
        least = std::min(least, D / d), most = std::max(most, D / d);
        std::printf("  radii .5 and %.2f, overlap %.2f of both margins: D/d %.4f\n", other, d, D / (d * test::kMargin));
      }
    }
    EXPECT_LE(worst, .11) << other;
    EXPECT_LE(most, 1.04 * least) << other;
  }
}

}  // namespace
}  // namespace scree
