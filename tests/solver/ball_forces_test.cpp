// Pairs of balls side by side in lanes against the general path, which runs where impacts are recorded: the same bits, of bodies, springs
// and what each pair did, on every instruction set.
#include <gtest/gtest.h>

#include "core/distance/triangle_distance.hpp"
#include "solver/pairs/ball_evaluation.hpp"
#include "tests/solver/falling_balls.hpp"
#include "tests/solver/lane_bits.hpp"
#include "tests/support/parallel_scenes.hpp"

namespace scree {
namespace {

using namespace test;

/// The same, of a scene whose balls go in lanes.
std::string expect_same_bits_of_balls(const Scene& scene, int steps) {
  EXPECT_NE(SolverScene(scene).ball_laws().kind, LaneLawKind::none);
  return expect_same_bits(scene, steps);
}

class EveryBallLaw : public testing::TestWithParam<ContactLaw> {};

TEST_P(EveryBallLaw, has_the_bits_of_the_general_path) {
  for (const double friction : {0.0, 0.5}) {
    for (const bool periodic : {false, true}) {
      SCOPED_TRACE(fmt::format("friction {}, periodic {}", friction, periodic));
      expect_same_bits_of_balls(falling_balls(GetParam(), friction, periodic), 1200);
    }
  }
}

TEST_P(EveryBallLaw, has_the_same_bits_on_every_instruction_set) {
  const Scene scene = falling_balls(GetParam(), 0.5, false);
  std::vector<std::string> hashes;
  for (const char* name : {"best", "avx512", "avx2", "sse4", "scalar"}) {
    try {
      limit_simd(name);
    } catch (const UsageError&) {
      continue;
    }
    hashes.push_back(expect_same_bits_of_balls(scene, 800));
  }
  limit_simd("best");
  for (const std::string& hash : hashes) EXPECT_EQ(hash, hashes[0]);
}

INSTANTIATE_TEST_SUITE_P(BallForces, EveryBallLaw,
                         testing::Values(ContactLaw::linear, ContactLaw::hunt_crossley, ContactLaw::hertz_mindlin));

// Faster impacts than the step was made for limit damping, which lanes leave to the general path.
TEST(BallForces, have_the_same_bits_where_damping_is_limited) {
  for (const ContactLaw law : {ContactLaw::hunt_crossley, ContactLaw::hertz_mindlin}) {
    Scene scene = falling_balls(law, 0.5, false);
    scene.settings.impact_speed = law == ContactLaw::hertz_mindlin ? 0.01 : 0.02;
    for (MaterialPair& pair : scene.pairs) {
      pair.restitution = 0.1;
      pair.restitution_speed = 0.02;
    }
    expect_same_bits_of_balls(scene, 800);
  }
}

TEST(BallForces, have_the_same_bits_with_rolling_and_torsional_resistance) {
  for (const ContactLaw law : {ContactLaw::linear, ContactLaw::hunt_crossley, ContactLaw::hertz_mindlin}) {
    Scene scene = falling_balls(law, 0.5, false);
    for (MaterialPair& pair : scene.pairs) {
      pair.rolling_friction = 0.05;
      pair.torsional_friction = 0.02;
    }
    const SolverScene prepared(scene);
    for (const std::uint8_t holds : prepared.ball_laws().holds) EXPECT_NE(holds, 0);
    expect_same_bits_of_balls(scene, 1200);
  }
}

// A drum that turns about an axis beside its origin, and a lid that comes down.
TEST(BallForces, have_the_same_bits_at_walls_that_move) {
  for (const ContactLaw law : {ContactLaw::linear, ContactLaw::hertz_mindlin}) {
    Scene scene = falling_balls(law, 0.5, false);
    scene.walls.clear();
    Wall& drum = add_wall(scene, WallKind::cylinder_inside);
    drum.axis_start = {0.09, 0, 0.09};
    drum.axis_end = {0.09, 0.2, 0.09};
    drum.radius = 0.15;
    drum.motion.kind = Rotate{.axis = {0, 1, 0}, .centre = {0.09, 0, 0.09}, .rate = 5};
    drum.motion.stop = 1e300;
    add_plane(scene, {0, 0, 0.16}, {0, 0, -1});
    scene.walls.back().motion.kind = Translate{.axis = {0, 0.6, -0.8}, .rate = 0.3};
    scene.walls.back().motion.stop = 1e300;
    expect_same_bits_of_balls(scene, 3000);
  }
}

TEST(BallForces, leave_to_the_general_path_what_lanes_have_no_formula_for) {
  Scene scene = falling_balls(ContactLaw::linear, 0.5, false);
  EXPECT_NE(SolverScene(scene).ball_laws().kind, LaneLawKind::none);
  scene.pairs[0].rolling_friction = 0.1;
  const SolverScene rolling(scene);
  EXPECT_NE(rolling.ball_laws().holds[rolling.ball_laws().row(0, 0)], 0);
  EXPECT_EQ(rolling.ball_laws().holds[rolling.ball_laws().row(0, 1)], 0) << "some roll, others do not";
  expect_same_bits_of_balls(scene, 1200);
  scene = falling_balls(ContactLaw::linear, 0.5, false);
  scene.settings.gather = Gathering::pairs;
  EXPECT_EQ(SolverScene(scene).ball_laws().kind, LaneLawKind::none);
  EXPECT_EQ(SolverScene(necked_heap()).ball_laws().kind, LaneLawKind::none);
  EXPECT_EQ(SolverScene(dense_heap()).ball_laws().kind, LaneLawKind::none) << "there are no balls";
}

/// What pairs in blocks were seen in.
struct Seen {
  std::size_t filled = 0, touching = 0, apart = 0;
};

void look_into(BallBlocks& blocks, Seen& seen) {
  if (!blocks.are_filled()) return;
  ++seen.filled;
  for (std::size_t n = 0; n < blocks.count(PairClass::inner); ++n) {
    const BallBlock& block = blocks.block(PairClass::inner, n);
    for (std::size_t k = 0; k < block.pairs.count; ++k) {
      seen.touching += block.index[k] >= 0 && block.touches[k] != 0 ? 1 : 0;
      seen.apart += block.index[k] >= 0 && block.touches[k] == 0 ? 1 : 0;
    }
  }
}

// A reader of the list of pairs has those in blocks written back, and the next step takes them again.
TEST(BallBlocks, may_be_written_back_after_any_step) {
  Scene scene = falling_balls(ContactLaw::hertz_mindlin, 0.5, true);
  for (MaterialPair& pair : scene.pairs) pair.rolling_friction = 0.05;
  std::vector<std::string> hashes;
  std::vector<std::unique_ptr<TestRun>> runs;
  for (const int every : {1, 3, 7, 100000}) {
    runs.push_back(std::make_unique<TestRun>(scene));
    runs.back()->start();
    Simulation& simulation = *runs.back()->simulation;
    Seen seen;
    for (int n = 1; n <= 1500; ++n) {
      simulation.advance();
      PairList& pairs = const_cast<PairList&>(simulation.state().pairs);
      look_into(pairs.blocks(), seen);
      if (n % every != 0) continue;
      pairs.write_back();
      EXPECT_FALSE(pairs.blocks().are_filled());
    }
    EXPECT_GT(seen.filled, 1400u) << "all steps but those in which no two bodies are near";
    EXPECT_GT(seen.touching, 1000u);
    if (every > 1) {
      EXPECT_GT(seen.apart, 100u) << "pairs that have parted stay in their block";
    }
    hashes.push_back(state_hash(simulation.state()));
    expect_same_bodies(runs[0]->simulation->state().particles, simulation.state().particles);
  }
  for (const std::string& hash : hashes) EXPECT_EQ(hash, hashes[0]);
}

TEST(BallBlocks, are_not_used_where_pairs_are_shown_or_bodies_sleep) {
  for (const bool sleeps : {false, true}) {
    Scene scene = falling_balls(ContactLaw::hertz_mindlin, 0.5, false);
    if (sleeps)
      scene.settings.sleep = true;
    else
      scene.settings.output_impacts = true;
    TestRun run(scene);
    run.start();
    for (int n = 0; n < 20; ++n) run.simulation->advance();
    EXPECT_FALSE(run.simulation->state().pairs.blocks().are_filled());
  }
}

}  // namespace
}  // namespace scree
