// Closed forms of docs/reference/validation-plan.md that need whole runs: impulses off centre, mesh independence, stacks, rolling.
#include <gtest/gtest.h>

#include "solver/laws/restitution.hpp"
#include "tests/support/shapes.hpp"
#include "tests/support/test_run.hpp"

namespace scree {
namespace {

using test::TestRun;

// I3: a box falls on a corner. J = (1 + e) v m_eff; the error is that of the finite contact time, proportional to
// k^(-1/2) (with the reduced mass in place of m_eff it would not vanish), and at most 0.2 % once the contact time is
// 1e-3 of the box's size over its speed, as at the last stiffness.
TEST(Impulse, of_a_box_on_its_corner_converges_to_the_rigid_formula) {
  const Quat q = quaternion_of(normalised(Vec3{.6, .5, .3}), .9);
  double previous = 1;
  for (const double stiffness : {3e5, 3e7, 3e9}) {
    TestRun run(test::empty_scene(stiffness, 0.744079, 0, 0.01 / std::sqrt(stiffness / 1e6), 1000));
    run.scene.settings.steps_per_contact = 200;
    run.scene.shapes = {make_solid("box", test::grid_box(1, {1, .8, .6}))};
    Vec3 corner{0, 0, 1};
    for (const Vec3& p : run.scene.shapes[0].mesh.vertices) {
      if (rotate(q, p).z < corner.z) corner = rotate(q, p);
    }
    const double mass = 480;
    const Vec3 n{0, 0, 1};
    const Vec3 inertia{mass / 12 * (.64 + .36), mass / 12 * (1 + .36), mass / 12 * (1 + .64)};
    const Vec3 lever = rotate_inverse(q, cross(corner, n));
    const Vec3 turned{lever.x / inertia.x, lever.y / inertia.y, lever.z / inertia.z};
    const double effective = 1 / (1 / mass + dot(lever, turned));
    const double impulse = 1.744079 * effective;
    const double expected_v = -1 + impulse / mass;
    const Vec3 expected_w = impulse * rotate(q, turned);
    EXPECT_NEAR(expected_v, .00847, 1e-4);  // the published figures
    EXPECT_NEAR(expected_w.y, -2.5250, 1e-4);

    test::add_body(run.scene, 0, {0, 0, -corner.z + 2.2 * run.scene.settings.margin}, q, {0, 0, -1});
    test::add_plane(run.scene, {0, 0, 0}, n);
    run.start();
    // until the corner has left again
    bool touched = false;
    for (int i = 0; i < 200000; ++i) {
      run.simulation->advance();
      const bool touches = contact_count(run.simulation->state()) > 0;
      if (touched && !touches) break;
      touched = touched || touches;
    }
    const double error = std::max(std::abs(run.velocity(0).z - expected_v), length(run.spin(0) - expected_w) / length(expected_w));
    EXPECT_LE(error, previous / 5) << "stiffness " << stiffness;  // k^(-1/2) would give 10
    if (stiffness > 1e9) {
      EXPECT_LE(error, 2e-3);
    }
    previous = error;
  }
}

// docs/reference/contact-law.md section 5, test 5: |e - 0.5| <= 5e-3 at 100 steps a contact for every level of an icosphere.
TEST(MeshIndependence, restitution_of_a_locked_icosphere_is_that_of_every_refinement) {
  for (int level = 0; level <= 4; ++level) {
    TestRun run(test::empty_scene(1e4, 0.5, 0, 0.01, 1));
    run.scene.shapes = {make_solid("sphere", test::scaled(test::icosphere(level), 0.5))};
    run.scene.settings.steps_per_contact = 100;
    const double density = 1 / run.scene.shapes[0].mass.volume;  // mass 1
    run.scene.materials[0].density = density;
    test::add_body(run.scene, 0, {0, 0, 0.525}, quaternion_of(normalised(Vec3{1, 2, 3}), 0.4), {0, 0, -1});
    run.scene.bodies.lock_rotation[0] = 1;
    test::add_plane(run.scene, {0, 0, 0}, {0, 0, 1});
    run.start();
    run.run_for(0.2);
    EXPECT_NEAR(run.velocity(0).z, 0.5, 5e-3) << "level " << level;
  }
}

// M1 with docs/reference/contact-law.md test 4: a flat face, however finely meshed.
TEST(MeshIndependence, restitution_of_a_cube_on_its_face_does_not_know_the_mesh) {
  std::vector<double> rebounds;
  for (const int n : {1, 2, 4, 8, 16}) {
    TestRun run(test::empty_scene(1e4, 0.5, 0, 0.01, 1));
    run.scene.settings.steps_per_contact = 100;
    run.scene.shapes = {make_solid("cube", test::grid_box(n, {1, 1, 1}))};
    test::add_body(run.scene, 0, {0, 0, 0.525}, {}, {0, 0, -1});
    test::add_plane(run.scene, {0, 0, 0}, {0, 0, 1});
    run.start();
    run.run_for(0.2);
    rebounds.push_back(run.velocity(0).z);
  }
  for (const double e : rebounds) {
    EXPECT_NEAR(e, 0.5, 5e-3);
    EXPECT_NEAR(e, rebounds[0], 1e-5);
  }
}

// M0: one spring and dashpot for each of N coincident triangle pairs have the damping ratio sqrt(N) zeta: the restitution
// depends on the mesh, which is why it is not the default.
TEST(MeshIndependence, one_spring_per_triangle_pair_rebounds_by_the_number_of_triangles) {
  for (const int n : {1, 2}) {
    TestRun run(test::empty_scene(1e4, 0.744079, 0, 0.01, 1));
    run.scene.settings.gather = Gathering::pairs;
    run.scene.settings.step = 1e-5;
    run.scene.shapes = {make_solid("cube", test::grid_box(n, {1, 1, 1})), make_solid("floor", test::grid_box(1, {3, 3, 1}))};
    test::add_body(run.scene, 0, {0, 0, 1.0201}, {}, {0, 0, -1});
    test::add_body(run.scene, 1, {0, 0, 0});
    run.scene.bodies.lock_rotation[0] = 1;
    run.scene.bodies.fixed[1] = 1;
    run.start();
    std::int64_t coincident = 0;
    for (int step = 0; step < 6000; ++step) {
      run.simulation->advance();
      coincident = std::max(coincident, contact_count(run.simulation->state()));
    }
    const double zeta = std::sqrt(static_cast<double>(coincident)) * damping_ratio_of_restitution(0.744079);
    std::printf("M0: %d subdivisions, %d triangle pairs, e = %.5f, expected %.5f\n", n, static_cast<int>(coincident), run.velocity(0).z,
                restitution_of_damping_ratio(zeta));
    EXPECT_GE(coincident, 4);
    EXPECT_NEAR(run.velocity(0).z, restitution_of_damping_ratio(zeta), 2e-3) << n;
  }
}

// S2: a stack of cubes at rest. Interface i carries the cubes above it: d = load / (sqrt(2) k) for four corners.
TEST(Statics, a_stack_of_cubes_stands_with_the_depths_of_its_loads) {
  constexpr int kCubes = 5;
  const double k = 1e6, margin = 0.002;
  TestRun run(test::empty_scene(k, 0.3, 0.5, margin));
  run.scene.settings.gravity = {0, 0, -9.81};
  run.scene.shapes = {make_solid("cube", test::grid_box(1, {0.1, 0.1, 0.1}))};
  for (int i = 0; i < kCubes; ++i) test::add_body(run.scene, 0, {0, 0, 0.05 + 0.1 * i + 2 * margin * (i + 1)});
  test::add_plane(run.scene, {0, 0, 0}, {0, 0, 1});
  run.start();
  run.run_for(2.0);
  // Against a plane four corners carry; cube on cube eight coincide: U = k n^(1/4) d^2 / 2.
  double height = 0.05;
  for (int i = 0; i < kCubes; ++i) {
    const double features = i == 0 ? 4 : 8;
    height += 2 * margin - (kCubes - i) * 1.0 * 9.81 / (k * std::pow(features, 0.25));
    EXPECT_NEAR(run.position(i).z, height, 1e-3 * 9.81 / k) << "cube " << i;
    EXPECT_LE(length(run.velocity(i)), 1e-8) << "cube " << i;
    height += 0.1;
  }
}

// F5: a ball that slides comes to roll at v = v0 / (1 + I / m R^2), by the mesh's own inertia and support height.
TEST(Friction, turns_sliding_of_an_icosphere_into_rolling) {
  TestRun run(test::empty_scene(1e6, 0.5, 0.2, 0.002));
  run.scene.settings.gravity = {0, 0, -9.81};
  run.scene.shapes = {make_solid("ball", test::scaled(test::icosphere(4), 0.1))};
  const MassProperties& mass = run.scene.shapes[0].mass;
  test::add_body(run.scene, 0, {0, 0, 0.1 + 0.00395}, {}, {2, 0, 0});
  test::add_plane(run.scene, {0, 0, 0}, {0, 0, 1});
  run.start();
  run.run_for(0.3);
  // Rolling over facets ripples: means over the next 0.1 s, about 1.4 ball radii.
  double speed = 0, slip = 0;
  int samples = 0;
  for (const double until = run.simulation->time() + 0.1; run.simulation->time() < until; ++samples) {
    run.simulation->advance();
    speed += run.velocity(0).x;
    // friction acts in the middle of the gap, half of both margins below the surface
    slip += run.velocity(0).x - (run.position(0).z - run.scene.settings.margin) * run.spin(0).y;
  }
  const double ratio = mass.principal_moments.y / (mass.volume * 0.01);
  EXPECT_NEAR(speed / samples, 2 / (1 + ratio), 0.005 * 2);
  EXPECT_LE(std::abs(slip / samples), 0.005 * 2);
}

// A floor that starts to move carries a block along by friction: a = mu g until it has the floor's speed, and the work of
// the floor closes the energy balance.
TEST(DrivenWall, carries_a_block_along_and_its_work_is_counted) {
  TestRun run(test::empty_scene(1e6, 0.5, 0.3, 0.002));
  run.scene.settings.gravity = {0, 0, -9.81};
  run.scene.shapes = {make_solid("block", test::grid_box(1, {0.2, 0.2, 0.1}))};
  test::add_body(run.scene, 0, {0, 0, 0.05 + 0.004 - 4 * 9.81 / (std::sqrt(2.0) * 1e6)});
  test::add_plane(run.scene, {0, 0, 0}, {0, 0, 1});
  WallMotion& motion = run.scene.walls[0].motion;
  motion.kind = Translate{.axis = {1, 0, 0}, .rate = 1};
  motion.start = 0.1;
  run.start();
  const double before = energies_of(run.simulation->state()).balance();
  run.run_for(0.3);  // 0.2 s of sliding
  EXPECT_NEAR(run.velocity(0).x, 0.3 * 9.81 * 0.2, 0.01 * 0.3 * 9.81 * 0.2);
  run.run_for(0.3);  // v = mu g t reaches the floor's speed after 0.34 s
  EXPECT_NEAR(run.velocity(0).x, 1, 1e-3);
  const Energies e = energies_of(run.simulation->state());
  EXPECT_NEAR(e.wall_work, 4 * 1.0 * 1.0, 0.01 * 4);  // m v^2: half becomes motion, half is lost by sliding
  EXPECT_NEAR(e.dissipated, 0.5 * 4, 0.01 * 4);
  EXPECT_NEAR(e.balance(), before, 0.01 * 4);
}

// A drum turns about its axis: a ball inside that does not slip is carried up its wall; the torque on the drum is there.
TEST(DrivenWall, a_turning_cylinder_takes_a_ball_with_it) {
  TestRun run(test::empty_scene(1e6, 0.3, 0.8, 0));
  run.scene.settings.gravity = {0, 0, -9.81};
  run.scene.shapes = {make_sphere("ball", 0.02)};
  test::add_body(run.scene, 0, {0, 0.1, -0.18});
  Wall drum;
  drum.id = 1;
  drum.kind = WallKind::cylinder_inside;
  drum.axis_start = {0, 0, 0};
  drum.axis_end = {0, 0.2, 0};
  drum.radius = 0.2;
  drum.motion.kind = Rotate{.axis = {0, 1, 0}, .rate = 10};
  run.scene.walls.push_back(drum);
  run.start();
  run.run_for(1.0);
  // the ball swings to and fro, but its rim moves with the drum: no slip
  const Vec3 x = run.position(0), outward = normalised(Vec3{x.x, 0, x.z});
  const Vec3 rim = run.velocity(0) + cross(run.spin(0), 0.02 * outward);
  const Vec3 jacket = cross(Vec3{0, 10, 0}, 0.2 * outward);
  EXPECT_LE(length(rim - jacket), 0.01 * length(jacket));
  EXPECT_GT(run.spin(0).y, 30);
  EXPECT_LE(std::abs(length(run.position(0) - Vec3{0, run.position(0).y, 0}) - 0.18), 1e-4);
}

}  // namespace
}  // namespace scree
