// Walls as they are drawn, and how much of them a picture shows.
#include "post/run/drawn_meshes.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace scree {
namespace {

/// One ball at the origin, of radius 1.
Frame one_ball() {
  Frame frame;
  frame.bodies.id = {0};
  frame.bodies.shape = {0};
  frame.bodies.material = {0};
  frame.bodies.scale = {1};
  frame.bodies.position = {Vec3{}};
  frame.bodies.orientation = {Quat{}};
  return frame;
}

Scene scene_with(Wall wall) {
  Scene scene;
  scene.shapes = {make_sphere("ball", 1)};
  wall.id = 1;
  scene.walls = {std::move(wall)};
  return scene;
}

Wall tube(double length, const Vec3& at) {
  Wall wall;
  wall.kind = WallKind::cylinder_inside;
  wall.axis_start = at;
  wall.axis_end = at + Vec3{0, 0, length};
  wall.radius = 2;
  return wall;
}

TEST(DrawnWall, across_a_periodic_axis_ends_at_the_cell) {
  Scene scene = scene_with(tube(10, {0, 0, -5}));
  const auto longest = [&] {
    double z = 0;
    for (const Vec3& p : drawn_wall(scene.walls[0], scene, Box3{}).vertices) z = std::max(z, std::abs(p.z));
    return z;
  };
  EXPECT_EQ(longest(), 5);
  scene.settings.domain.bounded = true;
  scene.settings.domain.lower = {-3, -3, -1.5};
  scene.settings.domain.upper = {3, 3, 1.5};
  EXPECT_EQ(longest(), 5) << "a domain without periodic axes cuts nothing";
  scene.settings.domain.periodic = {false, false, true};
  EXPECT_EQ(longest(), 1.5);
}

TEST(SeenRoom, has_a_tube_as_a_whole_and_of_one_that_was_lifted_off_only_what_is_near) {
  const Frame frame = one_ball();
  EXPECT_EQ(seen_room(frame, scene_with(tube(4, {0, 0, -1}))).upper.z, 3) << "around the bodies";
  Wall gone = tube(4, {0, 0, 1.5});
  EXPECT_EQ(seen_room(frame, scene_with(gone)).upper.z, 5.5) << "it stands there";
  Translate up;
  up.rate = 1;
  gone.motion.kind = up;
  EXPECT_NEAR(seen_room(frame, scene_with(gone)).upper.z, 1 + 0.35 * 2, 1e-12) << "it has left them";
}

}  // namespace
}  // namespace scree
