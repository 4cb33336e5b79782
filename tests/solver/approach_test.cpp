// How fast surfaces come together at the start, against what geometry says.
#include <gtest/gtest.h>

#include <cmath>

#include "solver/step_size/approach.hpp"
#include "tests/support/scenes.hpp"
#include "tests/support/shapes.hpp"

namespace scree {
namespace {

constexpr double kMargin = 1e-3;

/// A ball (shape 0, radius 0.1), a cube (1, side 0.2) and a floor slab (2, 4 x 4 x 0.2), all in the air.
Scene shapes_only() {
  Scene scene = test::empty_scene(1e4, 0.5, 0.3, kMargin);
  scene.shapes = {make_sphere("ball", 0.1), make_solid("cube", test::grid_box(2, {0.2, 0.2, 0.2})),
                  make_solid("slab", test::grid_box(3, {4, 4, 0.2}))};
  return scene;
}

double speed_of(const Scene& scene) { return fastest_approach(SolverScene(scene), 0).speed; }

TEST(Approach, of_a_ball_and_a_plane_is_its_speed_along_the_normal_whether_far_or_near) {
  for (const double height : {0.1 + kMargin, 50.0}) {
    Scene scene = shapes_only();
    test::add_body(scene, 0, {0, 0, height}, {}, {3, 0, -4}, {7, 8, 9});
    test::add_plane(scene, {0, 0, 0}, {0, 0, 1});
    const Approach found = fastest_approach(SolverScene(scene), 0);
    EXPECT_NEAR(found.speed, 4, 1e-12);
    EXPECT_EQ(found.who, "body 0 and wall 1 ('plane')");
    EXPECT_EQ(fastest_approach(SolverScene(scene), 4.001).speed, 0) << "slower than what was asked for";
    scene.bodies.velocity[0] = {3, 0, 4};
    EXPECT_EQ(speed_of(scene), 0) << "moves away";
  }
}

TEST(Approach, is_none_where_a_ball_rolls_or_a_cube_slides) {
  const double gap = 0.5 * kMargin;
  for (const bool on_body : {false, true}) {
    for (const int shape : {0, 1}) {
      Scene scene = shapes_only();
      test::add_body(scene, shape, {0, 0, 0.1 + gap}, {}, {2, 1, 0}, shape == 0 ? Vec3{-10, 20, 5} : Vec3{});
      if (on_body) {
        test::add_body(scene, 2, {0, 0, -0.1});
        scene.bodies.fixed[1] = 1;
      } else {
        test::add_plane(scene, {0, 0, 0}, {0, 0, 1});
      }
      EXPECT_NEAR(speed_of(scene), 0, 1e-8) << shape << " on a body: " << on_body;
      test::add_plane(scene, {5, 0, 0}, {-1, 0, 0});
      EXPECT_NEAR(speed_of(scene), 2, 1e-8) << "a wall lies ahead";
    }
  }
}

TEST(Approach, of_a_spinning_cube_is_what_its_corners_can_do) {
  Scene scene = shapes_only();
  test::add_body(scene, 1, {0, 0, 0.1 + kMargin}, {}, {}, {0, 3, 0});
  test::add_plane(scene, {0, 0, 0}, {0, 0, 1});
  // |r x n| of a corner and the face that it lies on
  EXPECT_NEAR(speed_of(scene), 3 * std::hypot(0.1, 0.1), 1e-12);
}

TEST(Approach, of_two_balls_is_their_relative_speed_where_their_paths_meet) {
  const auto approach = [](const Vec3& place, const Vec3& velocity_a, const Vec3& velocity_b) {
    Scene scene = shapes_only();
    test::add_body(scene, 0, {0, 0, 0}, {}, velocity_a);
    test::add_body(scene, 0, place, {}, velocity_b);
    return speed_of(scene);
  };
  EXPECT_NEAR(approach({3, 0, 0}, {1, 0, 0}, {-2, 0, 0}), 3, 1e-12);
  EXPECT_EQ(approach({3, 0, 0}, {-1, 0, 0}, {2, 0, 0}), 0);
  EXPECT_EQ(approach({3, 0, 0}, {5, 4, 0}, {5, 4, 0}), 0) << "side by side";
  EXPECT_EQ(approach({3, 0.3, 0}, {1, 0, 0}, {}), 0) << "beside each other";
  EXPECT_NEAR(approach({3, 0.19, 0}, {1, 0, 0}, {}), 1, 1e-12) << "grazing";
  EXPECT_NEAR(approach({0.2 + kMargin, 0, 0}, {1, 5, 0}, {}), 1, 1e-12) << "near: along the line of centres";
}

TEST(Approach, of_two_cubes_that_touch_is_that_of_their_faces) {
  Scene scene = shapes_only();
  test::add_body(scene, 1, {0, 0, 0}, {}, {0, 0, 0.5});
  test::add_body(scene, 1, {0.05, 0.02, 0.2 + kMargin}, {}, {3, 4, 0.2});
  EXPECT_NEAR(speed_of(scene), 0.3, 1e-8);
  // both turn with a table: nothing changes between them
  scene.bodies.velocity = {{}, cross({0, 0, 9}, scene.bodies.position[1])};
  scene.bodies.angular_velocity = {{0, 0, 9}, {0, 0, 9}};
  EXPECT_NEAR(speed_of(scene), 0, 1e-8);
}

TEST(Approach, inside_a_cylinder_is_taken_where_the_path_ends) {
  for (const double aside : {0.0, 0.3, 0.9}) {
    Scene scene = shapes_only();
    test::add_body(scene, 0, {aside, 0, 0}, {}, {0, 2, 1});
    Wall wall;
    wall.id = 1;
    wall.kind = WallKind::cylinder_inside;
    wall.axis_start = {0, 0, -1e3};
    wall.axis_end = {0, 0, 1e3};
    wall.radius = 1;
    scene.walls.push_back(wall);
    // along the axis it meets the lid at 1 m/s
    const double room = 0.9, across = 2 * std::sqrt(1 - aside * aside / (room * room));
    EXPECT_NEAR(speed_of(scene), std::max(across, 1.0), 1e-7) << aside;
  }
}

TEST(Approach, before_a_mesh_wall_is_seen_ahead) {
  Scene scene = shapes_only();
  scene.shapes.push_back(make_solid("inside of a box", test::grid_box(4, {2, 2, 2})));
  test::add_body(scene, 0, {-0.5, 0, -0.9 + kMargin}, {}, {2, 0, 0}, {0, 20, 0});
  Wall wall;
  wall.id = 1;
  wall.kind = WallKind::mesh;
  wall.shape = 3;
  scene.walls.push_back(wall);
  EXPECT_NEAR(speed_of(scene), 2, 1e-8);
  scene.bodies.velocity[0] = {0, 0, 0.25};
  scene.walls[0].motion.kind = Translate{.axis = {0, 0, 1}, .rate = 1};
  EXPECT_NEAR(speed_of(scene), 0.75, 1e-8) << "the floor comes up";
}

}  // namespace
}  // namespace scree
