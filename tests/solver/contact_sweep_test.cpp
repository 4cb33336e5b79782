// docs/reference/contact-law.md section 5, test 7: an edge past the end of another, through parallel with it, and a wedge through coplanar.
#include <gtest/gtest.h>

#include <functional>

#include "tests/solver/contact_cases.hpp"

namespace scree {
namespace {

using test::TwoBodies;

/// A bar of square section with an edge up or down; the other lies across it.
struct CrossedBars {
  TwoBodies pair{test::grid_box(1, {1, .2, .2}), test::grid_box(1, {2, .2, .2}), 1e4, .02, 1, 0};
  static constexpr double kEdge = .14142135623730951;  // half of the section's diagonal
  CrossedBars() { pair.place(1, {}, quaternion_of({1, 0, 0}, std::numbers::pi / 4)); }
  /// A with its middle at `at`, turned about its own length by `roll` from standing on its edge, then about z by `yaw`.
  double energy(const Vec3& at, double roll, double yaw) {
    pair.place(0, at, quaternion_of({0, 0, 1}, yaw) * quaternion_of({1, 0, 0}, std::numbers::pi / 4 + roll));
    return pair.force(0).elastic;
  }
};

/// Follows U(t) for t in [0, 1]: with steps 8 times as short the largest change must be 8 times as small, which no jump
/// allows, and the slope stays what it was.
void expect_smooth(const std::function<double(double)>& energy, const char* what) {
  constexpr int kCoarse = 2000, kFine = 8 * kCoarse;
  const auto largest_change = [&](int steps) {
    double worst = 0, before = energy(0);
    for (int i = 1; i <= steps; ++i) {
      const double now = energy(static_cast<double>(i) / steps);
      worst = std::max(worst, std::abs(now - before));
      before = now;
    }
    return worst;
  };
  const double coarse = largest_change(kCoarse), fine = largest_change(kFine);
  double top = 0;
  for (int i = 0; i <= 100; ++i) top = std::max(top, energy(.01 * i));
  EXPECT_GT(top, 0) << what;
  EXPECT_GT(coarse, 0) << what;
  EXPECT_LE(fine, 1.3 * coarse / 8) << what;
  std::printf("%-28s U max %.2e J, largest slope %.1f U max\n", what, top, fine * kFine / top);
}

constexpr double kDeep = .012;  // overlap of the crossing edges, of a margin sum of 0.02
constexpr double kHeight = 2 * CrossedBars::kEdge + .02 - kDeep;

TEST(EdgeSweep, energy_is_continuous_as_an_edge_slides_past_the_end_of_another) {
  CrossedBars bars;
  expect_smooth([&](double t) { return bars.energy({0.03, -.7 + 1.4 * t, kHeight}, 0, std::numbers::pi / 2); }, "along its own length");
  expect_smooth([&](double t) { return bars.energy({.7 + .6 * t, .02, kHeight}, 0, std::numbers::pi / 2); }, "past the end of the other");
  expect_smooth([&](double t) { return bars.energy({.02, -.7 + 1.4 * t, kHeight}, 0, 1.1); }, "aslant");
}

TEST(EdgeSweep, energy_is_continuous_as_an_edge_turns_through_parallel) {
  CrossedBars bars;
  expect_smooth([&](double t) { return bars.energy({0, 0, kHeight}, 0, -.4 + .8 * t); }, "turning about its middle");
  expect_smooth([&](double t) { return bars.energy({.3, .001, kHeight}, 0, -.4 + .8 * t); }, "turning beside it");
  expect_smooth([&](double t) { return bars.energy({0, -.02 + .04 * t, kHeight}, 0, .02); }, "passing nearly parallel");
}

TEST(EdgeSweep, energy_is_continuous_as_a_wedge_tilts_through_coplanar) {
  CrossedBars bars;
  // height of the lowest point of a square section rolled by a: the overlap stays what it was
  const auto height = [](double roll) {
    return .1 * (std::abs(std::sin(std::numbers::pi / 4 + roll)) + std::abs(std::cos(std::numbers::pi / 4 + roll)));
  };
  expect_smooth(
      [&](double t) {
        const double roll = -.9 + 1.8 * t;
        return bars.energy({0, .03, CrossedBars::kEdge + height(roll) + .02 - kDeep}, roll, std::numbers::pi / 2);
      },
      "rolling over, crossed");
  expect_smooth(
      [&](double t) {
        const double roll = -.9 + 1.8 * t;
        return bars.energy({.1, .002, CrossedBars::kEdge + height(roll) + .02 - kDeep}, roll, .05);
      },
      "rolling over, nearly parallel");
}

}  // namespace
}  // namespace scree
