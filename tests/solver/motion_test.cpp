// Whole steps with every integrator: what an impact makes of them, and that they agree in the limit.
#include <gtest/gtest.h>

#include <cstring>
#include <random>

#include "solver/bodies/motion.hpp"
#include "solver/bodies/sine_cosine.hpp"
#include "tests/support/shapes.hpp"
#include "tests/support/test_run.hpp"

namespace scree {
namespace {

using test::TestRun;

/// Speed after an elastic impact of a cube, rotation locked, on a plane at 1 m/s, `steps` steps a contact.
double rebound(Integrator integrator, double steps, double phase) {
  TestRun run(test::empty_scene(1e4, 1, 0, 0.01, 1));
  run.scene.settings.integrator = integrator;
  // four corners carry 1 kg: k_eff = sqrt(2) k
  run.scene.settings.step = M_PI / std::sqrt(std::sqrt(2.0) * 1e4) / steps;
  run.scene.shapes = {make_solid("cube", test::grid_box(1, {1, 1, 1}))};
  // the first contact falls at a fraction `phase` of a step
  test::add_body(run.scene, 0, {0, 0, 0.52 + (3 + phase) * run.scene.settings.step}, {}, {0, 0, -1});
  run.scene.bodies.lock_rotation[0] = 1;
  test::add_plane(run.scene, {0, 0, 0}, {0, 0, 1});
  run.start();
  run.run_for(0.2);
  return run.velocity(0).z;
}

// Small angles to rounding; of larger ones a right angle is taken off as often as it takes, rounded to 6e-17.
TEST(SineAndCosine, are_those_of_long_doubles) {
  constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
  for (const double largest : {1e-9, 1e-3, kSmallAngle, 0.8, 3.2, 50.0}) {
    for (int n = -1000; n <= 1000; ++n) {
      const double a = largest * n / 1000, allowed = kEpsilon * std::min(std::abs(a), 1.5) + 4e-17 * std::abs(a);
      double sine = 0, cosine = 0;
      sine_and_cosine(a, sine, cosine);
      EXPECT_NEAR(sine, static_cast<double>(std::sin(static_cast<long double>(a))), allowed) << a;
      EXPECT_NEAR(cosine, static_cast<double>(std::cos(static_cast<long double>(a))), kEpsilon + allowed) << a;
    }
  }
  double sine = 0, cosine = 0;
  sine_and_cosine(INFINITY, sine, cosine);
  EXPECT_TRUE(std::isnan(sine) && std::isnan(cosine));
}

/// Bodies of all kinds in no order: with and without three equal moments, fixed, without rotation, at rest; some that turn fast.
ParticleSet motley_bodies(std::size_t count) {
  std::mt19937 engine(3);
  std::normal_distribution<double> normal;
  const auto random = [&](double size) { return size * Vec3{normal(engine), normal(engine), normal(engine)}; };
  ParticleSet p;
  p.resize(count);
  p.owned = count;
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3 axis = random(1);
    const bool rests = engine() % 5 == 0;
    p.x[i] = random(1);
    p.q[i] = rotation_by(axis);
    p.v[i] = rests ? Vec3{} : random(1);
    p.force[i] = rests ? Vec3{} : random(10);
    p.torque[i] = rests ? Vec3{} : random(1e-3);
    p.isotropic[i] = engine() % 2;
    p.fixed[i] = engine() % 7 == 0;
    p.lock_rotation[i] = engine() % 6 == 0;
    p.inverse_mass[i] = p.fixed[i] ? 0 : 2;
    p.inertia[i] = p.isotropic[i] ? Vec3{1e-3, 1e-3, 1e-3} : Vec3{1e-3, 2e-3, 2.5e-3};
    if (!p.fixed[i] && !p.lock_rotation[i]) p.inverse_inertia[i] = {1 / p.inertia[i].x, 1 / p.inertia[i].y, 1 / p.inertia[i].z};
    p.L[i] = rests ? Vec3{} : random(engine() % 3 == 0 ? 1.0 : 1e-3);  // the fast ones turn by more than the short series is good for
    p.w[i] = angular_velocity(p.q[i], p.inverse_inertia[i], p.L[i]);
  }
  return p;
}

// A set of one body has no whole vector, and goes the plain way.
TEST(Motion, of_bodies_side_by_side_is_that_of_each_alone_to_the_bit) {
  for (const Integrator integrator : {Integrator::kdk_dlm, Integrator::midpoint, Integrator::euler}) {
    constexpr std::size_t kCount = 75;
    constexpr double kStep = 1e-3;
    ParticleSet all = motley_bodies(kCount);
    std::vector<ParticleSet> alone(kCount);
    for (std::size_t i = 0; i < kCount; ++i) {
      ParticleSet copy = all;
      copy.copy_row(i, 0);
      copy.resize(1);
      copy.owned = 1;
      alone[i] = copy;
    }
    const auto step = [&](ParticleSet& p) {
      begin_step(integrator, p, kStep);
      end_step(integrator, p, kStep);
    };
    for (int n = 0; n < 20; ++n) {
      step(all);
      for (ParticleSet& p : alone) step(p);
    }
    for (std::size_t i = 0; i < kCount; ++i) {
      const auto same = [&](const auto& column, const auto& other) { return std::memcmp(&column[i], &other[0], sizeof(other[0])) == 0; };
      const ParticleSet& one = alone[i];
      EXPECT_TRUE(same(all.x, one.x) && same(all.x_remainder, one.x_remainder) && same(all.v, one.v)) << word_of(integrator) << " " << i;
      EXPECT_TRUE(same(all.q, one.q) && same(all.q_remainder, one.q_remainder)) << word_of(integrator) << " " << i;
      EXPECT_TRUE(same(all.L, one.L) && same(all.w, one.w)) << word_of(integrator) << " " << i;
    }
  }
}

// docs/reference/validation-plan.md C1 and D5: the default errs by at most 2.6e-4 at 20 steps a contact over all phases; explicit Euler
// gains exp(pi^2 / (2 N)) = 28 % at 20.
TEST(Integrator, keeps_the_speed_of_an_elastic_impact_except_eulers) {
  for (const Integrator integrator : {Integrator::kdk_dlm, Integrator::midpoint, Integrator::spiral, Integrator::rig}) {
    double worst = 0;
    for (int phase = 0; phase < 11; ++phase) worst = std::max(worst, std::abs(rebound(integrator, 20, phase / 11.0) - 1));
    EXPECT_LE(worst, 2.6e-4 * 1.05) << word_of(integrator);
  }
  EXPECT_NEAR(rebound(Integrator::euler, 20, 0.5), std::exp(M_PI * M_PI / 40), 0.03);
  EXPECT_NEAR(rebound(Integrator::euler, 200, 0.5), std::exp(M_PI * M_PI / 400), 0.003);
}

// 4e-18 m a step is a seventh of the distance of neighbouring numbers at 0.2 m: a body as slow as that moves all the same.
TEST(Integrator, moves_a_body_that_is_slower_than_rounding) {
  for (const Integrator integrator : {Integrator::kdk_dlm, Integrator::midpoint, Integrator::spiral, Integrator::rig, Integrator::euler}) {
    TestRun run(test::empty_scene(1e4, 1, 0, 0.01, 1));
    run.scene.settings.integrator = integrator;
    run.scene.settings.step = 1e-6;
    run.scene.shapes = {make_solid("cube", test::grid_box(1, {1, 1, 1}))};
    test::add_body(run.scene, 0, {0.2, -0.2, 0.15}, {}, {4e-12, 3e-12, -2e-12});
    run.start();
    run.run_for(0.02);  // 20 000 steps
    const Vec3 way = run.position(0) - Vec3{0.2, -0.2, 0.15};
    EXPECT_NEAR(way.x, 8e-14, 3e-17) << word_of(integrator);
    EXPECT_NEAR(way.y, 6e-14, 3e-17) << word_of(integrator);
    EXPECT_NEAR(way.z, -4e-14, 3e-17) << word_of(integrator);
  }
}

// Rounding moves the overlap of a stiff contact, 1e-8 m here, up and down by a hundred-millionth of itself. Springs that followed it would
// lose that much a step, and the stone creep at 1e-11 m/s indefinitely.
TEST(Integrator, keeps_a_stiff_stone_between_others_without_creep) {
  TestRun run(test::empty_scene(1e8, 0.3, 0.7, 0.003));
  run.scene.settings.gravity = {0, 0, -9.81};
  run.scene.shapes = {make_solid("stone", test::grid_box(1, {0.07, 0.07, 0.07}))};
  for (int k = 0; k < 3; ++k) {
    const double angle = 2 * M_PI / 3 * k, tilt = 0.4 + 0.7 * k;
    test::add_body(run.scene, 0, Vec3{0.2, 0.1, 0.3} + 0.065 * Vec3{std::cos(angle), std::sin(angle), 0},
                   quaternion_of(normalised(Vec3{1, 0.5 * k, 0.3}), tilt));
    run.scene.bodies.fixed.back() = 1;
  }
  test::add_body(run.scene, 0, {0.2, 0.1, 0.42});
  run.start();
  run.run_for(0.8);
  const Vec3 settled = run.position(3);
  EXPECT_GE(active_pair_count(run.simulation->state()), 2);
  run.run_for(0.01);
  EXPECT_LE(length(run.position(3) - settled), 1e-16);  // 8e-15 with springs that follow
  EXPECT_LE(length(run.velocity(3)), 2e-13);            // 1e-12
}

// A tumbling rock with friction on a floor: every scheme goes to the same state, Euler at first order.
TEST(Integrator, meets_the_others_as_the_step_shrinks) {
  const auto state = [](Integrator integrator, double steps) {
    TestRun run(test::empty_scene(1e6, 0.5, 0.4, 0.002));
    run.scene.settings.integrator = integrator;
    run.scene.settings.gravity = {0, 0, -9.81};
    run.scene.settings.steps_per_contact = steps;
    run.scene.shapes = {make_solid("rock", test::scaled(test::rock(7, 2), 0.05))};
    test::add_body(run.scene, 0, {0, 0, 0.07}, {}, {0.5, 0, -1}, {10, 0, 3});
    test::add_plane(run.scene, {0, 0, 0}, {0, 0, 1});
    run.start();
    run.run_for(0.04);
    return std::pair(run.velocity(0), run.spin(0));
  };
  const auto [v, w] = state(Integrator::kdk_dlm, 1600);
  EXPECT_GT(length(w - Vec3{10, 0, 3}), 1) << "no impact happened";
  for (const Integrator integrator : {Integrator::midpoint, Integrator::spiral, Integrator::rig, Integrator::euler}) {
    const auto [vi, wi] = state(integrator, 400);
    const double limit = integrator == Integrator::euler ? 0.03 : 0.004;
    EXPECT_LE(length(vi - v), limit * length(v)) << word_of(integrator);
    EXPECT_LE(length(wi - w), limit * length(w)) << word_of(integrator);
  }
}

}  // namespace
}  // namespace scree
