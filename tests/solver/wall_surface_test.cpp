// Surfaces of walls that move along themselves: belts and turntables.
#include <gtest/gtest.h>

#include <array>

#include "tests/support/shapes.hpp"
#include "tests/support/test_run.hpp"

namespace scree {
namespace {

using test::TestRun;

WallMotion belt(double speed, const Vec3& along) {
  WallMotion m;
  m.kind = Translate{.axis = along, .rate = speed};
  return m;
}

WallMotion table(double rate, const Vec3& centre) {
  WallMotion m;
  m.kind = Rotate{.axis = {0, 0, 1}, .centre = centre, .rate = rate};
  return m;
}

TEST(WallSurface, goes_along_with_its_wall_and_keeps_its_times) {
  Wall wall;
  wall.position = {1, 0, 0};
  wall.motion = table(2, {});
  wall.surface.motion = belt(3, {1, 0, 0});
  wall.surface.motion.start = 0.1;
  wall.surface.motion.stop = 0.4;
  EXPECT_EQ(wall_state(wall, 0.05).surface.velocity, Vec3{});
  EXPECT_EQ(wall_state(wall, 0.4).surface.velocity, Vec3{});
  const WallState at = wall_state(wall, 0.3);
  EXPECT_LT(length(at.surface.velocity - 3 * Vec3{std::cos(0.6), std::sin(0.6), 0}), 1e-15);
  EXPECT_EQ(wall_state(wall, 0.45, 0.2).surface_before.velocity == Vec3{}, false);  // half a step before, it still ran
  // a surface that turns, about the origin of the wall's frame; the centre is carried by the wall
  wall.surface.motion = table(5, {1, 0.2, 0});
  const WallState turned = wall_state(wall, 0.3);
  const Vec3 arm = rotate(quaternion_of({0, 0, 1}, 0.6), Vec3{0, -0.2, 0});
  EXPECT_LT(length(turned.surface.velocity - cross(Vec3{0, 0, 5}, arm)), 1e-14);
  EXPECT_LT(length(turned.surface.spin - Vec3{0, 0, 5}), 1e-14);
}

/// Two bodies fall askew on a plane that moves in itself: as a wall, or by its surface alone.
struct Landing {
  std::array<Vec3, 2> x, v, w;
  double work, dissipated, balance, power;
};

Landing land(const WallMotion& motion, bool by_surface, double rolling_friction) {
  TestRun run(test::empty_scene(1e5, 0.4, 0.5, 0.005));
  run.scene.settings.gravity = {0, 0, -9.81};
  run.scene.pairs[0].rolling_friction = run.scene.pairs[0].torsional_friction = rolling_friction;
  run.scene.shapes = {make_solid("rock", test::scaled(test::rock(3, 2, 0.3), 0.1)), make_sphere("ball", 0.05)};
  test::add_body(run.scene, 0, {0.1, 0, 0.16}, quaternion_of(normalised(Vec3{1, 2, 0}), 0.7), {0.1, 0.3, -0.2}, {1, 0, 2});
  test::add_body(run.scene, 1, {-0.5, 0.2, 0.08}, {}, {0, 0, -0.3});
  test::add_plane(run.scene, {0, 0, 0}, {0, 0, 1});
  (by_surface ? run.scene.walls[0].surface.motion : run.scene.walls[0].motion) = motion;
  run.start();
  run.run_for(0.25);
  Landing end;
  for (const std::size_t i : {0, 1}) {
    end.x[i] = run.position(static_cast<std::int64_t>(i));
    end.v[i] = run.velocity(static_cast<std::int64_t>(i));
    end.w[i] = run.spin(static_cast<std::int64_t>(i));
  }
  const Energies e = energies_of(run.simulation->state());
  end.work = e.wall_work;
  end.dissipated = e.dissipated;
  end.balance = e.balance();
  end.power = wall_loads_of(run.simulation->state())[0].power(run.simulation->state().walls[0]);
  return end;
}

// A plane that slides or turns in itself is the same plane all the time: only the velocity of its points tells, so that its motion and
// that of its surface are one. Work and heat too.
TEST(WallSurface, of_a_plane_does_what_the_plane_does_when_it_moves_in_itself) {
  for (const WallMotion& motion : {belt(0.7, normalised(Vec3{1, 0.3, 0})), table(4, {0.2, 0.1, 0})}) {
    for (const double rolling : {0.0, 0.1}) {
      const Landing wall = land(motion, false, rolling), surface = land(motion, true, rolling);
      EXPECT_GT(std::abs(wall.work), 1e-3) << "it must have worked";
      for (const std::size_t i : {0, 1}) {
        EXPECT_LT(length(wall.x[i] - surface.x[i]), 1e-9) << motion.word() << rolling;
        EXPECT_LT(length(wall.v[i] - surface.v[i]), 1e-7) << motion.word() << rolling;
        EXPECT_LT(length(wall.w[i] - surface.w[i]), 1e-6) << motion.word() << rolling;
      }
      EXPECT_NEAR(surface.work, wall.work, 1e-6 * std::abs(wall.work)) << motion.word() << rolling;
      EXPECT_NEAR(surface.dissipated, wall.dissipated, 1e-6 * wall.dissipated) << motion.word() << rolling;
      EXPECT_NEAR(surface.balance, wall.balance, 1e-6 * wall.dissipated) << motion.word() << rolling;
      EXPECT_NEAR(surface.power, wall.power, 1e-5 * std::abs(wall.work / 0.25)) << motion.word() << rolling;
    }
  }
}

// What points out of the surface does nothing: only friction asks.
TEST(WallSurface, across_itself_or_without_friction_changes_nothing) {
  const auto end = [](double friction, const WallMotion& motion) {
    TestRun run(test::empty_scene(1e5, 0.4, friction, 0.005));
    run.scene.settings.gravity = {0, 0, -9.81};
    run.scene.shapes = {make_solid("rock", test::scaled(test::rock(3, 2, 0.3), 0.1))};
    test::add_body(run.scene, 0, {0.1, 0, 0.16}, {}, {0.1, 0.3, -0.2}, {1, 0, 2});
    test::add_plane(run.scene, {0, 0, 0}, {0, 0, 1});
    run.scene.walls[0].surface.motion = motion;
    run.start();
    run.run_for(0.25);
    return run.position(0);
  };
  EXPECT_EQ(end(0, belt(0.7, {1, 0, 0})), end(0, {}));
  EXPECT_LT(length(end(0.5, belt(0.7, {0, 0, 1})) - end(0.5, {})), 1e-12);  // rounding of the part that is taken out
  EXPECT_GT(length(end(0.5, belt(0.7, {1, 0, 0})) - end(0.5, {})), 1e-3);
}

}  // namespace
}  // namespace scree
