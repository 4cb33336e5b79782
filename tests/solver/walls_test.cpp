// Driven walls: where they are, how fast they move, what they do to bodies and what that costs.
#include <gtest/gtest.h>

#include "tests/support/shapes.hpp"
#include "tests/support/test_run.hpp"

namespace scree {
namespace {

using test::TestRun;

std::vector<WallMotion> all_motions() {
  std::vector<WallMotion> motions(4);
  motions[0].kind = Rotate{.axis = normalised(Vec3{1, 2, 3}), .centre = {0.1, -0.2, 0.3}, .rate = 5};
  motions[1].kind = Translate{.axis = {0, 1, 0}, .rate = -2};
  motions[2].kind = Oscillate{.axis = {1, 0, 0}, .amplitude = 0.02, .frequency = 7, .phase = 0.4};
  motions[3].kind = FollowTable{.time = {0, 0.3, 0.5, 0.9}, .position = {{0, 0, 0}, {0.1, 0, 0}, {0.1, 0.2, 0}, {0, 0, -0.1}}};
  for (WallMotion& m : motions) {
    m.start = 0.2;
    m.stop = 0.9;
  }
  return motions;
}

// The velocities that contacts see are the derivatives of the pose, by central differences; outside of start and stop a wall
// stands where it began or ended.
TEST(DrivenWall, moves_as_fast_as_its_pose_changes) {
  for (const WallMotion& motion : all_motions()) {
    Wall wall;
    wall.position = {0.5, 0.1, 0};
    wall.orientation = quaternion_of(normalised(Vec3{0, 1, 1}), 0.3);
    wall.motion = motion;
    const char* const kind = motion.word();
    for (const double time : {0.05, 0.21, 0.33, 0.47, 0.62, 0.85, 0.95, 3.0}) {
      const double h = 1e-6;
      const WallState before = wall_state(wall, time - h), now = wall_state(wall, time), after = wall_state(wall, time + h);
      const Vec3 velocity = (1 / (2 * h)) * (after.position - before.position);
      EXPECT_LE(length(velocity - now.velocity), 1e-6) << "motion " << kind << " at " << time;
      const Quat turn = after.orientation * conjugate(before.orientation);
      const Vec3 spin = (1 / h) * Vec3{turn.x, turn.y, turn.z};
      EXPECT_LE(length(spin - now.angular_velocity), 1e-6) << "motion " << kind << " at " << time;
    }
    EXPECT_EQ(wall_state(wall, 0).position, wall_state(wall, 0.2).position) << kind;
    EXPECT_EQ(wall_state(wall, 0.9).position, wall_state(wall, 7).position) << kind;
  }
  // in numbers: a quarter of a period after the start, and in the table
  std::vector<WallMotion> motions = all_motions();
  Wall wall;
  wall.motion = motions[2];
  std::get<Oscillate>(wall.motion.kind).phase = 0;
  EXPECT_NEAR(wall_state(wall, 0.2 + 1 / 28.0).position.x, 0.02, 1e-15);
  wall.motion = motions[3];
  EXPECT_NEAR(wall_state(wall, 0.2 + 0.4).position.y, 0.1, 1e-15);
}

// A plate lifts a block at constant speed: force m g, power m g v, work m g h.
TEST(DrivenWall, that_lifts_a_block_gives_the_power_it_takes) {
  TestRun run(test::empty_scene(1e6, 0.3, 0.5, 0.005));
  run.scene.settings.gravity = {0, 0, -9.81};
  run.scene.shapes = {make_solid("block", test::grid_box(1, {0.4, 0.4, 0.1}))};
  const double mass = 16, overlap = mass * 9.81 / (std::sqrt(2.0) * 1e6);
  test::add_body(run.scene, 0, {0, 0, 0.05 + 0.01 - overlap}, {}, {0, 0, 0.5});
  test::add_plane(run.scene, {0, 0, 0}, {0, 0, 1});
  run.scene.walls[0].motion.kind = Translate{.axis = {0, 0, 1}, .rate = 0.5};
  run.start();
  const Energies start = energies_of(run.simulation->state());
  run.run_for(1.0);
  const WallLoad load = wall_loads_of(run.simulation->state())[0];
  EXPECT_NEAR(load.force.z, -mass * 9.81, 1e-6 * mass * 9.81);
  EXPECT_NEAR(load.power(run.simulation->state().walls[0]), mass * 9.81 * 0.5, 1e-6 * mass * 9.81);
  const Energies end = energies_of(run.simulation->state());
  const double height = 0.5 * run.simulation->time();
  EXPECT_NEAR(end.wall_work, mass * 9.81 * height, 1e-5 * mass * 9.81 * height);
  EXPECT_NEAR(end.balance(), start.balance(), 1e-5 * mass * 9.81 * height);
}

// F12: on a table that turns, a block keeps its place while the friction it needs, r Omega^2, stays below mu g. The plane
// turns about its normal: only the velocity of its points tells. Torque and power vanish once all turns together.
TEST(DrivenWall, that_turns_carries_a_block_round_by_friction) {
  TestRun run(test::empty_scene(1e6, 0.3, 0.5, 0.005));
  run.scene.settings.gravity = {0, 0, -9.81};
  run.scene.shapes = {make_solid("block", test::grid_box(1, {0.1, 0.1, 0.04}))};
  const double mass = 0.4, overlap = mass * 9.81 / (std::sqrt(2.0) * 1e6), r = 0.5, omega = 2;
  test::add_body(run.scene, 0, {r, 0, 0.02 + 0.01 - overlap}, {}, {0, r * omega, 0}, {0, 0, omega});
  test::add_plane(run.scene, {0, 0, 0}, {0, 0, 1});
  WallMotion& m = run.scene.walls[0].motion;
  m.kind = Rotate{.axis = {0, 0, 1}, .rate = omega};
  run.start();
  run.run_for(2.0);
  const Vec3 x = run.position(0);
  const double angle = omega * run.simulation->time();
  EXPECT_NEAR(std::hypot(x.x, x.y), r, 1e-3 * r);
  EXPECT_NEAR(std::remainder(std::atan2(x.y, x.x) - angle, 2 * M_PI), 0, 2e-3);
  const WallLoad load = wall_loads_of(run.simulation->state())[0];
  EXPECT_NEAR(std::hypot(load.force.x, load.force.y), mass * omega * omega * r, 2e-2 * mass * omega * omega * r);
  EXPECT_LE(std::abs(load.power(run.simulation->state().walls[0])), 2e-2 * mass * omega * omega * r * r * omega);
}

// Where the axis is makes no difference. With the axis 300 m from the wall's origin the block slid by h w^2 r / 2 = 60 mm/s, or, once that
// was mended for the origin and not for the arms, by (h w)^2 of the way to it, and was pushed and pulled by damping.
TEST(DrivenWall, that_turns_about_an_axis_away_from_its_origin_carries_a_block_as_well) {
  const auto place_after = [](double away) {
    TestRun run(test::empty_scene(1e6, 0.3, 0.5, 0.005));
    run.scene.settings.gravity = {0, 0, -9.81};
    run.scene.settings.step = 1e-4;
    run.scene.shapes = {make_solid("block", test::grid_box(1, {0.1, 0.1, 0.04}))};
    const double mass = 0.4, overlap = mass * 9.81 / (std::sqrt(2.0) * 1e6), r = 0.5, omega = 2;
    test::add_body(run.scene, 0, {away + r, 0, 0.02 + 0.01 - overlap}, {}, {0, r * omega, 0}, {0, 0, omega});
    test::add_plane(run.scene, {0, 0, 0}, {0, 0, 1});
    WallMotion& m = run.scene.walls[0].motion;
    m.kind = Rotate{.axis = {0, 0, 1}, .centre = {away, 0, 0}, .rate = omega};
    run.start();
    run.run_for(1.0);
    return run.position(0) - Vec3{away, 0, 0};
  };
  // what rounding makes of places 300 m away and of the overlaps that they leave
  EXPECT_LE(length(place_after(300) - place_after(0)), 1e-10);
}

/// The velocity half a step before is the way of the step over the step, for every motion.
TEST(DrivenWall, has_half_a_step_before_the_velocity_of_the_way_gone) {
  for (const WallMotion& motion : all_motions()) {
    Wall wall;
    wall.position = {0.5, 0.1, 0};
    wall.motion = motion;
    const double h = 1e-4, time = 0.47;
    const WallState now = wall_state(wall, time, h), before = wall_state(wall, time - h);
    EXPECT_LE(length((1 / h) * (now.position - before.position) - now.velocity_before), 1e-5) << motion.word();
    EXPECT_EQ(now.velocity, wall_state(wall, time).velocity);
  }
}

// A wall that swings by a table and one that swings by the same sine give the same bounces as the table gets finer.
TEST(DrivenWall, given_as_a_table_goes_to_the_motion_it_samples) {
  const auto height = [](int rows) {
    TestRun run(test::empty_scene(1e5, 0.5, 0, 0.002));
    run.scene.settings.gravity = {0, 0, -9.81};
    run.scene.shapes = {make_sphere("ball", 0.05)};
    test::add_body(run.scene, 0, {0, 0, 0.06}, {}, {0, 0, -0.2});
    test::add_plane(run.scene, {0, 0, 0}, {0, 0, 1});
    WallMotion& m = run.scene.walls[0].motion;
    if (rows == 0) {
      m.kind = Oscillate{.axis = {0, 0, 1}, .amplitude = 0.002, .frequency = 10};
    } else {
      FollowTable table;
      for (int i = 0; i <= rows; ++i) {
        table.time.push_back(0.1 * i / rows);
        table.position.push_back({0, 0, 0.002 * std::sin(2 * M_PI * 10 * table.time.back())});
      }
      m.kind = table;
    }
    run.start();
    run.run_for(0.1);
    return run.velocity(0).z;
  };
  const double smooth = height(0);
  EXPECT_LE(std::abs(height(1000) - smooth), 1e-4);
  EXPECT_LE(std::abs(height(1000) - smooth), 0.5 * std::abs(height(20) - smooth));
}

// No stiffness holds against a wall that is driven: the user hears which walls, and what room they leave.
TEST(DrivenWall, that_squeezes_a_block_against_another_ends_the_run_with_the_names_of_both) {
  for (const bool mesh : {false, true}) {
    TestRun run(test::empty_scene(1e6, 0.5, 0.3, 0.002));
    run.scene.shapes = {make_solid("cube", test::grid_box(1, {0.1, 0.1, 0.1}))};
    test::add_body(run.scene, 0, {0, 0, 0.0521});
    test::add_plane(run.scene, {0, 0, 0}, {0, 0, 1});
    test::add_plane(run.scene, {0, 0, 0.11}, {0, 0, -1});
    run.scene.walls[0].name = "floor";
    Wall& press = run.scene.walls[1];
    press.name = "press";
    press.motion.kind = Translate{.axis = {0, 0, 1}, .rate = -0.2};
    if (mesh) {  // a plate that covers the block
      run.scene.shapes.push_back(make_surface("plate", {{{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}}, {{0, 1, 2}, {0, 2, 3}}}));
      press.kind = WallKind::mesh;
      press.shape = 1;
      press.position = {0, 0, 0.11};
    }
    run.start();
    try {
      run.run_for(0.1);
      FAIL() << "nothing stopped the run";
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ExitCode::run_invalid);
      const std::string what = e.what();
      EXPECT_NE(what.find("squeezed between wall 'press', which moves, and wall 'floor': they are 10"), std::string::npos) << what;
      EXPECT_EQ(what.find("raise the stiffness"), std::string::npos) << what;
    }
  }
}

/// A ball that overlaps the lowest point of a hollow sphere, or of a floor (radius 0), with a stiffness that goes with size.
TestRun ball_in_a_hollow(double ball, double hollow, double overlap) {
  TestRun run(test::empty_scene(0, 1, 0, 0));
  run.scene.pairs[0].stiffness = 0;
  run.scene.pairs[0].modulus = 1e5;
  run.scene.shapes = {make_sphere("ball", ball)};
  test::add_body(run.scene, 0, {0, 0, ball - overlap});
  test::add_plane(run.scene, {0, 0, 0}, {0, 0, 1});
  if (!(hollow > 0)) return run;
  Wall& wall = run.scene.walls[0];
  wall.kind = WallKind::sphere_inside;
  wall.point = {0, 0, hollow};
  wall.radius = hollow;
  return run;
}

// 1/R* = 1/R_a - 1/R (K. L. Johnson, Contact Mechanics, 1985, section 4.2): a hollow of its own size holds a ball in a wide contact. The
// step follows the stiffness that comes of it.
TEST(HollowSphere, bends_towards_the_ball_that_lies_in_it) {
  constexpr double kBall = 0.01, kOverlap = 1e-5, kModulus = 1e5;
  TestRun floor = ball_in_a_hollow(kBall, 0, kOverlap);
  floor.start();
  for (const double hollow : {0.0105, 0.02, 0.05, 10.0}) {
    TestRun run = ball_in_a_hollow(kBall, hollow, kOverlap);
    run.start();
    const double reduced = kBall * hollow / (hollow - kBall), energy = 0.5 * kModulus * 2 * reduced * kOverlap * kOverlap;
    EXPECT_NEAR(energies_of(run.simulation->state()).elastic, energy, 1e-9 * energy) << hollow;  // rounding of the overlap
    const double shorter = run.simulation->state().clock.size.step / floor.simulation->state().clock.size.step;
    EXPECT_NEAR(shorter, std::sqrt(kBall / reduced), 1e-12) << hollow;
  }
}

}  // namespace
}  // namespace scree
