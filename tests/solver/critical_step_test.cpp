// The critical step: exact for one contact, and a bound for networks, against the dense eigenvalues of the whole network.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <random>

#include "solver/step_size/critical_step.hpp"
#include "tests/support/shapes.hpp"
#include "tests/support/test_run.hpp"

namespace scree {
namespace {

using test::TestRun;

struct RandomNetwork {
  std::vector<PairStiffness> pairs;
  std::size_t bodies = 0;
};

/// Bodies of very different masses and inertias, contacts with random levers, normals and stiffnesses; some on fixed walls.
RandomNetwork random_network(std::mt19937& g) {
  std::uniform_real_distribution<double> u(0, 1), s(-1, 1);
  RandomNetwork net;
  net.bodies = 2 + g() % 12;
  std::vector<std::array<double, 4>> inverse(net.bodies);
  for (auto& m : inverse) {
    const double mass = std::pow(10, 2 * s(g)), size = std::pow(mass, 1.0 / 3);
    m = {1 / mass, 0, 0, 0};
    for (std::size_t k = 1; k < 4; ++k) m[k] = 1 / (mass * size * size * (0.1 + u(g)));
  }
  const auto vector = [&] { return Vec3{s(g), s(g), s(g)}; };
  const auto add = [&](std::int32_t a, std::int32_t b, std::int64_t key) {
    PairStiffness pair;
    pair.key = {a, b < 0 ? 1000000 + key : b, b < 0 ? 0 : -1};
    pair.a = a;
    pair.b = b;
    const int contacts = 1 + static_cast<int>(g() % 4);
    for (int c = 0; c < contacts; ++c) {
      const Vec3 n = normalised(vector()), other = normalised(cross(n, vector())), last = cross(n, other);
      const Vec3 ra = vector(), rb = vector();
      const double k = std::pow(10, 4 + u(g));
      for (const auto& [direction, stiffness] : {std::pair(n, k), std::pair(other, 2.0 / 7 * k), std::pair(last, 2.0 / 7 * k)}) {
        std::array<double, 12> mode{};
        const auto half = [&](std::int32_t body, const Vec3& lever, double sign, std::size_t at) {
          const auto& m = inverse[static_cast<std::size_t>(body)];
          const Vec3 torque = cross(std::pow(m[0], -1.0 / 3) * lever, direction);
          for (int i = 0; i < 3; ++i) {
            mode[at + static_cast<std::size_t>(i)] = sign * std::sqrt(m[0]) * direction[i];
            mode[at + 3 + static_cast<std::size_t>(i)] = sign * std::sqrt(m[1 + static_cast<std::size_t>(i)]) * torque[i];
          }
        };
        half(a, ra, 1, 0);
        if (b >= 0) half(b, rb, -1, 6);
        pair.add_mode(stiffness, 0, mode);
      }
    }
    net.pairs.push_back(pair);
  };
  for (std::int32_t b = 1; b < static_cast<std::int32_t>(net.bodies); ++b)
    add(static_cast<std::int32_t>(g() % static_cast<unsigned>(b)), b, 0);
  const int more = static_cast<int>(g() % (2 * net.bodies));
  for (int c = 0; c < more; ++c) {
    const auto a = static_cast<std::int32_t>(g() % net.bodies), b = static_cast<std::int32_t>(g() % net.bodies);
    if (g() % 4 == 0)
      add(a, -1, c);
    else if (a != b)
      add(std::min(a, b), std::max(a, b), c);
  }
  std::sort(net.pairs.begin(), net.pairs.end(), [](const PairStiffness& l, const PairStiffness& r) { return l.key < r.key; });
  return net;
}

double true_critical_step(const RandomNetwork& net) {
  const auto size = static_cast<Eigen::Index>(6 * net.bodies);
  Eigen::MatrixXd K = Eigen::MatrixXd::Zero(size, size);
  for (const PairStiffness& pair : net.pairs) {
    for (std::size_t i = 0; i < 12; ++i) {
      for (std::size_t j = 0; j < 12; ++j) {
        if (pair.b < 0 && (i >= 6 || j >= 6)) continue;
        const auto at = [&](std::size_t k) {
          return static_cast<Eigen::Index>(6 * static_cast<std::size_t>(k < 6 ? pair.a : pair.b) + k % 6);
        };
        K(at(i), at(j)) += pair.stiffness[12 * i + j];
      }
    }
  }
  return 2 / std::sqrt(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(K).eigenvalues().maxCoeff());
}

TEST(CriticalStep, of_300_random_networks_is_never_above_the_true_one_and_at_least_70_percent_of_it) {
  std::mt19937 g(1);
  double least = 1, most = 0, mean = 0;
  for (int n = 0; n < 300; ++n) {
    const RandomNetwork net = random_network(g);
    StabilityBound bounds(net.bodies);
    for (const PairStiffness& pair : net.pairs) bounds.add(pair);
    const double ratio = bounds.critical_step().step / true_critical_step(net);
    least = std::min(least, ratio);
    most = std::max(most, ratio);
    mean += ratio / 300;
  }
  EXPECT_LE(most, 1 + 1e-12);
  EXPECT_GE(least, 0.7);
  RecordProperty("least", std::to_string(least));
  std::printf("critical step over the true one: %.3f to %.3f, mean %.3f\n", least, most, mean);
}

// Kick, drift, kick of x'' = -x with the solver's damping is stable below 2 / omega, and damping lowers the limit.
TEST(CriticalStep, of_one_spring_is_where_the_leapfrog_becomes_unstable) {
  EXPECT_DOUBLE_EQ(largest_stable_step(1, 0), 2);
  EXPECT_DOUBLE_EQ(largest_stable_step(1e8, 0), 2e-4);
  for (const double zeta : {0.05, 0.3, 1.0, 3.0}) {
    const double limit = largest_stable_step(1, 2 * zeta);
    for (const double share : {0.99, 1.01}) {
      const double h = share * limit, c = 2 * zeta / (1 + 0.25 * 2 * zeta * h);
      double x = 1, v = 0;
      for (int i = 0; i < 4000; ++i) {
        x += h * v;
        v += h * (-x - c * v);
      }
      if (share < 1) {
        EXPECT_LE(std::abs(x), 10) << zeta;
      } else {
        EXPECT_FALSE(std::abs(x) <= 100) << zeta;  // infinite after long
      }
    }
  }
}

/// A ball of 1 kg that swings in its contact with a floor (X1), with the step a share of the critical one.
TestRun swinging_ball(double share) {
  const double k = 1e4, radius = 0.5, mass = 1;
  TestRun run(test::empty_scene(k, 1, 0, 0.01, mass / (4.0 / 3 * M_PI * radius * radius * radius)));
  run.scene.settings.gravity = {0, 0, -9.81};
  run.scene.settings.step = share * 2 / std::sqrt(k / mass);
  run.scene.shapes = {make_sphere("ball", radius)};
  test::add_body(run.scene, 0, {0, 0, radius + 0.02 - 0.5 * mass * 9.81 / k});
  run.scene.bodies.lock_rotation[0] = 1;
  test::add_plane(run.scene, {0, 0, 0}, {0, 0, 1});
  return run;
}

TEST(CriticalStep, of_a_single_contact_is_the_true_one_when_told_and_when_derived) {
  TestRun run = swinging_ball(0.5);
  run.start();
  EXPECT_NEAR(run.simulation->critical_step().step, 2e-2, 1e-10);
  EXPECT_NEAR(run.simulation->state().clock.size.critical(), 2e-2, 1e-10);
  // the energy stays bounded just below, and grows just above
  for (const double share : {0.99, 1.01}) {
    TestRun swing = swinging_ball(share);
    swing.start();
    double most = 0;
    for (int n = 0; n < 20; ++n) {
      swing.simulation->advance();
      most = std::max(most, std::abs(swing.position(0).z - 0.52 + 9.81e-4) / (0.5 * 9.81e-4));
    }
    if (share < 1) {
      EXPECT_LE(most, 1.01);
    } else {
      EXPECT_GT(most, 2);
    }
  }
}

// gather = "pairs": N springs side by side have N times the stiffness.
TEST(CriticalStep, of_one_spring_per_triangle_pair_counts_them) {
  TestRun run(test::empty_scene(1e4, 1, 0, 0.01, 1));
  run.scene.settings.gather = Gathering::pairs;
  run.scene.settings.step = 1e-5;
  run.scene.shapes = {make_solid("cube", test::grid_box(2, {1, 1, 1})), make_solid("floor", test::grid_box(1, {3, 3, 1}))};
  test::add_body(run.scene, 0, {0, 0, 1.018});
  test::add_body(run.scene, 1, {0, 0, 0});
  run.scene.bodies.lock_rotation[0] = 1;
  run.scene.bodies.fixed[1] = 1;
  run.start();
  const double springs = static_cast<double>(contact_count(run.simulation->state()));
  EXPECT_GE(springs, 8);
  EXPECT_NEAR(run.simulation->critical_step().step, 2 / std::sqrt(springs * 1e4), 1e-9);
}

// The derived step looks ahead to as many springs as two faces, edges or corners may have, on coarse and fine meshes.
TEST(CriticalStep, derived_for_one_spring_per_triangle_pair_is_not_above_the_one_of_the_contacts_that_occur) {
  for (const int mesh : {0, 1, 2, 3}) {
    TestRun run(test::empty_scene(1e4, 1, 0, 0.01, 1));
    run.scene.settings.gather = Gathering::pairs;
    const TriangleMesh solid = mesh < 2 ? test::grid_box(1 + 7 * mesh, {1, 1, 1}) : test::scaled(test::rock(1, mesh), 0.6);
    run.scene.shapes = {make_solid("solid", solid)};
    test::add_body(run.scene, 0, {0.05, 0.02, mesh < 2 ? 1.021 : 1.4}, {}, {0, 0, -0.5});
    test::add_body(run.scene, 0, {0, 0, 0}, mesh < 2 ? Quat{} : quaternion_of({1, 0, 0}, 2.0), {0, 0, 0.5});
    run.start();
    double critical = 1e300;
    std::int64_t springs = 0;
    for (int n = 0; n < 12000; ++n) {
      run.simulation->advance();
      if (n % 10 != 0) continue;
      critical = std::min(critical, run.simulation->critical_step().step);
      springs = std::max(springs, contact_count(run.simulation->state()));
    }
    run.simulation->agree_on_failures();
    ASSERT_GT(springs, 0) << mesh << ", step " << run.simulation->state().clock.size.step << ", z " << run.position(0).z << " and "
                          << run.position(1).z;
    const double ratio = run.simulation->state().clock.size.critical() / critical;
    std::printf("pairs, mesh %d: up to %lld springs, reckoned with %lld; derived over smallest critical step %.3f\n", mesh,
                static_cast<long long>(springs), std::llround(run.prepared->extent_of_rough_pair(run.prepared->extremes())), ratio);
    EXPECT_LE(ratio, 1.01) << mesh;
    EXPECT_GE(ratio, 0.1) << mesh;  // rocks met by a corner: 6 springs of the 60 that two faces could have
  }
}

// Hertz and Mindlin: with friction a ball turns faster in its contact than it swings. The derived step looks ahead to the largest_overlap
// point.
TEST(CriticalStep, derived_for_hertz_and_mindlin_is_at_least_70_percent_of_the_true_one) {
  for (const bool two : {false, true}) {
    for (const double friction : {0.0, 0.5}) {
      TestRun run(test::empty_scene(0, 1, friction, 0));
      run.scene.settings.law = ContactLaw::hertz_mindlin;
      run.scene.materials[0].young = 1e7;
      run.scene.materials[0].poisson = 0.3;
      run.scene.settings.impact_speed = two ? 2.0 : 1.0;
      run.scene.shapes = {make_sphere("ball", 0.1)};
      test::add_body(run.scene, 0, {0, 0, 0.1001}, {}, {0, 0, -1});
      if (two)
        test::add_body(run.scene, 0, {0, 0, -0.1001}, {}, {0, 0, 1});
      else
        test::add_plane(run.scene, {}, {0, 0, 1});
      run.start();
      double critical = 1e300;
      for (int n = 0; n < 100; ++n) {
        run.simulation->advance();
        critical = std::min(critical, run.simulation->critical_step().step);
      }
      EXPECT_GT(run.velocity(0).z, 0.9) << "no rebound";
      const double ratio = run.simulation->state().clock.size.critical() / critical;
      std::printf("%s, friction %.1f: derived over true critical step %.3f\n", two ? "two balls" : "ball on a wall", friction, ratio);
      EXPECT_LE(ratio, 1.01);
      EXPECT_GE(ratio, 0.7);
    }
  }
}

// A barrier takes what the potential alone could not: the energy comes back, and nothing touches.
TEST(Guards, a_barrier_keeps_apart_what_is_too_fast_for_the_potential) {
  for (const double barrier : {0.0, 20.0}) {
    TestRun run(test::empty_scene(1e4, 1, 0, 0.01, 1));
    run.scene.settings.barrier = barrier;
    run.scene.settings.steps_per_contact = 100;
    run.scene.shapes = {make_solid("cube", test::grid_box(1, {1, 1, 1}))};
    // on its corner: 1.6 times the energy k (2 margin)^2 / 2 that one contact can take
    const double speed = std::sqrt(1.6 * 1e4 * 0.02 * 0.02);
    test::add_body(run.scene, 0, {0, 0, 0.5 * std::sqrt(3.0) + 0.021}, quaternion_of(normalised(Vec3{1, -1, 0}), std::atan(std::sqrt(2.0))),
                   {0, 0, -speed});
    run.scene.bodies.lock_rotation[0] = 1;
    test::add_plane(run.scene, {0, 0, 0}, {0, 0, 1});
    run.start();
    std::string said;
    double largest_overlap = 0;
    try {
      for (double time = 0; time < 0.1; time += run.simulation->state().clock.size.step) {
        run.simulation->advance();
        largest_overlap = std::max(largest_overlap, run.simulation->take_max_overlap_ratio());
      }
      run.simulation->agree_on_failures();
    } catch (const Error& e) {
      said = e.what();
    }
    if (barrier == 0) {
      EXPECT_NE(said.find("of their margin"), std::string::npos) << said;
    } else {
      EXPECT_EQ(said, "");
      EXPECT_GT(largest_overlap, 0.8);
      EXPECT_LT(largest_overlap, 0.999);
      EXPECT_NEAR(run.velocity(0).z, speed, 1e-4 * speed);
    }
  }
}

// Two locked cubes of unequal mass face to face: eight features in one potential, k_eff = 8^(1/4) k, reduced mass.
TEST(CriticalStep, of_two_bodies_face_to_face_is_that_of_their_reduced_mass) {
  TestRun run(test::empty_scene(1e6, 1, 0, 0.002));
  run.scene.shapes = {make_solid("cube", test::grid_box(2, {0.1, 0.1, 0.1}))};
  test::add_body(run.scene, 0, {0, 0, 0.103});
  test::add_body(run.scene, 0, {0, 0, 0}, {}, {}, {}, 1.0);
  run.scene.materials.push_back({"heavy", 9000, 0, 0});
  run.scene.pairs.push_back({0, 1, 1e6, 1, 0, -1, 0});
  run.scene.bodies.material[1] = 1;
  run.scene.bodies.lock_rotation = {1, 1};
  run.start();
  const double reduced = 1 / (1 / 1.0 + 1 / 9.0), stiffness = 1e6 * std::pow(8, 0.25);
  EXPECT_NEAR(run.simulation->critical_step().step, 2 / std::sqrt(stiffness / reduced), 1e-6 * 2e-3);
}

// X8: what moves too fast for its step is refused by name, whether or not the pair is known.
TEST(Guards, name_the_body_that_could_pass_through_another_unseen) {
  for (const double share : {0.5, 3.0, 20.0, 250.0, 600.0}) {  // of the margin sum in a step
    TestRun run(test::empty_scene(1e6, 0.5, 0, 2e-4));
    run.scene.settings.step = 2e-5;
    const double speed = share * 4e-4 / 2e-5;
    // stiff enough for the impact where that is possible at all
    run.scene.pairs[0].stiffness = share < 1 ? 4 * speed * speed / (4e-4 * 4e-4) : 1e7;
    run.scene.settings.step = share < 1 ? 1e-6 : 2e-5;
    run.scene.shapes = {make_solid("cube", test::grid_box(1, {0.1, 0.1, 0.1})), make_solid("plate", test::grid_box(1, {1, 1, 0.001}))};
    test::add_body(run.scene, 0, {0, 0, 0.2}, {}, {0, 0, share < 1 ? -10.0 : -speed});
    test::add_body(run.scene, 1, {0, 0, 0});
    run.scene.bodies.fixed[1] = 1;
    run.scene.bodies.lock_rotation[0] = 1;
    run.start();
    std::string said;
    try {
      for (int n = 0; n < (share < 1 ? 30000 : 2000); ++n) run.simulation->advance();
      run.simulation->agree_on_failures();
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ExitCode::run_invalid);
      said = e.what();
    }
    if (share < 1) {
      EXPECT_EQ(said, "");
      EXPECT_GT(run.velocity(0).z, 0) << "no rebound";
    } else {
      const bool named = said.find("body 0") != std::string::npos || said.find("bodies 0 and 1") != std::string::npos;
      EXPECT_TRUE(named) << said;
      EXPECT_NE(said.find("step "), std::string::npos);
    }
  }
}

// What moves along a surface by many margins a step stays above it: a ball that rolls on a meshed floor, and a box that slides.
TEST(Guards, let_bodies_roll_and_slide_by_many_margins_a_step) {
  for (const bool ball : {true, false}) {
    TestRun run(test::empty_scene(1e4, 0.5, ball ? 0.5 : 0.0, 1e-5, ball ? 1 / (4.0 / 3 * M_PI * 1e-3) : 1000));
    run.scene.settings.gravity = {0, 0, -0.05};
    run.scene.settings.step = 1e-4;
    run.scene.shapes = {ball ? make_sphere("ball", 0.1) : make_solid("box", test::grid_box(1, {0.1, 0.1, 0.1})),
                        make_solid("floor", test::grid_box(3, {4, 4, 0.1}))};
    const double speed = 1.1;  // 5.5 margin sums a step
    const double above = 2e-5 - 0.05 / (ball ? 1e4 : 1e4 * std::sqrt(2.0));
    test::add_body(run.scene, 0, {0, 0.01, (ball ? 0.15 : 0.1) + above}, {}, {speed, 0, 0},
                   {0, ball ? speed / (0.1 + 0.5 * above) : 0.0, 0});  // rolls about the middle of the gap
    test::add_body(run.scene, 1, {0, 0, 0});
    run.scene.bodies.fixed[1] = 1;
    run.start();
    for (int n = 0; n < 1000; ++n) run.simulation->advance();
    run.simulation->agree_on_failures();
    EXPECT_NEAR(run.position(0).x, 0.1 * speed, 1e-6 * speed) << ball;
    EXPECT_NEAR(run.velocity(0).x, speed, 1e-6 * speed) << ball;
  }
}

// Two thin plates that turn and fly through each other between two looks, and one that passes just beside the other.
TEST(Guards, tell_a_passage_from_a_near_miss) {
  for (const double aside : {0.0, 0.1003}) {
    TestRun run(test::empty_scene(1e4, 0.5, 0, 1e-5));
    run.scene.settings.step = 1e-3;
    run.scene.shapes = {make_solid("plate", test::grid_box(1, {0.1, 0.1, 1e-3}))};
    // 4 mm a step, 200 margin sums; the first step ends 2.5 mm beyond the other plate
    test::add_body(run.scene, 0, {aside, 0, 0.0025}, {}, {0, 0, -4}, {0, 0, 0.1});
    test::add_body(run.scene, 0, {0, 0, 0}, {}, {}, {0, 0, -0.1});
    run.start();
    std::string said;
    try {
      for (int n = 0; n < 20; ++n) run.simulation->advance();
      run.simulation->agree_on_failures();
    } catch (const Error& e) {
      said = e.what();
    }
    if (aside > 0) {
      EXPECT_EQ(said, "");
    } else {
      EXPECT_NE(said.find("could have passed through each other"), std::string::npos) << said;
    }
  }
}

// X22 and section 4.3: the derived step follows spin and approach, and says so.
TEST(StepSize, follows_spin_and_approach_where_they_limit_it) {
  TestRun run(test::empty_scene(1e2, 0.5, 0.3, 0.001));
  run.scene.shapes = {make_solid("rod", test::grid_box(1, {0.1, 0.01, 0.01}))};
  test::add_body(run.scene, 0, {0, 0, 0.1}, {}, {}, {0, 0, 1});
  test::add_body(run.scene, 0, {0, 0, 0.5}, {}, {}, {0, 0, 1e4});
  test::add_plane(run.scene, {0, 0, 0}, {0, 0, 1});
  run.start();
  EXPECT_LE(1e4 * run.simulation->state().clock.size.step, 0.1);
  EXPECT_NE(run.simulation->state().clock.size.limited_by.find("body 1"), std::string::npos)
      << run.simulation->state().clock.size.limited_by;
  run.scene.bodies.angular_velocity[1] = {};
  run.start();
  const double by_contact = run.simulation->state().clock.size.step;
  run.scene.bodies.velocity[0] = {0, 0, 100};
  run.start();
  EXPECT_NEAR(100 * run.simulation->state().clock.size.step, 0.2 * 0.002, 0.2 * 0.002 * 0.01) << "with what its own spin adds";
  EXPECT_EQ(run.simulation->state().clock.size.limited_by, "the approach of bodies 0 and 1 against their margins");
  run.scene.bodies.velocity[0] = {100, 0, 0};  // beside the other rod, along the plane
  run.start();
  EXPECT_EQ(run.simulation->state().clock.size.step, by_contact);
}

// A cube spins on a floor until friction has slowed it: the level is chosen at the start, and the step grows again.
TEST(StepSize, quantised_is_halved_for_speed_and_grows_back_when_quiet) {
  TestRun run(test::empty_scene(1e4, 0.3, 0.5, 0.002));
  run.scene.settings.step_control = StepControl::quantised;
  run.scene.settings.gravity = {0, 0, -9.81};
  run.scene.shapes = {make_solid("cube", test::grid_box(1, {0.1, 0.1, 0.1}))};
  test::add_body(run.scene, 0, {0, 0, 0.0539}, {}, {}, {0, 0, 120});
  test::add_plane(run.scene, {0, 0, 0}, {0, 0, 1});
  run.scene.settings.step = 1e-3;
  run.start();
  const double base = run.simulation->state().clock.size.step;
  EXPECT_LE((120 * std::hypot(0.05, 0.05)) * run.simulation->state().clock.dt, 0.2 * 0.002);
  const double start = energies_of(run.simulation->state()).balance();
  double kinetic = 0;
  std::vector<StepChange> changes = run.simulation->levels().take_changes();
  for (int n = 0; n < 3000; ++n) {
    run.simulation->advance();
    EXPECT_DOUBLE_EQ(run.simulation->time(), (n + 1) * base);
    const Energies e = energies_of(run.simulation->state());
    kinetic = std::max(kinetic, e.translational + e.rotational);
    EXPECT_LE(std::abs(e.balance() - start), 0.02 * kinetic);
    for (const StepChange& c : run.simulation->levels().take_changes()) changes.push_back(c);
  }
  ASSERT_GE(changes.size(), 2u);
  EXPECT_EQ(changes.front().reason, "speed of body 0");
  for (const StepChange& c : changes) EXPECT_EQ(std::exp2(std::round(std::log2(base / c.step_size))), base / c.step_size);
  EXPECT_GT(run.simulation->state().clock.dt, changes.front().step_size) << "never grew back";
}

// X27: a step far too large is refused at the start, naming who cannot bear it.
TEST(StepSize, far_too_large_is_refused_with_the_pair_that_limits_it) {
  TestRun run = swinging_ball(3);
  try {
    run.start();
    FAIL() << "not refused";
  } catch (const Error& e) {  // agreed on by all ranks
    EXPECT_EQ(e.code(), ExitCode::usage);
    EXPECT_NE(std::string(e.what()).find("body 0 (rock) on fixed rock"), std::string::npos) << e.what();
  }
}

}  // namespace
}  // namespace scree
