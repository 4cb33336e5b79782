// What a run comes to on one rank it comes to on any number: where lists, neighbours and report between ranks are at their limits.
// Runs on four ranks; smaller numbers are groups of them. A rank that waits indefinitely shows as the time limit of the test.
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
    if (g_comm->rank() == 0) {
      EXPECT_EQ(o.hash, alone.hash) << ranks << " ranks";
    }
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
  for (const auto& [margin, n] : {std::pair{5e-4, 12}, {5e-4, 24}, {2e-4, 49}}) {  // gaps that are rounded either way
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

// A large ball goes past small ones by half of their radius a step, a fortieth of its own.
TEST(Lists, hold_for_a_large_body_that_is_fast_for_the_smallest_one) {
  Scene scene = scene_of_balls({0.1, 0.005}, 0);
  scene.pairs[0].stiffness = 5;
  const double step = [&] {
    add_body(scene, 1, {0.5, 0.5, 0});
    add_body(scene, 1, {0.5, -0.5, 0});
    add_body(scene, 0, {0, 0, 0});
    double found = 0;
    on_ranks(1, [&](const mpi::Communicator& comm) {
      TestRun run(scene, comm);
      run.start();
      found = run.simulation->state().clock.size.step;
    });
    return g_comm->max(found);
  }();
  scene.bodies.velocity[2] = {0.0025 / step, 0, 0};
  expect_same_outcome_on_all_ranks(scene, 400);
}

// A drum moves by a fiftieth of the ball's radius in each part of a step, from the first step on.
TEST(Lists, hold_for_a_ball_in_a_fast_drum_with_a_quantised_step) {
  Scene scene = empty_scene(0, 0.5, 0.4, 0.001, 2500);
  scene.settings.gravity = {0, 0, -9.81};
  scene.settings.gather = Gathering::area;
  scene.settings.step_control = StepControl::quantised;
  scene.pairs[0].layer_modulus = 1e5;
  scene.shapes = {make_sphere("ball", 0.01)};
  add_body(scene, 0, {0, 0, -0.085});
  Wall drum;
  drum.id = 1;
  drum.name = "drum";
  drum.kind = WallKind::cylinder_inside;
  drum.axis_start = {0, -0.05, 0};
  drum.axis_end = {0, 0.05, 0};
  drum.radius = 0.1;
  drum.motion.kind = Rotate{.axis = {0, 1, 0}, .rate = 31.4};
  scene.walls.push_back(drum);
  expect_same_outcome_on_all_ranks(scene, 100);
}

// Nothing moves until then, so that lists are as tight as they get; then the piston goes four times what they hold in each step.
TEST(Lists, hold_for_a_wall_that_starts_late_and_fast) {
  Scene scene = scene_of_balls({0.01}, 0);
  for (int i = 0; i < 4; ++i) add_body(scene, 0, {0.05 * i + 0.012, 0, 0});
  Wall piston;
  piston.id = 4;
  piston.name = "piston";
  piston.normal = {1, 0, 0};
  piston.motion.kind = FollowTable{.time = {0, 0.0102, 0.0202}, .position = {{}, {}, {0.01, 0, 0}}};
  scene.walls.push_back(piston);
  scene.settings.step = 4e-4;
  expect_same_outcome_on_all_ranks(scene, 100);
}

}  // namespace
}  // namespace scree
