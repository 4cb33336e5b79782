// Periodic axes and what becomes of bodies that leave the domain.
#include <gtest/gtest.h>

#include "tests/support/shapes.hpp"
#include "tests/support/test_run.hpp"

namespace scree {
namespace {

using test::TestRun;

void make_periodic(Scene& scene, const Vec3& lower, const Vec3& upper, std::array<bool, 3> axes) {
  Domain& d = scene.settings.domain;
  d.bounded = true;
  d.lower = lower;
  d.upper = upper;
  d.periodic = axes;
}

/// Two tumbling rocks that meet, rub and part about `place`, in a box of 1 x 1 x 1 m around the origin.
TestRun meeting_rocks(const Vec3& place, std::array<bool, 3> axes) {
  TestRun run(test::empty_scene(1e6, 0.5, 0.5, 0.002));
  make_periodic(run.scene, {-0.5, -0.5, -0.5}, {0.5, 0.5, 0.5}, axes);
  run.scene.settings.domain.outside = Outside::keep;
  run.scene.shapes = {make_solid("a", test::scaled(test::rock(1, 2), 0.05)), make_solid("b", test::scaled(test::rock(2, 2), 0.03))};
  const auto wrapped = [](Vec3 x) {
    for (int k = 0; k < 3; ++k) x[k] -= std::floor(x[k] + 0.5);
    return x;
  };
  test::add_body(run.scene, 0, wrapped(place + Vec3{0.06, 0.005, 0.01}), {}, {-1, 0.1, 0}, {3, -2, 5});
  test::add_body(run.scene, 1, wrapped(place + Vec3{-0.06, 0, 0}), {}, {1, 0, 0}, {-4, 6, 1});
  return run;
}

// In the middle of the box, and with the contact on a face, an edge and a corner of the box, centres on both sides.
TEST(PeriodicAxes, a_contact_through_the_seam_equals_the_same_contact_elsewhere) {
  TestRun inside = meeting_rocks({}, {false, false, false});
  inside.start();
  const int steps = static_cast<int>(0.06 / inside.simulation->state().clock.size.step);
  for (const Vec3& place : {Vec3{0.5, 0, 0}, Vec3{0.499, 0.5, 0.1}, Vec3{-0.5, 0.5, 0.5}}) {
    TestRun seam = meeting_rocks(place, {true, true, true});
    seam.start();
    const Vec3 momentum = seam.momentum();
    TestRun reference = meeting_rocks({}, {false, false, false});
    reference.start();
    std::int64_t touched = 0;
    double springs = 0;
    for (int n = 0; n < steps; ++n) {
      seam.simulation->advance();
      reference.simulation->advance();
      touched += contact_count(seam.simulation->state());
      springs = std::max(springs, energies_of(seam.simulation->state()).tangential_elastic);
    }
    EXPECT_GT(touched, 10);
    EXPECT_GT(springs, 0) << "friction has no memory";
    for (int id = 0; id < 2; ++id) {
      Vec3 off = seam.position(id) - reference.position(id) - place;
      for (int k = 0; k < 3; ++k) off[k] -= std::round(off[k]);
      // positions are rounded at 1e-16 m; an impact multiplies that by about its number of steps
      EXPECT_LE(length(off), 1e-11) << id;
      EXPECT_LE(length(seam.velocity(id) - reference.velocity(id)), 1e-9) << id;
      EXPECT_LE(length(seam.spin(id) - reference.spin(id)), 1e-7) << id;
    }
    EXPECT_GT(length(seam.velocity(0) - Vec3{-1, 0.1, 0}), 0.1) << "no impact happened";
    EXPECT_LE(length(seam.momentum() - momentum), 1e-12 * (momentum.x + 1));
  }
}

// A body that rests on a floor slides through the seam with its friction: it stops where Coulomb says, twice around.
TEST(PeriodicAxes, keep_friction_and_energy_of_a_body_that_slides_around) {
  TestRun run(test::empty_scene(1e6, 0.5, 0.2, 0.005));
  make_periodic(run.scene, {-0.25, -0.25, -1}, {0.25, 0.25, 1}, {true, true, false});
  run.scene.settings.gravity = {0, 0, -9.81};
  run.scene.shapes = {make_solid("block", test::grid_box(1, {0.1, 0.1, 0.04}))};
  const double overlap = 0.4 * 9.81 / (std::sqrt(2.0) * 1e6);
  test::add_body(run.scene, 0, {0.1, 0, 0.02 + 0.01 - overlap}, {}, {2, 0, 0});
  test::add_plane(run.scene, {0, 0, 0}, {0, 0, 1});
  run.start();
  const double start = energies_of(run.simulation->state()).balance();
  run.run_for(1.2);
  const double expected = 0.1 + 1.019368;  // v^2 / (2 mu g) further
  EXPECT_NEAR(run.position(0).x, expected - 2 * 0.5, 0.001 * 1.019368);
  EXPECT_NEAR(energies_of(run.simulation->state()).balance(), start, 1e-3 * 0.5 * 0.4 * 4);
}

// A chute: gravity along a periodic axis. What a body gains in height it must not lose at the seam.
TEST(PeriodicAxes, keep_the_energy_of_a_body_that_falls_along_them) {
  TestRun run(test::empty_scene(1e6, 0.5, 0, 0.002));
  make_periodic(run.scene, {-0.5, -0.5, -0.5}, {0.5, 0.5, 0.5}, {true, false, true});
  run.scene.settings.gravity = {3, 0, -9.81};
  run.scene.shapes = {make_solid("rock", test::scaled(test::rock(3, 1), 0.05))};
  test::add_body(run.scene, 0, {0, 0, 0});
  run.start();
  const double start = energies_of(run.simulation->state()).balance();
  run.run_for(1.0);
  const double fallen = 0.5 * 9.81 * run.simulation->time() * run.simulation->time();
  EXPECT_NEAR(run.position(0).z, -fallen + std::round(fallen), 1e-6);
  const double mass = energies_of(run.simulation->state()).translational / (0.5 * (9.81 * 9.81 + 9) * std::pow(run.simulation->time(), 2));
  EXPECT_NEAR(energies_of(run.simulation->state()).balance(), start, 1e-9 * mass * 9.81 * fallen);
}

TEST(PeriodicAxes, that_are_too_short_or_met_by_a_wall_are_refused) {
  const auto refusal = [](Scene scene) -> std::string {
    try {
      SolverScene prepared(scene);
      return "";
    } catch (const UsageError& e) {
      return e.what();
    }
  };
  Scene scene = meeting_rocks({}, {true, false, false}).scene;
  EXPECT_EQ(refusal(scene), "");
  scene.settings.domain.upper.x = -0.3;
  EXPECT_NE(refusal(scene).find("body 0"), std::string::npos) << refusal(scene);
  scene.settings.domain.upper.x = 0.5;
  test::add_plane(scene, {0, 0, -0.4}, {0, 0, 1});
  EXPECT_EQ(refusal(scene), "") << "a floor along the axis";
  test::add_plane(scene, {0, 0, -0.4}, normalised(Vec3{0.1, 0, 1}));
  EXPECT_NE(refusal(scene).find("periodic axis x"), std::string::npos);
  scene.walls.pop_back();
  scene.walls[0].kind = WallKind::box_inside;
  scene.walls[0].lower = scene.settings.domain.lower;
  scene.walls[0].upper = scene.settings.domain.upper;
  SolverScene box(scene);
  EXPECT_EQ(box.zones().size(), 4u) << "the two faces across x are left out";
  EXPECT_EQ(box.dropped_zones().size(), 2u);
}

// Momentum of a gas in a box without walls, friction on: 1e-13 sqrt(steps) of the sum of m |v|.
/// What is said of a plate on y = z = 0.2 to 0.8 of a cell of 1 m, periodic along x; a ball of 5 cm reaches 5.4 cm.
std::vector<std::string> seam_gaps_of(double from, double to, const WallMotion& motion) {
  Scene scene = test::empty_scene(1e5, 0.5, 0, 0.002);
  make_periodic(scene, {0, 0, 0}, {1, 1, 1}, {true, false, false});
  scene.settings.duration = 2;
  scene.shapes = {make_sphere("ball", 0.05),
                  make_surface("plate", {{{from, 0.2, 0.2}, {to, 0.2, 0.2}, {to, 0.8, 0.2}, {from, 0.8, 0.2}}, {{0, 1, 2}, {0, 2, 3}}})};
  test::add_body(scene, 0, {0.5, 0.5, 0.5});
  Wall plate;
  plate.id = 1;
  plate.name = "plate";
  plate.kind = WallKind::mesh;
  plate.shape = 1;
  plate.motion = motion;
  scene.walls = {plate};
  return SolverScene(scene).seam_gaps();
}

TEST(PeriodicAxes, take_a_mesh_wall_that_is_met_everywhere_and_refuse_or_name_others) {
  const WallMotion still;
  EXPECT_TRUE(seam_gaps_of(0.1, 0.9, still).empty());     // inside, out of reach of the seam
  EXPECT_TRUE(seam_gaps_of(-0.06, 1.06, still).empty());  // beyond both ends by the reach
  for (const auto& [from, to] : {std::pair{0.0, 1.0}, {0.02, 0.9}, {-0.03, 1.06}}) {
    const std::vector<std::string> gaps = seam_gaps_of(from, to, still);
    ASSERT_EQ(gaps.size(), 1u) << from;
    for (const char* word : {"'plate'", "periodic axis x", "0.054 m"}) EXPECT_NE(gaps[0].find(word), std::string::npos) << gaps[0];
  }
  const auto refusal = [](double from, double to, const WallMotion& motion) -> std::string {
    try {
      seam_gaps_of(from, to, motion);
    } catch (const UsageError& e) {
      return e.what();
    }
    return "";
  };
  EXPECT_NE(refusal(0.5, 1.2, still).find("'plate'"), std::string::npos) << "beyond one end only";
  WallMotion slides;
  slides.kind = Translate{.axis = {1, 0, 0}, .rate = 0.2};
  const std::string lost = refusal(-0.06, 1.06, slides);
  for (const char* word : {"'plate'", "periodic axis x", "-0.06 to 1.46 m"}) EXPECT_NE(lost.find(word), std::string::npos) << lost;
  EXPECT_EQ(refusal(-0.5, 1.06, slides), "") << "a belt that is long enough";
  EXPECT_EQ(refusal(0.1, 0.5, slides), "") << "a slider that stays inside";
  slides.stop = -1;
  EXPECT_EQ(refusal(-0.06, 1.06, slides), "");
  slides.stop = 1e300;
  slides.kind = Translate{.axis = {0, 1, 0}, .rate = 0.2};
  EXPECT_EQ(refusal(-0.06, 1.06, slides), "") << "across the axis";
  WallMotion turns;
  turns.kind = Rotate{.axis = {1, 0, 0}, .centre = {0.5, 0.5, 0.5}, .rate = 3};
  EXPECT_EQ(refusal(-0.06, 1.06, turns), "") << "about the axis";
  turns.kind = Rotate{.axis = {0, 0, 1}, .centre = {0.5, 0.5, 0.5}, .rate = 3};
  EXPECT_NE(refusal(-0.06, 1.06, turns), "");
  EXPECT_EQ(refusal(0.4, 0.6, turns), "") << "a stirrer inside";
  WallMotion shakes;
  shakes.kind = Oscillate{.axis = {1, 0, 0}, .amplitude = 0.05, .frequency = 1};
  EXPECT_NE(refusal(-0.06, 1.06, shakes), "");
  EXPECT_EQ(refusal(-0.11, 1.11, shakes), "");
}

TEST(PeriodicAxes, keep_the_momentum_of_many_bodies) {
  TestRun run(test::empty_scene(1e6, 0.8, 0.3, 0.001));
  make_periodic(run.scene, {0, 0, 0}, {0.3, 0.3, 0.3}, {true, true, true});
  run.scene.shapes = {make_solid("rock", test::scaled(test::rock(5, 1), 0.027))};
  for (int i = 0; i < 64; ++i) {
    const Vec3 place{0.0375 + 0.075 * (i % 4), 0.0375 + 0.075 * (i / 4 % 4), 0.0375 + 0.075 * (i / 16)};
    test::add_body(run.scene, 0, place, quaternion_of(normalised(Vec3{1, 1.0 * i, 2}), i),
                   {std::sin(3.0 * i), std::sin(5.0 * i + 1), std::sin(7.0 * i + 2)}, {5.0 * std::sin(i), 0, 9});
  }
  run.start();
  const Vec3 before = run.momentum();
  std::int64_t touched = 0;
  constexpr int kSteps = 6000;
  for (int n = 0; n < kSteps; ++n) {
    run.simulation->advance();
    if (n % 50 == 0) touched += contact_count(run.simulation->state());
  }
  EXPECT_GT(touched, 100);
  EXPECT_EQ(body_count(run.simulation->state()), 64);
  const double scale = 64 * 1000 * 4.19 * 2e-5;  // about the sum of m |v|
  EXPECT_LE(length(run.momentum() - before), 1e-13 * std::sqrt(kSteps) * scale);
}

TestRun leaving_rocks(Outside outside) {
  TestRun run(test::empty_scene(1e6, 0.5, 0.3, 0.002));
  make_periodic(run.scene, {-1, -1, -1}, {1, 1, 1}, {false, false, false});
  run.scene.settings.domain.outside = outside;
  run.scene.settings.gravity = {0, 0, -9.81};
  run.scene.shapes = {make_solid("rock", test::scaled(test::rock(4, 1), 0.05))};
  for (int i = 0; i < 6; ++i) test::add_body(run.scene, 0, {-0.5 + 0.2 * i, 0.1 * i, 0.9 - 0.3 * i}, {}, {0.1 * i, 0, -1}, {3, 1.0 * i, 0});
  return run;
}

TEST(Domain, removes_what_leaves_it_and_tells_what_that_was) {
  TestRun run = leaving_rocks(Outside::remove);
  run.start();
  const Energies start = energies_of(run.simulation->state());
  std::vector<RemovedBody> all;
  const double dt = run.simulation->state().clock.size.step;
  while (run.simulation->time() < 0.6) {
    run.simulation->advance();
    if (run.simulation->step() % 100 == 0) {
      for (const RemovedBody& b : run.simulation->domain().take_removed(run.simulation->state().comm)) all.push_back(b);
    }
  }
  for (const RemovedBody& b : run.simulation->domain().take_removed(run.simulation->state().comm)) all.push_back(b);
  const RemovedTotals totals = removed_totals(run.simulation->state());
  EXPECT_EQ(body_count(run.simulation->state()) + static_cast<std::int64_t>(totals.count), 6);
  EXPECT_GE(totals.count, 3);
  EXPECT_NEAR(energies_of(run.simulation->state()).balance(), start.balance(), 1e-10 * std::abs(start.translational + start.potential));
  if (test::g_comm->rank() != 0) return;
  ASSERT_EQ(static_cast<double>(all.size()), totals.count);
  double mass = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    mass += all[i].mass;
    const bool in_order = i == 0 || all[i - 1].step < all[i].step || (all[i - 1].step == all[i].step && all[i - 1].id < all[i].id);
    EXPECT_TRUE(in_order);
    // free fall from 0.9 - 0.3 id at 1 m/s: below -1 for at most 16 steps
    const double fallen = 1.9 - 0.3 * static_cast<double>(all[i].id);
    const double t = (-1 + std::sqrt(1 + 2 * 9.81 * fallen)) / 9.81;
    EXPECT_GE(all[i].time, t - dt);
    EXPECT_LE(all[i].time, t + 17 * dt);
    EXPECT_LT(all[i].x.z, -1);
  }
  EXPECT_DOUBLE_EQ(mass, totals.mass);
}

// Bodies leave between the two kicks of a step, in the middle of an impact: what they take with them is that of one moment, to second order
// in the step.
TEST(Domain, a_body_takes_along_what_its_contact_stores_at_that_moment) {
  constexpr double kStiffness = 1e6, kOverlap = 1e-3;
  TestRun run(test::empty_scene(kStiffness, 1, 0, 0.002));
  make_periodic(run.scene, {-1, -1, -1}, {1, 1, 1}, {false, false, false});
  run.scene.settings.domain.outside = Outside::remove;
  run.scene.settings.steps_per_contact = 400;
  run.scene.shapes = {make_sphere("ball", 0.05)};
  const double apart = 2 * (0.05 + 0.002) - kOverlap, out = 1 - 1e-7;
  test::add_body(run.scene, 0, {out, 0, 0}, {}, {0.1, 0, 0}, {});
  test::add_body(run.scene, 0, {out - apart, 0, 0}, {}, {}, {});
  run.start();
  const double start = energies_of(run.simulation->state()).balance();
  while (removed_totals(run.simulation->state()).count == 0) {
    ASSERT_LT(run.simulation->step(), 200);
    run.simulation->advance();
  }
  EXPECT_NEAR(energies_of(run.simulation->state()).balance(), start, 5e-5 * 0.5 * kStiffness * kOverlap * kOverlap);
}

TEST(Domain, stops_the_run_or_lets_bodies_go_as_asked) {
  TestRun stop = leaving_rocks(Outside::stop);
  stop.start();
  try {
    for (int n = 0; n < 100000; ++n) stop.simulation->advance();
    FAIL() << "nothing stopped the run";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ExitCode::run_invalid);
    EXPECT_NE(std::string(e.what()).find("body 5 left the domain"), std::string::npos) << e.what();
  }
  TestRun keep = leaving_rocks(Outside::keep);
  keep.start();
  while (keep.simulation->time() < 0.5) keep.simulation->advance();
  EXPECT_EQ(body_count(keep.simulation->state()), 6);
  EXPECT_GE(bodies_outside(keep.simulation->state()), 3);
}

// Of pairs that hold together, at rest with respect to each other, of which one body leaves before the other.
TEST(Domain, takes_the_energy_of_contacts_with_the_bodies_that_leave_it) {
  constexpr double kRadius = 0.01, kPull = 1, kStiffness = 1e4;
  TestRun run(test::empty_scene(kStiffness, 1, 0, 0));
  make_periodic(run.scene, {-0.5, -0.5, -0.5}, {0.1, 0.5, 0.5}, {false, false, false});
  run.scene.settings.domain.outside = Outside::remove;
  run.scene.pairs[0].pull_off = kPull;
  run.scene.pairs[0].adhesion_range = 1e-3;
  run.scene.shapes = {make_sphere("ball", kRadius)};
  for (int pair = 0; pair < 8; ++pair) {
    const double x = 0.05 - 0.02 * pair, y = -0.4 + 0.1 * pair;
    test::add_body(run.scene, 0, {x, y, 0}, {}, {0.15, 0, 0});
    test::add_body(run.scene, 0, {x + 2 * kRadius - kPull / kStiffness, y, 0}, {}, {0.15, 0, 0});
  }
  run.start();
  const Energies start = energies_of(run.simulation->state());
  const double motion = start.translational + start.rotational;
  EXPECT_LT(start.elastic, -0.1 * motion);
  while (run.simulation->time() < 1.5) {
    run.simulation->advance();
    if (run.simulation->step() % 50 != 0) continue;
    ASSERT_NEAR(energies_of(run.simulation->state()).balance(), start.balance(), 1e-9 * motion) << run.simulation->step();
  }
  EXPECT_EQ(removed_totals(run.simulation->state()).count, 16);
  EXPECT_NEAR(energies_of(run.simulation->state()).removed, start.balance(), 1e-9 * motion);
}

// X28: nothing, and a single body.
TEST(Domain, may_hold_no_body_or_one) {
  for (int bodies = 0; bodies < 2; ++bodies) {
    TestRun run(test::empty_scene(1e6, 0.5, 0.3, 0.002));
    run.scene.settings.gravity = {0, 0, -10};
    run.scene.shapes = {make_solid("rock", test::scaled(test::rock(4, 1), 0.05))};
    if (bodies > 0) test::add_body(run.scene, 0, {0, 0, 0});
    run.start();
    for (int n = 0; n < 100; ++n) run.simulation->advance();
    EXPECT_EQ(body_count(run.simulation->state()), bodies);
    const double t = run.simulation->time();
    EXPECT_NEAR(run.position(0).z, -bodies * 5 * t * t, 1e-12 * t * t);
  }
}

}  // namespace
}  // namespace scree
