// What a run comes to on one rank it comes to on any number: where lists, neighbours and news between ranks are at their limits.
// Runs on four ranks; smaller numbers are groups of them. A rank that waits for ever shows as the time limit of the test.
#include <gtest/gtest.h>

#include "tests/solver/rank_groups.hpp"

namespace scree {
namespace {

using namespace test;

constexpr int kRanks = 4;

void expect_same_outcome_on_all_ranks(const Scene& scene, int steps) {
  const Outcome alone = outcome_of(scene, 1, 1, steps);
  for (int ranks = 2; ranks <= kRanks; ++ranks) {
    const Outcome o = outcome_of(scene, ranks, 1, steps);
    if (g_comm->rank() == 0) { EXPECT_EQ(o.hash, alone.hash) << ranks << " ranks"; }
  }
}

/// Balls of the given radii, without gravity and friction.
Scene scene_of_balls(const std::vector<double>& radii, double margin) {
  Scene scene = empty_scene(1000, 0.5, 0, margin);
  for (const double radius : radii) scene.shapes.push_back(make_sphere("ball", radius));
  return scene;
}

// The boxes of neighbouring ranks touch exactly but for rounding: the smallest skin is 2 % of a radius, half of it on each side.
TEST(Neighbours, take_each_other_for_such_when_their_boxes_just_touch_through_a_seam) {
  const double radius = 0.01;
  for (const auto& [margin, n] : {std::pair{5e-4, 12}, {5e-4, 24}, {2e-4, 49}}) {   // gaps that are rounded either way
    const double pitch = 2 * (1.01 * radius + margin);
    Scene scene = scene_of_balls({radius}, margin);
    Domain& d = scene.settings.domain;
    d.bounded = true;
    d.upper = {n * pitch, 1, 1};
    d.periodic = {true, false, false};
    for (int i = 0; i < n; ++i) add_body(scene, 0, {i * pitch, 0.5, 0.5});
    expect_same_outcome_on_all_ranks(scene, 3);
  }
}

}  // namespace
}  // namespace scree
