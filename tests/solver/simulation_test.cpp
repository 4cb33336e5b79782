// Whole steps of the solver's library, on any number of ranks: restitution, conservation, impulse on walls, friction.
#include <gtest/gtest.h>

#include <random>

#include "tests/support/shapes.hpp"
#include "tests/support/test_run.hpp"

namespace scree {
namespace {

using test::TestRun;

// The demand: 1 % at 100 steps a contact. Two cubes face to face, and a cube on a plane, over phases of the
// first contact within a step.
TEST(Impact, of_two_meshes_rebounds_as_the_case_asks) {
  for (const double e : {0.3, 0.5, 0.8}) {
    for (int phase = 0; phase < 5; ++phase) {
      TestRun run(test::empty_scene(1e6, e, 0, 0.002));
      run.scene.settings.steps_per_contact = 100;
      run.scene.shapes = {make_solid("cube", test::grid_box(2, {0.1, 0.1, 0.1}))};
      test::add_body(run.scene, 0, {0, 0, 0.1045 + 1e-6 * phase}, {}, {0, 0, -0.5});
      test::add_body(run.scene, 0, {0, 0, 0}, {}, {0, 0, 0.5});
      run.start();
      run.run_for(0.02);
      EXPECT_NEAR(run.velocity(0).z - run.velocity(1).z, e, 0.01 * e) << "phase " << phase;
      EXPECT_LE(length(run.momentum()), 1e-12);
      EXPECT_LE(length(run.angular_momentum()), 1e-12);
    }
  }
}

TEST(Impact, of_a_mesh_on_a_wall_gives_the_wall_the_momentum_it_loses) {
  TestRun run(test::empty_scene(1e6, 0.5, 0.3, 0.002));
  run.scene.settings.steps_per_contact = 100;
  run.scene.shapes = {make_solid("cube", test::grid_box(3, {0.1, 0.1, 0.1}))};
  test::add_body(run.scene, 0, {0, 0, 0.0545}, {}, {0, 0, -1});
  test::add_plane(run.scene, {0, 0, 0}, {0, 0, 1});
  run.start();
  const Vec3 before = run.momentum();
  run.run_for(0.02);
  EXPECT_NEAR(run.velocity(0).z, 0.5, 0.005);
  const Vec3 lost = before - run.momentum();
  EXPECT_LE(length(wall_loads_of(run.simulation->state())[0].impulse - lost), 1e-12 * length(lost));
}

// What is left is the rounding of sums over features, which come in another order: 1e-13 in a force, and some hundred steps.
TEST(Impact, of_two_rocks_of_different_margins_does_not_know_which_is_the_first) {
  constexpr double kRounding = 1e-10;
  for (const ContactLaw law : {ContactLaw::linear, ContactLaw::hunt_crossley}) {
    for (const double range : {0.0, 1e-4}) {
      for (unsigned seed = 1; seed <= 4; ++seed) {
        Vec3 v[2][2], w[2][2];
        for (const std::size_t large : {0u, 1u}) {
          TestRun run(test::empty_scene(1e6, 0.5, 0.4, 0));
          run.scene.settings.law = law;
          run.scene.settings.surface = TouchAt::drawn;
          run.scene.settings.margin_ratio = 0.1;
          run.scene.pairs[0].restitution_speed = 1;
          run.scene.pairs[0].pull_off = range > 0 ? 50 : 0;
          run.scene.pairs[0].adhesion_range = range;
          run.scene.shapes = {make_solid("rock", test::scaled(test::rock(seed, 3), 0.05))};
          std::mt19937 g(seed);
          const Quat turn[] = {test::random_quaternion(g), test::random_quaternion(g)};
          for (const std::size_t i : {0u, 1u}) {
            const bool is_large = i == large;
            test::add_body(run.scene, 0, {0, 0, is_large ? 0.0 : 0.12}, turn[is_large ? 0 : 1], {0, 0, is_large ? 0.5 : -0.5}, {},
                           is_large ? 1.17 : 0.81);
          }
          run.start();
          run.run_for(0.05);
          for (const std::size_t i : {0u, 1u}) {
            v[large][i] = run.velocity(static_cast<std::int64_t>(i == 0 ? large : 1 - large));
            w[large][i] = run.spin(static_cast<std::int64_t>(i == 0 ? large : 1 - large));
          }
        }
        EXPECT_GT(length(w[0][1]), 0.1) << "they have met";
        for (const std::size_t i : {0u, 1u}) {
          EXPECT_LE(length(v[0][i] - v[1][i]), kRounding * length(v[0][i])) << seed;
          EXPECT_LE(length(w[0][i] - w[1][i]), kRounding * length(w[0][i])) << seed;
        }
      }
    }
  }
}

TEST(Impact, of_two_tumbling_rocks_with_friction_conserves_linear_and_angular_momentum) {
  TestRun run(test::empty_scene(1e6, 0.5, 0.5, 0.002));
  run.scene.shapes = {make_solid("a", test::scaled(test::rock(1, 2), 0.05)), make_solid("b", test::scaled(test::rock(2, 2), 0.03))};
  test::add_body(run.scene, 0, {0.01, 0.005, 0.12}, {}, {0.1, 0, -1}, {3, -2, 5});
  test::add_body(run.scene, 1, {0, 0, 0}, {}, {0, 0, 1}, {-4, 6, 1});
  run.start();
  const Vec3 p = run.momentum(), L = run.angular_momentum();
  std::int64_t touched = 0;
  for (int n = 0; n < 4000; ++n) {
    run.simulation->advance();
    touched += contact_count(run.simulation->state());
  }
  EXPECT_GT(touched, 0);
  const double scale = 2000 * 4.19 * 0.05 * 0.05 * 0.05;  // about the sum of masses times speed
  EXPECT_LE(length(run.momentum() - p), 1e-12 * scale);
  EXPECT_LE(length(run.angular_momentum() - L), 1e-12 * scale);
}

TEST(Impact, dissipates_what_the_energies_lose) {
  TestRun run(test::empty_scene(1e6, 0.5, 0.4, 0.002));
  run.scene.settings.steps_per_contact = 100;
  run.scene.settings.gravity = {0, 0, -9.81};
  run.scene.shapes = {make_solid("rock", test::scaled(test::rock(7, 2), 0.05))};
  test::add_body(run.scene, 0, {0, 0, 0.2}, {}, {0.5, 0, -1}, {10, 0, 3});
  test::add_plane(run.scene, {0, 0, 0}, {0, 0, 1});
  run.start();
  const double start = energies_of(run.simulation->state()).balance();
  double peak = 0;
  for (int n = 0; n < 20000; ++n) {
    run.simulation->advance();
    if (n % 100 == 0) {
      const Energies e = energies_of(run.simulation->state());
      peak = std::max(peak, e.translational + e.rotational);
      EXPECT_NEAR(e.balance(), start, 0.005 * peak) << "step " << n;
    }
  }
  EXPECT_GT(energies_of(run.simulation->state()).dissipated, 0.3 * peak);
}

// docs/reference/validation-plan.md F3: v0 = 2, mu = 0.2 stops after v0^2 / (2 mu g) = 1.019368 m.
TEST(Friction, stops_a_sliding_block_where_coulomb_says) {
  TestRun run(test::empty_scene(1e6, 0.5, 0.2, 0.005));
  run.scene.settings.steps_per_contact = 50;
  run.scene.settings.gravity = {0, 0, -9.81};
  run.scene.shapes = {make_solid("block", test::grid_box(2, {0.4, 0.4, 0.1}))};
  // at rest four corners carry the weight: U = k sqrt(2) d^2 / 2 (n = 4, q = 8), so d = m g / (sqrt(2) k)
  const double overlap = 16 * 9.81 / (std::sqrt(2.0) * 1e6);
  test::add_body(run.scene, 0, {0, 0, 0.05 + 0.01 - overlap}, {}, {2, 0, 0});
  test::add_plane(run.scene, {0, 0, 0}, {0, 0, 1});
  run.start();
  run.run_for(1.2);
  EXPECT_NEAR(run.position(0).x, 1.019368, 0.001 * 1.019368);
  EXPECT_LE(length(run.velocity(0)), 2e-6);
}

// Both sides of the threshold tan(alpha) = mu, by tilting gravity.
TEST(Friction, holds_a_block_below_the_angle_of_friction_and_lets_it_slide_above) {
  for (const double degrees : {26.0, 27.0}) {
    TestRun run(test::empty_scene(1e6, 0.5, 0.5, 0.005));
    const double a = degrees * 3.14159265358979 / 180;
    run.scene.settings.gravity = {9.81 * std::sin(a), 0, -9.81 * std::cos(a)};
    run.scene.shapes = {make_solid("block", test::grid_box(1, {0.4, 0.4, 0.1}))};
    test::add_body(run.scene, 0, {0, 0, 0.05 + 0.01});
    test::add_plane(run.scene, {0, 0, 0}, {0, 0, 1});
    run.start();
    run.run_for(1.0);
    const double settled = run.position(0).x;
    run.run_for(1.0);
    const double moved = run.position(0).x - settled;
    if (degrees < 26.565)
      EXPECT_LE(std::abs(moved), 1e-9) << "creep";
    else
      EXPECT_GT(moved, 0.5 * 9.81 * (std::sin(a) - 0.5 * std::cos(a)));
  }
}

TEST(Lists, made_anew_at_random_never_change_the_result) {
  const auto hash_after = [](bool forget) {
    TestRun run(test::empty_scene(1e6, 0.5, 0.5, 0.002));
    run.scene.settings.gravity = {0, 0, -9.81};
    run.scene.shapes = {make_solid("rock", test::scaled(test::rock(5, 2), 0.05))};
    for (int i = 0; i < 8; ++i) test::add_body(run.scene, 0, {0.02 * (i % 3), 0.11 * (i % 2), 0.1 + 0.12 * (i / 2)}, {}, {0, 0, -0.5});
    test::add_plane(run.scene, {0, 0, 0}, {0, 0, 1});
    run.start();
    std::int64_t touched = 0;
    std::mt19937 random(7);  // the same on every rank
    for (int n = 0; n < 5000; ++n) {
      if (forget && random() % 7 == 0) run.simulation->lists().forget_candidates();
      run.simulation->advance();
      if (n % 100 == 0) touched += contact_count(run.simulation->state());
    }
    EXPECT_GT(touched, 20);
    return state_hash(run.simulation->state());
  };
  EXPECT_EQ(hash_after(false), hash_after(true));
}

}  // namespace
}  // namespace scree
