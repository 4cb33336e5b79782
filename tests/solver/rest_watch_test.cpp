// When a run that ends at rest may end. A ball of 1 cm falls its diameter in 45 ms.
#include <gtest/gtest.h>

#include "solver/run/rest_watch.hpp"
#include "tests/support/scenes.hpp"

namespace scree {
namespace {

Scene balls_at_rest(int count) {
  Scene scene = test::empty_scene(1e5, 0.5, 0.5, 0, 2500);
  scene.settings.gravity = {0, 0, -9.81};
  scene.settings.stop_at_rest = true;
  scene.settings.duration = 10;
  scene.shapes = {make_sphere("ball", 0.005)};
  for (int i = 0; i < count; ++i) test::add_body(scene, 0, {0.02 * i, 0, 0.005});
  test::add_plane(scene, {}, {0, 0, 1});
  return scene;
}

/// Whether balls that never move count as resting at a time.
bool rests_at(const Scene& scene, double time) {
  RestWatch watch(scene);
  watch.add(0, 0);
  watch.add(time, 0);
  return watch.at_rest(time);
}

TEST(Rest, is_not_told_while_a_wall_moves_or_will_move) {
  Scene scene = balls_at_rest(3);
  EXPECT_TRUE(rests_at(scene, 0.1));
  WallMotion& m = scene.walls[0].motion;
  m.kind = Translate{.rate = 0.1};  // a gate that opens at 2 s
  m.start = 2;
  m.stop = 3;
  for (const double time : {0.1, 1.9, 2.5, 2.99, 3.01}) EXPECT_FALSE(rests_at(scene, time)) << time;
  EXPECT_TRUE(rests_at(scene, 3.1));
  m.start = 0;  // a plate that rises slowly, and indefinitely
  m.stop = 1e300;
  m.kind = Translate{.rate = 1e-5};
  EXPECT_FALSE(rests_at(scene, 5));
  m.kind = Translate{.rate = 0};
  EXPECT_TRUE(rests_at(scene, 5)) << "a motion that moves nothing";
  m.kind = Oscillate{.amplitude = 1e-6, .frequency = 1};
  EXPECT_FALSE(rests_at(scene, 5));
  // the last two places are the same
  m.kind = FollowTable{.time = {0, 1, 2, 3}, .position = {{}, {}, {0, 0, 1}, {0, 0, 1}}};
  m.start = 1;
  EXPECT_FALSE(rests_at(scene, 0.5));
  EXPECT_FALSE(rests_at(scene, 2.9));
  EXPECT_TRUE(rests_at(scene, 3.1));
}

TEST(Rest, of_balls_that_weigh_nothing_in_their_fluid_is_measured_by_a_fall_in_a_void) {
  Scene scene = balls_at_rest(2);
  scene.settings.fluid = Fluid{2500, 1e-3, {}, Drag::haider_levenspiel};
  const double fall = 2 * scene.mass(0) * 9.81 * 0.01;
  RestWatch moving(scene), still(scene);
  for (int row = 0; row <= 10; ++row) {
    moving.add(0.1 * row, 1e-3 * fall);
    still.add(0.1 * row, 1e-7 * fall);
  }
  EXPECT_FALSE(moving.at_rest(1));
  EXPECT_TRUE(still.at_rest(1));
}

TEST(Rest, is_not_told_of_a_ball_that_falls_among_many_that_lie) {
  const Scene scene = balls_at_rest(2000);
  ParticleSet p;
  const SolverScene prepared(scene);
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) append_record(p, initial_record(prepared, b), prepared);
  p.owned = p.size();
  p.v[1234] = {0, 0, -0.018};  // 1.7e-3 of its fall, less than a millionth of that of all: it may roll on in its place
  RestWatch watch(scene);
  watch.add(0.1, 0);
  watch.look(watch.busiest(p), 2000);
  EXPECT_TRUE(watch.at_rest(0.2));
  p.v[1234] = {0, 0, -0.06};  // 0.018 of its fall
  watch.look(watch.busiest(p), 2000);
  EXPECT_FALSE(watch.at_rest(0.2));
  p.v[1234] = {};
  watch.look(watch.busiest(p), 2000);
  EXPECT_TRUE(watch.at_rest(0.2));
  watch.look(0, 0);
  EXPECT_FALSE(watch.at_rest(0.2)) << "nobody rests";
}

TEST(Rest, is_looked_for_more_often_than_a_body_swings) {
  const Scene scene = balls_at_rest(1);
  EXPECT_NEAR(RestWatch(scene).row_interval(), std::sqrt(2 * 0.01 / 9.81) / 4, 1e-6);
}

}  // namespace
}  // namespace scree
