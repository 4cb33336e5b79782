// Steps of balls that go without a break, against single steps: the same bits of bodies, springs and totals, wherever the breaks are.
#include "solver/step/ball_steps.hpp"

#include <gtest/gtest.h>
#include <omp.h>

#include <random>

#include "core/distance/triangle_distance.hpp"
#include "solver/effects/outer_forces/outer_forces.hpp"
#include "tests/solver/falling_balls.hpp"
#include "tests/solver/lane_bits.hpp"

namespace scree {
namespace {

using namespace test;

enum class Way { single, at_once, by_chance };

/// What a run has become after so many steps.
struct End {
  std::unique_ptr<TestRun> run;
  std::string hash;
  double share = 0;  ///< of the steps that went without a break
};

End run_scene(const Scene& scene, std::int64_t steps, Way way, unsigned seed = 1) {
  End end{std::make_unique<TestRun>(scene), {}};
  end.run->start();
  Simulation& simulation = *end.run->simulation;
  std::mt19937 random(seed);
  while (simulation.step() < steps) {
    const std::int64_t now = simulation.step();
    std::int64_t last = way == Way::single ? now + 1 : steps;
    if (way == Way::by_chance) last = std::min<std::int64_t>(steps, now + std::uniform_int_distribution<std::int64_t>(1, 40)(random));
    simulation.advance(last);
    EXPECT_LE(simulation.step(), last);
    // whatever is read in between changes nothing
    if (way == Way::by_chance && random() % 4 == 0) {
      EXPECT_GT(simulation.state().pairs.pairs().size(), 0u);
    }
  }
  simulation.agree_on_failures();
  end.hash = state_hash(simulation.state());
  end.share = static_cast<double>(simulation.ball_steps().count()) / static_cast<double>(steps);
  return end;
}

void expect_same_ends(const End& a, const End& b) {
  const RunState &mine = a.run->simulation->state(), &other = b.run->simulation->state();
  EXPECT_EQ(a.hash, b.hash);
  expect_same_bodies(mine.particles, other.particles);
  for (std::size_t i = 0; i < mine.particles.size(); ++i) EXPECT_EQ(mine.particles.dissipated[i], other.particles.dissipated[i]) << i;
  EXPECT_EQ(mine.totals.max_overlap_ratio, other.totals.max_overlap_ratio);
  EXPECT_EQ(mine.totals.walls.work.value(), other.totals.walls.work.value());
  EXPECT_EQ(mine.totals.walls.dissipated.value(), other.totals.walls.dissipated.value());
  for (std::size_t w = 0; w < mine.totals.walls.impulse.size(); ++w) {
    for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(mine.totals.walls.impulse[w][k].value(), other.totals.walls.impulse[w][k].value()) << w;
  }
}

/// Steps at once, and with breaks by chance, against single steps.   in   least   share of the steps that go without a break
/// Returns the run at once.
End expect_the_bits_of_single_steps(const Scene& scene, std::int64_t steps, double least) {
  const End single = run_scene(scene, steps, Way::single), by_chance = run_scene(scene, steps, Way::by_chance);
  End at_once = run_scene(scene, steps, Way::at_once);
  EXPECT_EQ(single.share, 0);
  EXPECT_GT(at_once.share, least);
  expect_same_ends(single, at_once);
  expect_same_ends(single, by_chance);
  return at_once;
}

class BallStepsOfALaw : public testing::TestWithParam<ContactLaw> {};

TEST_P(BallStepsOfALaw, have_the_bits_of_single_steps) {
  for (const double friction : {0.0, 0.5}) {
    SCOPED_TRACE(fmt::format("friction {}", friction));
    const Scene scene = falling_balls(GetParam(), friction, false);
    const End single = run_scene(scene, 2000, Way::single), at_once = run_scene(scene, 2000, Way::at_once);
    EXPECT_EQ(single.share, 0);
    EXPECT_GT(at_once.share, 0.7);
    expect_same_ends(single, at_once);
    for (const unsigned seed : {1u, 2u, 3u}) {
      const End by_chance = run_scene(scene, 2000, Way::by_chance, seed);
      EXPECT_GT(by_chance.share, 0.4);
      expect_same_ends(single, by_chance);
    }
  }
}

// Bodies go through the sides of the cell many times: their images and the places where they were listed go with them.
TEST_P(BallStepsOfALaw, have_the_bits_of_single_steps_in_a_periodic_cell) {
  Scene scene = falling_balls(GetParam(), 0.5, true);
  for (Vec3& v : scene.bodies.velocity)
    if (!(v == Vec3{})) v += Vec3{3, -2, 0};
  const End at_once = expect_the_bits_of_single_steps(scene, 2000, 0.6);
  int gone = 0;
  for (const Vec3& image : at_once.run->simulation->state().particles.image) gone += image == Vec3{} ? 0 : 1;
  EXPECT_GT(gone, 50);
}

// A drum that turns about an axis beside its origin, a lid that comes down slanted, a floor that shakes from some time on, and an end that
// turns with the drum.
TEST_P(BallStepsOfALaw, have_the_bits_of_single_steps_beside_walls_that_move) {
  Scene scene = falling_balls(GetParam(), 0.5, false);
  for (MaterialPair& pair : scene.pairs) pair.rolling_friction = 0.05;
  scene.walls.clear();
  const auto move = [&scene](const auto& motion, double start = 0) {
    scene.walls.back().motion.kind = motion;
    scene.walls.back().motion.start = start;
    scene.walls.back().motion.stop = 1e300;
  };
  Wall& drum = add_wall(scene, WallKind::cylinder_inside);
  drum.axis_start = {0.09, 0, 0.09};
  drum.axis_end = {0.09, 0.2, 0.09};
  drum.radius = 0.15;
  move(Rotate{.axis = {0, 1, 0}, .centre = {0.09, 0, 0.09}, .rate = 5});
  add_plane(scene, {0, 0, 0.16}, {0, 0, -1});
  move(Translate{.axis = {0, 0.6, -0.8}, .rate = 0.3});
  add_plane(scene, {0, 0, 0}, {0, 0, 1});
  move(Oscillate{.axis = {0, 0, 1}, .amplitude = 0.002, .frequency = 60, .phase = 0.3}, 0.01);
  add_plane(scene, {0, -0.001, 0}, {0, 1, 0});
  move(Rotate{.axis = {0, 1, 0}, .centre = {0.09, 0, 0.09}, .rate = 5});
  add_plane(scene, {0, 0.19, 0}, {0, -1, 0});
  const End at_once = expect_the_bits_of_single_steps(scene, 3000, 0.7);
  EXPECT_NE(at_once.run->simulation->state().totals.walls.work.value(), 0);
}

TEST_P(BallStepsOfALaw, have_the_bits_of_single_steps_where_balls_roll) {
  Scene scene = falling_balls(GetParam(), 0.5, false);
  for (MaterialPair& pair : scene.pairs) {
    pair.rolling_friction = 0.05;
    pair.torsional_friction = 0.02;
  }
  const End single = run_scene(scene, 2000, Way::single), at_once = run_scene(scene, 2000, Way::at_once);
  EXPECT_GT(at_once.share, 0.7);
  expect_same_ends(single, at_once);
}

INSTANTIATE_TEST_SUITE_P(BallSteps, BallStepsOfALaw,
                         testing::Values(ContactLaw::linear, ContactLaw::hunt_crossley, ContactLaw::hertz_mindlin));

TEST(BallSteps, have_the_same_bits_on_every_instruction_set_and_any_threads) {
  const Scene scene = falling_balls(ContactLaw::hertz_mindlin, 0.5, false);
  const End single = run_scene(scene, 1000, Way::single);
  const auto expect_same = [&] {
    const End at_once = run_scene(scene, 1000, Way::at_once);
    EXPECT_GT(at_once.share, 0.7);
    expect_same_ends(single, at_once);
  };
  for (const char* name : {"best", "avx512", "avx2", "sse4", "scalar"}) {
    SCOPED_TRACE(name);
    try {
      limit_simd(name);
    } catch (const UsageError&) {
      continue;
    }
    expect_same();
  }
  limit_simd("best");
  const int threads = omp_get_max_threads();
  for (const int count : {2, 3}) {
    SCOPED_TRACE(fmt::format("{} threads", count));
    omp_set_num_threads(count);
    expect_same();
  }
  omp_set_num_threads(threads);
}

// Faster impacts than the step was made for limit damping, which lanes leave to the general path: it breaks the steps.
TEST(BallSteps, end_where_a_pair_needs_the_general_path) {
  Scene scene = falling_balls(ContactLaw::hunt_crossley, 0.5, false);
  scene.settings.impact_speed = 0.02;
  for (MaterialPair& pair : scene.pairs) {
    pair.restitution = 0.1;
    pair.restitution_speed = 0.02;
  }
  const End single = run_scene(scene, 1500, Way::single), at_once = run_scene(scene, 1500, Way::at_once);
  EXPECT_GT(at_once.share, 0);
  EXPECT_LT(at_once.share, 0.9);
  expect_same_ends(single, at_once);
}

// A first touch that lanes have no formula for is computed once in its step, and goes into a block with the next.
TEST(BallSteps, have_the_bits_of_single_steps_where_a_first_touch_needs_the_general_path) {
  Scene scene = empty_scene(0, 0.01, 0.5, 0);
  scene.settings.gravity = {0, 0, -9.81};
  scene.settings.law = ContactLaw::hunt_crossley;
  scene.settings.step = 2e-5;
  scene.materials = {{"glass", 2500, 1e6, 0.3}};
  scene.pairs[0].restitution_speed = 0.01;
  scene.pairs[0].stiffness = 2e3;
  scene.shapes = {make_sphere("ball", 0.01)};
  add_plane(scene, {0, 0, 0}, {0, 0, 1});
  fill_lattice(scene, 5, 3, 1, {0, 0, 0.0105}, 0.03, {1, 0.5, -4});
  for (Vec3& w : scene.bodies.angular_velocity) w = {20, -30, 10};
  const int threads = omp_get_max_threads();
  for (const int count : {1, 3}) {
    omp_set_num_threads(count);
    const End single = run_scene(scene, 200, Way::single), at_once = run_scene(scene, 200, Way::at_once);
    EXPECT_GT(at_once.share, 0.3);
    expect_same_ends(single, at_once);
  }
  omp_set_num_threads(threads);
}

TEST(BallSteps, have_the_bits_of_single_steps_for_any_number_of_balls_and_in_a_cylinder) {
  const int threads = omp_get_max_threads();
  for (const int count : {1, 7, 8, 9, 17}) {
    SCOPED_TRACE(count);
    omp_set_num_threads(count == 7 ? 2 : 1);  // more than there are groups of eight
    Scene scene = falling_balls(ContactLaw::hertz_mindlin, 0.5, false);
    scene.bodies = {};
    scene.walls.clear();
    fill_lattice(scene, 1, count, 1, {0, 0.05, 0.05}, 0.0355, {0.3, 0.2, -1});
    Wall& drum = add_wall(scene, WallKind::cylinder_inside);
    drum.axis_start = {0.05, 0, 0.1};
    drum.axis_end = {0.05, 2, 0.1};
    drum.radius = 0.12;
    const End single = run_scene(scene, 800, Way::single), at_once = run_scene(scene, 800, Way::at_once);
    EXPECT_GT(at_once.share, 0.5);
    expect_same_ends(single, at_once);
  }
  omp_set_num_threads(threads);
}

// Walls do not meet each other, so that no law is given for their material alone: steps were single ones in every such scene.
TEST(BallSteps, have_the_bits_of_single_steps_where_walls_are_of_another_material) {
  for (const double friction : {0.0, 0.5}) {
    Scene scene = falling_balls(ContactLaw::hunt_crossley, friction, false);
    scene.materials.push_back({"steel", 7800, 1e6, 0.3});
    scene.materials.push_back({"unused", 1000, 1e6, 0.3});
    for (const std::int32_t ball : {0, 1}) {
      MaterialPair pair = scene.pairs[0];
      pair.a = ball;
      pair.b = 2;
      pair.restitution = 0.6;
      scene.pairs.push_back(pair);
    }
    for (Wall& wall : scene.walls) wall.material = 2;
    const End single = run_scene(scene, 1500, Way::single), at_once = run_scene(scene, 1500, Way::at_once);
    EXPECT_EQ(single.share, 0);
    EXPECT_GT(at_once.share, 0.7);
    expect_same_ends(single, at_once);
  }
}

// Bodies that leave do so in the step in which they would have left.
TEST(BallSteps, end_where_bodies_are_reviewed) {
  Scene scene = falling_balls(ContactLaw::hertz_mindlin, 0.5, false);
  scene.settings.domain.bounded = true;
  scene.settings.domain.lower = {-1, -1, -1};
  scene.settings.domain.upper = {1, 1, 0.12};
  scene.settings.domain.outside = Outside::remove;
  const End single = run_scene(scene, 1500, Way::single), at_once = run_scene(scene, 1500, Way::at_once);
  EXPECT_LT(single.run->simulation->state().particles.size(), scene.bodies.size()) << "some leave";
  EXPECT_GT(at_once.share, 0.5);
  expect_same_ends(single, at_once);
}

// Bodies at rest say nothing of when a wall comes: its own way does, and that of what turns by as far as bodies are from its axis.
TEST(BallSteps, see_walls_come_to_bodies_at_rest) {
  for (const bool turns : {false, true}) {
    SCOPED_TRACE(turns);
    Scene scene = falling_balls(ContactLaw::hertz_mindlin, 0.5, false);
    scene.settings.gravity = {};
    for (Vec3& v : scene.bodies.velocity) v = {};
    scene.walls.clear();
    add_plane(scene, {-0.02, 0, 0}, {1, 0, 0});
    if (turns)
      scene.walls.back().motion.kind = Rotate{.axis = {0, 1, 0}, .centre = {-0.02, 0, -1}, .rate = 0.3};
    else
      scene.walls.back().motion.kind = Translate{.axis = {1, 0, 0}, .rate = 0.4};
    scene.walls.back().motion.stop = 1e300;
    const End single = run_scene(scene, 4000, Way::single), at_once = run_scene(scene, 4000, Way::at_once);
    EXPECT_GT(at_once.share, 0.7);
    EXPECT_NE(single.run->simulation->state().totals.walls.work.value(), 0);
    expect_same_ends(single, at_once);
  }
}

TEST(BallSteps, are_not_taken_where_something_else_happens_in_a_step) {
  const auto share_of = [](const std::function<void(Scene&)>& change) {
    Scene scene = falling_balls(ContactLaw::hertz_mindlin, 0.5, false);
    change(scene);
    return run_scene(scene, 200, Way::at_once).share;
  };
  EXPECT_GT(share_of([](Scene&) {}), 0.7);
  EXPECT_EQ(share_of([](Scene& s) { s.settings.output_impacts = true; }), 0);
  EXPECT_EQ(share_of([](Scene& s) { s.settings.sleep = true; }), 0);
  EXPECT_EQ(share_of([](Scene& s) { s.settings.step_control = StepControl::quantised; }), 0);
  EXPECT_EQ(share_of([](Scene& s) { s.settings.integrator = Integrator::euler; }), 0);
  EXPECT_EQ(share_of([](Scene& s) { s.settings.on_overlap = OnOverlap::proceed; }), 0);
  EXPECT_EQ(share_of([](Scene& s) {
              s.walls.back().surface.motion.kind = Translate{.axis = {0, 0, 1}, .rate = 0.01};
              s.walls.back().surface.motion.stop = 1e300;
            }),
            0);
}

// A run that a program steps has the effect of outer forces, whether it holds any or not.
TEST(BallSteps, go_on_beside_a_program_that_holds_no_force) {
  const Scene scene = falling_balls(ContactLaw::hertz_mindlin, 0.5, false);
  std::vector<std::string> hashes;
  for (const std::int64_t at_once : {1, 60}) {
    TestRun run(scene);
    run.start();
    Simulation& simulation = *run.simulation;
    OuterForces& forces = simulation.outer_forces();
    const auto go = [&](std::int64_t until) {
      const std::int64_t before = simulation.ball_steps().count();
      while (simulation.step() < until) simulation.advance(std::min(until, simulation.step() + at_once));
      return simulation.ball_steps().count() - before;
    };
    const std::int64_t first = go(600);
    forces.hold(simulation.changeable_state(), {{scene.bodies.id[0], {{0.05, 0, 0}, {}}}});
    EXPECT_EQ(go(900), 0);
    forces.release(simulation.changeable_state(), {});
    const std::int64_t last = go(1500);
    if (at_once > 1) {
      EXPECT_GT(first, 300);
      EXPECT_GT(last, 300);
    }
    hashes.push_back(state_hash(simulation.state()));
  }
  EXPECT_EQ(hashes[0], hashes[1]);
}

// The error names the step and the pair that single steps name: of contacts too deep, and of bodies too fast.
TEST(BallSteps, end_with_the_error_of_single_steps) {
  for (const bool is_soft : {true, false}) {
    Scene scene = falling_balls(is_soft ? ContactLaw::linear : ContactLaw::hertz_mindlin, 0.5, false);
    scene.settings.gravity = {0, 0, is_soft ? -10 : -4e6};
    if (is_soft) {
      scene.settings.step = 1e-4;
      scene.settings.surface = TouchAt::drawn;
      for (MaterialPair& pair : scene.pairs) {
        pair.stiffness = 2;
        pair.modulus = 0;
      }
    }
    TestRun single(scene), at_once(scene);
    const auto error_of = [](TestRun& run, bool is_single) -> std::string {
      try {
        run.start();
        while (run.simulation->step() < 4000) run.simulation->advance(is_single ? run.simulation->step() + 1 : 4000);
      } catch (const Error& error) {
        return error.what();
      }
      return {};
    };
    const std::string error = error_of(single, true);
    EXPECT_NE(error.find(is_soft ? "touch to" : "moves"), std::string::npos) << "error: " << error;
    EXPECT_EQ(error_of(at_once, false), error);
    // the last state is kept, to be looked at
    EXPECT_EQ(single.simulation->step(), at_once.simulation->step());
    if (is_soft) {
      EXPECT_GT(at_once.simulation->ball_steps().count(), 0);
    }
    expect_same_bodies(single.simulation->state().particles, at_once.simulation->state().particles);
  }
}

}  // namespace
}  // namespace scree
