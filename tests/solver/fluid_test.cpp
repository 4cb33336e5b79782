// Bodies in a fluid, held against closed forms: Stokes, Kirchhoff, Archimedes; published drag of balls and of Platonic solids.
#include "solver/bodies/fluid.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "solver/run/rest_watch.hpp"
#include "tests/support/shapes.hpp"
#include "tests/support/test_run.hpp"

namespace scree {
namespace {

using test::TestRun;

constexpr double kDensity = 2500, kGravity = 9.81;
constexpr double kRounding = 1e-12;  // of some thousand steps: solutions in time are exact

/// A ball of diameter d [m] in a fluid.
TestRun ball_in(double d, const Fluid& fluid, double step, const Vec3& velocity = {}, const Vec3& spin = {}) {
  TestRun run(test::empty_scene(1e4, 1, 0, 0, kDensity));
  run.scene.settings.fluid = fluid;
  run.scene.settings.step = step;
  run.scene.shapes = {make_sphere("ball", 0.5 * d)};
  test::add_body(run.scene, 0, {}, {}, velocity, spin);
  return run;
}

void advance(TestRun& run, int steps) {
  for (int n = 0; n < steps; ++n) run.simulation->advance();
}

// The relaxation time is 1/9 ms: steps of twice as long, which no explicit scheme survives.
TEST(Fluid, slows_a_ball_down_as_stokes_says_at_any_step) {
  const double d = 2e-3, viscosity = 5, rate = 18 * viscosity / (kDensity * d * d);
  for (const Vec3 stream : {Vec3{}, Vec3{0.5, 0, -2}}) {
    for (const double step : {1e-6, 2e-4}) {
      const Vec3 start{1, 2, 3};
      TestRun run = ball_in(d, {1000, viscosity, stream, Drag::stokes}, step, start);
      run.start();
      advance(run, 5);
      const Vec3 expected = stream + std::exp(-rate * 5 * step) * (start - stream);
      EXPECT_LE(length(run.velocity(0) - expected), kRounding * length(start)) << step;
    }
  }
}

TEST(Fluid, lets_a_ball_fall_as_stokes_says) {
  const double d = 1e-3, viscosity = 0.1, fluid = 900, rate = 18 * viscosity / (kDensity * d * d);
  const double terminal = (kDensity - fluid) * kGravity * d * d / (18 * viscosity);
  for (const Integrator integrator : {Integrator::kdk_dlm, Integrator::rig, Integrator::spiral, Integrator::midpoint, Integrator::euler}) {
    TestRun run = ball_in(d, {fluid, viscosity, {}, Drag::stokes}, 2e-4);
    run.scene.settings.gravity = {0, 0, -kGravity};
    run.scene.settings.integrator = integrator;
    run.start();
    EXPECT_NEAR(FluidForces(run.scene).terminal_speed(kind_of(run.scene.bodies, 0)), terminal, kRounding * terminal);
    advance(run, 5);
    EXPECT_NEAR(run.velocity(0).z, -terminal * (1 - std::exp(-rate * 1e-3)), kRounding * terminal) << word_of(integrator);
    advance(run, 1000);
    EXPECT_NEAR(run.velocity(0).z, -terminal, kRounding * terminal) << word_of(integrator);
  }
}

TEST(Fluid, brakes_the_spin_of_a_ball_by_eight_pi_mu_r_cubed) {
  const double d = 2e-3, r = 0.5 * d, viscosity = 0.8, mass = kDensity * 4 / 3 * M_PI * r * r * r;
  const double rate = 8 * M_PI * viscosity * r * r * r / (0.4 * mass * r * r);
  TestRun run = ball_in(d, {1000, viscosity, {3, 0, 0}, Drag::stokes}, 1e-4, {3, 0, 0}, {1, -2, 5});
  run.start();
  advance(run, 20);
  EXPECT_LE(length(run.spin(0) - std::exp(-rate * 2e-3) * Vec3{1, -2, 5}), kRounding * 6);
  EXPECT_EQ(run.velocity(0), (Vec3{3, 0, 0})) << "a stream without shear turns nothing and leaves what swims with it";
}

// About a principal axis each moment of inertia has its own time. The moment is that of the ball of equal volume: pi mu d^3 w.
TEST(Fluid, brakes_a_box_about_each_axis_by_its_own_inertia) {
  const Vec3 sides{0.4, 0.2, 0.1};
  const double volume = 0.008, mass = kDensity * volume, viscosity = 300, moment = 6 * viscosity * volume;
  const double inertia[3] = {mass / 12 * (0.04 + 0.01), mass / 12 * (0.16 + 0.01), mass / 12 * (0.16 + 0.04)};
  for (int axis = 0; axis < 3; ++axis) {
    TestRun run(test::empty_scene(1e4, 1, 0, 1e-3, kDensity));
    run.scene.settings.fluid = Fluid{1000, viscosity, {}, Drag::stokes};
    run.scene.settings.step = 1e-3;
    run.scene.shapes = {make_solid("box", test::grid_box(1, sides))};
    Vec3 spin;
    spin[axis] = 2;
    test::add_body(run.scene, 0, {}, {}, {}, spin);
    run.start();
    advance(run, 100);
    EXPECT_NEAR(run.spin(0)[axis], 2 * std::exp(-moment / inertia[axis] * 0.1), 1e-11) << axis;
  }
}

// Dennis, Singh & Ingham at Re = 400: torque 1.922 times that of a slow spin. The rate over a short time; it falls as the spin does.
TEST(Fluid, brakes_a_fast_spin_as_measured) {
  const double d = 2e-3, viscosity = 1e-3, w = 100, rate = 60 * viscosity / (kDensity * d * d);
  TestRun run = ball_in(d, {1000, viscosity, {}, Drag::haider_levenspiel}, 1e-5, {}, {0, 0, w});
  run.start();
  advance(run, 10);
  EXPECT_NEAR(-std::log(run.spin(0).z / w) / 1e-4 / rate, (12.9 * 20 + 128.4) / (64 * M_PI), 1e-3 * 1.922);
}

double drag_coefficient(const DragCoefficients& law, double reynolds) { return 24 / reynolds * law.over_stokes(reynolds); }

// The standard drag curve: Clift, Grace & Weber (1978), table 5.2; the two fits lie within 5 % of each other.
TEST(Fluid, has_the_standard_drag_of_balls) {
  EXPECT_NEAR(drag_coefficient(drag_of_ball(), 1e-6) * 1e-6 / 24, 1, 1e-4);
  EXPECT_NEAR(drag_coefficient(drag_of_ball(), 100), 1.09, 0.05 * 1.09);
  EXPECT_NEAR(drag_coefficient(drag_of_ball(), 1000), 0.47, 0.05 * 0.47);
}

// Pettyjohn & Christiansen, Chem. Eng. Prog. 44 (1948) 157: 5.31 - 4.88 sphericity in Newton's regime, for Platonic and similar solids.
TEST(Fluid, has_the_measured_drag_of_tetrahedra_cubes_and_octahedra) {
  for (const double sphericity : {0.670, 0.806, 0.846}) {
    const double expected = 5.31 - 4.88 * sphericity;
    EXPECT_NEAR(drag_coefficient(drag_of_sphericity(sphericity), 1e4), expected, 0.1 * expected) << sphericity;
  }
}

/// dv/dt = g - k(v) v by the classical Runge-Kutta scheme.
double integrate(const std::function<double(double)>& rate, double v, double duration, int steps) {
  const double h = duration / steps;
  for (int n = 0; n < steps; ++n) {
    const double a = rate(v), b = rate(v + 0.5 * h * a), c = rate(v + 0.5 * h * b), d = rate(v + h * c);
    v += h / 6 * (a + 2 * b + 2 * c + d);
  }
  return v;
}

// A glass ball of 5 mm falls in water, to Re = 2300: weight and drag by the coefficients printed in the paper.
TEST(Fluid, lets_a_ball_fall_in_water_as_published_in_second_order) {
  const double d = 5e-3, rho = 998, mu = 1e-3;
  const auto acceleration = [&](double v) {
    const double re = rho * v * d / mu, cd = re > 0 ? 24 / re * (1 + 0.1806 * std::pow(re, 0.6459)) + 0.4251 / (1 + 6880.95 / re) : 0;
    return (1 - rho / kDensity) * kGravity - 0.75 * cd * rho / kDensity * v * v / d;
  };
  const auto fall = [&](double duration, int steps) {
    TestRun run = ball_in(d, {rho, mu, {}, Drag::haider_levenspiel}, duration / steps);
    run.scene.settings.gravity = {kGravity, 0, 0};
    run.start();
    advance(run, steps);
    return run.velocity(0).x;
  };
  const double expected = integrate(acceleration, 0, 0.05, 4000);
  const double coarse = fall(0.05, 50) - expected, fine = fall(0.05, 100) - expected;
  EXPECT_LE(std::abs(fine), 1e-4 * expected);
  EXPECT_NEAR(std::log2(std::abs(coarse / fine)), 2, 0.2);
  const double terminal = fall(10, 2000);
  EXPECT_NEAR(acceleration(terminal), 0, 1e-9 * kGravity);
  TestRun run = ball_in(d, {rho, mu, {}, Drag::haider_levenspiel}, 1);
  run.scene.settings.gravity = {kGravity, 0, 0};
  EXPECT_NEAR(FluidForces(run.scene).terminal_speed(kind_of(run.scene.bodies, 0)), terminal, 1e-9 * terminal);
  EXPECT_NEAR(fall(1e6, 20), terminal, 1e-9 * terminal) << "no step is too large";
}

TEST(Fluid, holds_a_body_of_its_own_density_still) {
  TestRun run = ball_in(0.01, {kDensity, 1e-3, {}, Drag::haider_levenspiel}, 1e-3);
  run.scene.settings.gravity = {0, 0, -kGravity};
  run.start();
  advance(run, 1000);
  EXPECT_EQ(run.position(0), Vec3{});
  EXPECT_EQ(run.velocity(0), Vec3{});
  EXPECT_EQ(energies_of(run.simulation->state()).balance(), 0);
}

TEST(Fluid, lets_what_is_lighter_rise) {
  TestRun run = ball_in(0.01, {2 * kDensity, 1e-3, {}, Drag::haider_levenspiel}, 1e-5);
  run.scene.settings.gravity = {0, 0, -kGravity};
  run.start();
  run.simulation->advance();
  EXPECT_NEAR(run.velocity(0).z, kGravity * 1e-5, 1e-3 * kGravity * 1e-5) << "weight minus twice the weight";
}

// In pitch a ball sinks by a diameter in months: its energy then is far below what tells rest in a void.
TEST(Fluid, does_not_take_slow_sinking_for_rest) {
  TestRun run = ball_in(0.01, {1000, 1e8, {}, Drag::haider_levenspiel}, 1);
  run.scene.settings.gravity = {0, 0, -kGravity};
  run.scene.settings.stop_at_rest = true;
  const double mass = run.scene.mass(0), speed = FluidForces(run.scene).terminal_speed(kind_of(run.scene.bodies, 0));
  EXPECT_LT(0.5 * mass * speed * speed, RestWatch::kRestShare * mass * kGravity * 0.01);
  RestWatch watch(run.scene);
  watch.add(100, 0.5 * mass * speed * speed);
  EXPECT_FALSE(watch.at_rest(100));
  watch.add(101, 0);
  EXPECT_TRUE(watch.at_rest(101));
}

// A spinning box falls through a stream onto a floor and off it: what goes into the fluid, or comes from it, is counted.
TEST(Fluid, closes_the_balance_of_energy) {
  const auto error = [](double steps_per_contact, Outside outside) {
    TestRun run(test::empty_scene(1e5, 0.5, 0.3, 1e-3, kDensity));
    run.scene.settings.fluid = Fluid{998, 1e-3, {0.8, 0, 0}, Drag::haider_levenspiel};
    run.scene.settings.gravity = {0, 0, -kGravity};
    run.scene.settings.steps_per_contact = steps_per_contact;
    run.scene.settings.domain.bounded = true;
    run.scene.settings.domain.lower = {-1, -1, -1};
    run.scene.settings.domain.upper = {0.03, 1, 1};
    run.scene.settings.domain.outside = outside;
    run.scene.shapes = {make_solid("box", test::grid_box(1, {0.04, 0.02, 0.01}))};
    test::add_body(run.scene, 0, {0, 0, 0.04}, quaternion_of(normalised(Vec3{1, 2, 3}), 1), {}, {3, 10, -5});
    test::add_plane(run.scene, {0, 0, 0}, {0, 0, 1});
    run.start();
    const double start = energies_of(run.simulation->state()).balance();
    run.run_for(0.25);
    const Energies e = energies_of(run.simulation->state());
    const bool removed = body_count(run.simulation->state()) == 0;
    EXPECT_EQ(removed, outside == Outside::remove);
    EXPECT_NE(e.dissipated, 0);
    return std::abs(e.balance() - start) / std::abs(start);
  };
  EXPECT_LE(error(40, Outside::keep), 1e-3);
  EXPECT_LE(error(40, Outside::remove), 1e-3);
}

}  // namespace
}  // namespace scree
