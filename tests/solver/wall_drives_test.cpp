// Walls that answer to force: what no closed form of tests/validation (L1 to L5) says.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/support/shapes.hpp"
#include "tests/support/test_run.hpp"

namespace scree {
namespace {

using test::TestRun;

constexpr double kBall = 4.0 / 3 * std::numbers::pi * 0.05 * 0.05 * 0.05 * 1000;  // [kg]

Scene ball_below_a_plate(double mass) {
  Scene scene = test::empty_scene(1e5, 0.5, 0, 0);
  scene.shapes = {make_sphere("ball", 0.05)};
  test::add_body(scene, 0, {0, 0, 0.05});
  test::add_plane(scene, {0, 0, 0}, {0, 0, 1});
  test::add_plane(scene, {0, 0, 0.1}, {0, 0, -1});
  scene.walls[1].motion.kind = Free{.guide = {0, 0, 1}, .mass = mass, .force = -10};
  return scene;
}

// A part that is lighter than bodies sets the step; that which a case gives is refused where it is too long for it.
TEST(WallDrives, count_in_the_step_by_their_inertia) {
  TestRun heavy(ball_below_a_plate(1e6)), light(ball_below_a_plate(1e-4));
  heavy.start();
  light.start();
  const double mass = kBall;
  const double bare = heavy.simulation->state().clock.size.step, less = light.simulation->state().clock.size.step;
  EXPECT_NEAR(bare / less, std::sqrt((1 / mass + 1e4) / (1 / mass + 1e-6)), 1e-9 * bare / less);
  EXPECT_NE(light.simulation->state().clock.size.limited_by.find("wall "), std::string::npos);
  TestRun given(ball_below_a_plate(1e-6));
  given.scene.settings.step = bare;
  EXPECT_THROW(given.start(), Error);
}

// The critical step that is reported is that of a ball between a fixed and a free plate: two masses, two springs.
TEST(WallDrives, count_in_the_critical_step) {
  TestRun run(ball_below_a_plate(0.3));
  run.start();
  run.run_for(0.01);
  const double m = kBall, M = 0.3, k = 1e5;
  const double a = 2 * k / m, b = k / M, c = k / std::sqrt(m * M);
  const double omega2 = 0.5 * (a + b) + std::sqrt(0.25 * (a - b) * (a - b) + c * c);
  const double critical = run.simulation->critical_step().step;
  EXPECT_LT(critical, 2 / std::sqrt(omega2) * (1 + 1e-9)) << "never above the exact one";
  EXPECT_GT(critical, 0.7 * 2 / std::sqrt(omega2));
}

// Many contacts on a part that one contact alone would let through.
TEST(WallDrives, that_are_too_light_for_all_their_contacts_end_the_run) {
  Scene scene = test::empty_scene(1e5, 0.5, 0, 0);
  scene.shapes = {make_sphere("ball", 0.05)};
  for (int i = 0; i < 400; ++i) test::add_body(scene, 0, {0.11 * (i % 20), 0.11 * (i / 20), 0.05});
  test::add_plane(scene, {0, 0, 0}, {0, 0, 1});
  test::add_plane(scene, {0, 0, 0.1}, {0, 0, -1});
  scene.walls[1].motion.kind = Free{.guide = {0, 0, 1}, .mass = 0.5, .force = -10};
  scene.settings.steps_per_contact = 20;
  TestRun run(scene);
  run.start();
  try {
    run.run_for(0.05);
    run.simulation->agree_on_failures();
    FAIL() << "not refused";
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find("is too light for its contacts"), std::string::npos) << e.what();
    EXPECT_NE(std::string(e.what()).find("use a step of at most"), std::string::npos) << e.what();
  }
}

// Momentum of a ball and a free plate that meet in the void: what one loses the other gains, and energy stays.
TEST(WallDrives, of_a_free_part_keep_momentum_and_energy) {
  Scene scene = test::empty_scene(1e5, 1, 0, 0);
  scene.shapes = {make_sphere("ball", 0.05)};
  test::add_body(scene, 0, {0, 0, 0}, {}, {0, 0, 1.0});
  test::add_plane(scene, {0, 0, 0.06}, {0, 0, -1});
  scene.walls[0].motion.kind = Free{.guide = {0, 0, 5}, .mass = 2};
  scene.settings.steps_per_contact = 100;
  TestRun run(scene);
  run.start();
  const double m = kBall, M = 2;
  run.run_for(0.1);
  const double plate = run.simulation->state().drives[0].rate, ball = run.velocity(0).z;
  EXPECT_NEAR(m * ball + M * plate, m, 1e-12 * m);
  EXPECT_NEAR(plate, 2 * m / (m + M), 1e-3 * plate) << "elastic: v = 2 m v0 / (m + M)";
  EXPECT_NEAR(ball, (m - M) / (m + M), 1e-3);
  EXPECT_NEAR(energies_of(run.simulation->state()).wall_work, -0.5 * M * plate * plate, 1e-9);
}

// Friction of a hinge with a damper: rate falls as exp(-c t / I), to the second order of the step.
TEST(WallDrives, are_damped_as_they_should) {
  Scene scene = test::empty_scene(1e5, 1, 0, 0);
  scene.shapes = {make_sphere("ball", 0.05), make_solid("plate", test::grid_box(1, {0.2, 0.2, 0.01}))};
  test::add_body(scene, 0, {1, 0, 0});
  scene.settings.margin = 1e-3;
  scene.settings.step = 1e-3;
  Wall wall;
  wall.id = 1;
  wall.kind = WallKind::mesh;
  wall.shape = 1;
  wall.name = "flap";
  wall.motion.kind = Free{.hinge = {0, 0, 1}, .inertia = 0.1, .torque = 2, .turn_damping = 1};
  scene.walls.push_back(wall);
  TestRun run(scene);
  run.start();
  run.run_for(0.2);
  const double exact = 2 * (1 - std::exp(-10 * run.simulation->time()));
  EXPECT_NEAR(run.simulation->state().drives[0].rate, exact, 1e-4 * exact);
}

}  // namespace
}  // namespace scree
