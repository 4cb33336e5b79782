// The contact of a ball in world axes (laws/ball-inl.hpp, contact/ball_contact.hpp) against closed forms of rolling and of parallel
// transport.
#include <gtest/gtest.h>

#include "solver/contact/ball_contact.hpp"
#include "solver/laws/ball.hpp"
#include "tests/support/test_run.hpp"

namespace scree {
namespace {

using test::TestRun;
constexpr double kPi = std::numbers::pi, kRadius = 0.1, kGravity = 9.81, kStiffness = 1e6;
const double kBallMass = 1000 * 4.0 / 3 * kPi * kRadius * kRadius * kRadius;

/// A ball that rests on a plane as far as its weight is concerned.   in   place   of its centre above the plane's origin
TestRun ball_on_plane(double x, double y, const Vec3& velocity, const Vec3& spin) {
  TestRun run(test::empty_scene(kStiffness, 0.5, 0.9, 0));
  run.scene.settings.gravity = {0, 0, -kGravity};
  run.scene.shapes = {make_sphere("ball", kRadius)};
  test::add_body(run.scene, 0, {x, y, kRadius - kBallMass * kGravity / kStiffness}, {}, velocity, spin);
  test::add_plane(run.scene, {0, 0, 0}, {0, 0, 1});
  return run;
}

// A ball that rolls keeps its way, however it spins about the normal: with arms that turned with the ball, a slip of half a step times
// spin and speed bent the way.
TEST(BallContact, spin_about_the_normal_does_not_bend_the_way_of_a_ball_that_rolls) {
  const double reach = kRadius - 0.5 * kBallMass * kGravity / kStiffness;  // to the contact point, in the middle of the overlap
  TestRun run = ball_on_plane(0, 0, {1, 0, 0}, {0, 1 / reach, 40});
  run.start();
  run.run_for(1);
  EXPECT_NEAR(run.velocity(0).x, 1, 1e-6);
  EXPECT_NEAR(run.velocity(0).y, 0, 1e-6);
  EXPECT_NEAR(run.spin(0).z, 40, 1e-9);
}

// On a turntable of rate W a ball that rolls goes in a circle of the laboratory, at 2/7 W, whatever its radius and speed
// (R. H. Romer, Am. J. Phys. 49 (1981) 985): after 7 pi / W it is where it was.
TEST(BallContact, a_ball_that_rolls_on_a_turntable_goes_in_circles) {
  const double rate = 3, reach = kRadius - 0.5 * kBallMass * kGravity / kStiffness, x = 0.4, speed = 0.3;
  // v - reach (w_y, -w_x) = W (-y, x)
  TestRun run = ball_on_plane(x, 0, {speed, 0, 0}, {rate * x / reach, speed / reach, 0});
  Wall& table = run.scene.walls.back();
  table.motion.kind = Rotate{.axis = {0, 0, 1}, .centre = {0, 0, 0}, .rate = rate};
  table.motion.stop = 1e300;
  run.start();
  // half of the circle: opposite, at a distance of twice its radius, v / (2/7 W)
  run.run_for(3.5 * kPi / rate);
  const double across = 2 * speed / (2.0 / 7 * rate);
  const Vec3 opposite = run.position(0);
  EXPECT_NEAR(std::hypot(opposite.x - x, opposite.y), across, 2e-3 * across);
  EXPECT_NEAR(run.velocity(0).x, -speed, 2e-3 * speed);
  run.run_for(3.5 * kPi / rate);
  EXPECT_NEAR(run.position(0).x, x, 4e-3 * across);
  EXPECT_NEAR(run.position(0).y, 0, 4e-3 * across);
}

/// The angle by which a spring has turned after the normal went once round a circle of latitude, in `steps`.
double angle_after_circle(double latitude, double twist_in_all, int steps) {
  const auto normal = [&](double t) {
    return Vec3{std::sin(latitude) * std::cos(2 * kPi * t), std::sin(latitude) * std::sin(2 * kPi * t), std::cos(latitude)};
  };
  const double h = 1.0 / steps;
  const Vec3 start = normal(0), first = {std::cos(latitude), 0, -std::sin(latitude)}, second = cross(start, first);
  Vec3 s = first;
  for (int n = 1; n <= steps; ++n) {
    BallMeeting m{};
    m.n = normal(n * h);
    const Vec3 change = normal(n * h) - normal((n - 1) * h);
    m.turn = 0.5 * (change - dot(change, m.n) * m.n);
    m.spins = 2 * twist_in_all * m.n;  // of both bodies: its half turns the spring
    s = taken_along(m, s, 0.5 * h);
    EXPECT_NEAR(length(s), 1, 1e-12);
    EXPECT_NEAR(dot(s, m.n), 0, 1e-12);
  }
  return std::atan2(dot(s, second), dot(s, first));
}

// Parallel transport along a closed way turns by the solid angle within it (Gauss and Bonnet), and the twist adds to that.
TEST(BallContact, springs_go_along_by_parallel_transport) {
  for (const double latitude : {0.3, 1.0, 1.5}) {
    const double area = 2 * kPi * (1 - std::cos(latitude));
    for (const double twist : {0.0, 0.7}) {
      double error[2];
      for (const int k : {0, 1})
        error[k] = std::abs(std::remainder(angle_after_circle(latitude, twist, 200 << k) - (area + twist), 2 * kPi));
      EXPECT_LT(error[1], 1e-4) << latitude;
      EXPECT_GT(error[0] / error[1], 3.5) << latitude << ", second order at least";
    }
  }
}

TEST(BallContact, springs_of_older_checkpoints_turn_into_world_axes_and_back) {
  const Quat q = normalised(Quat{.5, .1, -.7, .3});
  const std::vector<FrictionSpring> in_a = {{0, {1, 2, 3}, 5, {0, 0, 1}}, RollingSpring{{.1, .2, .3}, 7}.row(), Turn{{.1, 0, 0}, .9}.row()};
  std::vector<FrictionSpring> springs = in_a;
  set_axes_of_springs(false, q, springs);
  ASSERT_EQ(springs.size(), 3u) << "of other pairs they stay";
  set_axes_of_springs(true, q, springs);
  ASSERT_EQ(springs.size(), 2u) << "without the turn";
  EXPECT_LT(length(springs[0].force - rotate(q, in_a[0].force)), 1e-15);
  EXPECT_LT(length(springs[1].force - rotate(q, in_a[1].force)), 1e-15);
  EXPECT_EQ(springs[0].normal, Vec3{});
  const std::vector<FrictionSpring> in_world = springs;
  set_axes_of_springs(true, q, springs);
  EXPECT_EQ(springs[0].force, in_world[0].force) << "they are there already";
  set_axes_of_springs(false, q, springs);
  EXPECT_LT(length(springs[0].force - in_a[0].force), 4e-15);
}

}  // namespace
}  // namespace scree
