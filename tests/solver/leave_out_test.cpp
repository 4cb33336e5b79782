// docs/reference/validation-plan.md section 1.9, L1 to L7: what a scene does not need is not there. Its instructions:
// tests/benchmarks/leave_out.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "solver/contact/chosen_law.hpp"
#include "tests/support/parallel_scenes.hpp"
#include "tests/support/test_run.hpp"

namespace scree {
namespace {

using test::TestRun;

std::size_t springs_of(const Simulation& simulation, bool with_room) {
  std::size_t springs = 0;
  for (const BodyPair& pair : simulation.state().pairs.pairs()) {
    const auto is_spring = [](const FrictionSpring& s) { return s.key != Turn::kKey; };
    springs += with_room ? pair.state.springs.capacity()
                         : static_cast<std::size_t>(std::count_if(pair.state.springs.begin(), pair.state.springs.end(), is_spring));
  }
  return springs;
}

TEST(LeaveOut, a_scene_without_friction_keeps_no_history_not_even_room_for_it) {
  TestRun with(test::dense_heap(3, 2, 2)), without(test::dense_heap(3, 2, 2));
  without.scene.pairs[0].friction = 0;
  for (TestRun* run : {&with, &without}) {
    run->start();
    std::int64_t contacts = 0;
    std::size_t springs = 0;
    for (int n = 0; n < 900; ++n) {
      run->simulation->advance();
      contacts += contact_count(run->simulation->state());
      springs += springs_of(*run->simulation, run == &without);
    }
    EXPECT_GT(contacts, 500);
    if (run == &with) {
      EXPECT_EQ(springs, static_cast<std::size_t>(contacts));
    } else {
      EXPECT_EQ(springs, 0u);
    }
  }
  // another function altogether, in which friction does not occur
  EXPECT_NE(pair_force_function(with.prepared->law_choice()), pair_force_function(without.prepared->law_choice()));
}

/// A cube a gap above a face that may be finely meshed.
TestRun cube_above(int mesh, double gap, double friction) {
  TestRun run(test::empty_scene(1e4, 0.5, friction, 0.01, 1));
  run.scene.settings.step = 1e-5;
  run.scene.shapes = {make_solid("cube", test::grid_box(mesh, {1, 1, 1})), make_solid("base", test::grid_box(mesh, {2, 2, 1}))};
  test::add_body(run.scene, 0, {0.05, 0.03, 1 + gap});
  test::add_body(run.scene, 1, {0, 0, 0});
  run.scene.bodies.fixed[1] = 1;
  return run;
}

TEST(LeaveOut, without_cohesion_a_contact_begins_where_the_margins_meet) {
  constexpr double kRounding = 1e-13;  // of the positions: 1 m
  TestRun near = cube_above(3, 0.02 - kRounding, 0), far = cube_above(3, 0.02 + kRounding, 0);
  near.start();
  far.start();
  EXPECT_EQ(contact_count(near.simulation->state()), 4);
  EXPECT_EQ(contact_count(far.simulation->state()), 0);
  EXPECT_EQ(energies_of(far.simulation->state()).elastic, 0);
}

TEST(LeaveOut, history_is_kept_by_contact_and_not_by_pair_of_triangles) {
  static_assert(sizeof(FrictionSpring) == 64,
                "a key, a force, a stiffness, a normal; tests/benchmarks/leave_out/README.md names the bytes");
  for (const int mesh : {1, 8}) {
    TestRun run = cube_above(mesh, 0.018, 0.5);
    run.start();
    run.simulation->advance();
    EXPECT_EQ(contact_count(run.simulation->state()), 4) << mesh;
    EXPECT_EQ(springs_of(*run.simulation, false), 4u) << mesh;
  }
}

TEST(LeaveOut, fixed_bodies_are_not_moved_and_make_no_pairs_among_themselves) {
  TestRun run(test::empty_scene(1e4, 0.5, 0.5, 0.01, 1));
  run.scene.settings.gravity = {0, 0, -9.81};
  run.scene.shapes = {make_solid("cube", test::grid_box(1, {1, 1, 1}))};
  for (int i = 0; i < 4; ++i) {
    test::add_body(run.scene, 0, {1.005 * i, 0, 0}, quaternion_of({0, 0, 1}, 1e-3), {1, 2, 3},
                   {3, 2, 1});  // within their margins; speeds are not theirs
    run.scene.bodies.fixed.back() = 1;
  }
  test::add_body(run.scene, 0, {1.5, 0, 1.03});
  run.start();
  const ParticleSet before = run.simulation->state().particles;
  for (int n = 0; n < 2000; ++n) run.simulation->advance();
  const ParticleSet& after = run.simulation->state().particles;
  std::size_t with_the_falling_one = 0;
  for (const BodyPair& pair : run.simulation->state().pairs.pairs()) {
    EXPECT_FALSE(after.fixed[static_cast<std::size_t>(pair.a)] && after.fixed[static_cast<std::size_t>(pair.b)]);
    ++with_the_falling_one;
  }
  EXPECT_GE(with_the_falling_one, 2u);
  for (std::size_t i = 0; i < after.size(); ++i) {
    if (!after.fixed[i]) continue;
    EXPECT_TRUE(after.x[i] == before.x[i] && after.q[i] == before.q[i]) << after.id[i];
  }
  EXPECT_GT(contact_count(run.simulation->state()), 0);
}

}  // namespace
}  // namespace scree
