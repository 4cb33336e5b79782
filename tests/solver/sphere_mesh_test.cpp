// Analytic spheres against meshes: agreement with the analytic wall, corners of grooves, fine meshes of the sphere.
#include <gtest/gtest.h>

#include "tests/support/shapes.hpp"
#include "tests/support/test_run.hpp"

namespace scree {
namespace {

using test::TestRun;

/// A wall made of a mesh, its coordinates as they are.
void add_mesh_wall(Scene& scene, const TriangleMesh& mesh) {
  scene.shapes.push_back(make_surface("wall", mesh));
  Wall wall;
  wall.id = static_cast<std::int64_t>(scene.bodies.size() + scene.walls.size());
  wall.kind = WallKind::mesh;
  wall.shape = static_cast<std::int32_t>(scene.shapes.size()) - 1;
  scene.walls.push_back(wall);
}

TriangleMesh floor_mesh(int n) {  // the top of a slab at z = 0
  TriangleMesh mesh = test::grid_box(n, {2, 2, 0.2});
  for (Vec3& p : mesh.vertices) p.z -= 0.1;
  return mesh;
}

Scene bouncing_ball(const Vec3& at, const Vec3& velocity, const Vec3& spin) {
  Scene scene = test::empty_scene(1e5, 0.6, 0.4, 0.002);
  scene.settings.gravity = {0, 0, -9.81};
  scene.settings.step = 1e-4;  // the derived one is shorter on a mesh, where several features may carry
  scene.shapes = {make_sphere("ball", 0.1)};
  test::add_body(scene, 0, at, {}, velocity, spin);
  return scene;
}

// The issue behind it: a sphere on a meshed plane behaves as on an analytic one, however the plane is meshed.
TEST(SphereOnMesh, bounces_on_a_meshed_plane_as_on_an_analytic_one) {
  TestRun plane(bouncing_ball({0.013, 0.007, 0.15}, {0.5, 0.2, -1}, {3, 4, 5}));
  plane.scene.pairs[0].stiffness = 1e6;
  test::add_plane(plane.scene, {0, 0, 0}, {0, 0, 1});
  plane.start();
  plane.run_for(0.5);
  for (const int n : {1, 2, 7}) {
    TestRun mesh(bouncing_ball({0.013, 0.007, 0.15}, {0.5, 0.2, -1}, {3, 4, 5}));
    mesh.scene.pairs[0].stiffness = 1e6;
    add_mesh_wall(mesh.scene, floor_mesh(n));
    mesh.start();
    mesh.run_for(0.5);
    EXPECT_LE(length(mesh.position(0) - plane.position(0)), 1e-10) << n;
    EXPECT_LE(length(mesh.spin(0) - plane.spin(0)), 1e-8) << n;
  }
}

// Exactly above an inner mesh edge or vertex no contact is lost.
TEST(SphereOnMesh, is_carried_exactly_above_inner_edges_and_vertices) {
  for (const Vec3& at : {Vec3{0, 0, 0.104}, Vec3{0.25, 0.25, 0.104}, Vec3{0.5, 0.1, 0.104}}) {
    TestRun run(bouncing_ball(at, {}, {}));
    add_mesh_wall(run.scene, floor_mesh(4));
    run.start();
    run.run_for(0.6);
    const double mass = 1000 * 4.0 / 3 * 3.14159265358979 * 1e-3;
    EXPECT_NEAR(run.position(0).z, 0.104 - mass * 9.81 / 1e5, 1e-7);
    EXPECT_NEAR(run.position(0).x, at.x, 1e-9);
  }
}

// A ball in a right-angled groove rests on both faces: each carries m g / sqrt(2).
TEST(SphereOnMesh, rests_on_both_faces_of_a_groove) {
  TestRun run(bouncing_ball({0, 0, 0.16}, {}, {}));
  run.scene.pairs[0].friction = 0;
  TriangleMesh groove;
  groove.vertices = {{0, -1, 0}, {0, 1, 0}, {1, -1, 1}, {1, 1, 1}, {-1, -1, 1}, {-1, 1, 1}};
  groove.triangles = {{0, 2, 3}, {0, 3, 1}, {0, 1, 5}, {0, 5, 4}};
  add_mesh_wall(run.scene, groove);
  run.start();
  run.run_for(2.0);
  EXPECT_EQ(contact_count(run.simulation->state()), 2);
  EXPECT_LE(length(run.velocity(0)), 1e-6);
  // one pair: two equal features, U = k 2^(1/4) d^2 / 2; along each normal half the weight times sqrt(2)
  const double mass = 1000 * 4.0 / 3 * 3.14159265358979 * 1e-3;
  const double overlap = mass * 9.81 / std::sqrt(2.0) / (1e5 * std::pow(2, 0.25) / 2);
  EXPECT_NEAR(run.position(0).z, std::sqrt(2.0) * (0.1 + 0.004 - overlap), 1e-6);
}

// A straight ridge with vertices inside it carries as one edge: a contact, and no speed along the ridge without friction. Pieces that
// end beside the foot were contacts too, under the same key.
TEST(SphereOnMesh, on_a_straight_ridge_with_inner_vertices_has_one_contact) {
  TriangleMesh roof;
  constexpr std::int32_t kPieces = 4;
  for (std::int32_t i = 0; i <= kPieces; ++i) {
    const double y = i - 0.5 * kPieces;
    for (const double x : {0.0, 1.0, -1.0}) roof.vertices.push_back({x, y, -std::abs(x)});
  }
  for (std::int32_t i = 0; i < 3 * kPieces; i += 3) {
    for (const Triangle& t :
         {Triangle{i, i + 1, i + 3}, Triangle{i + 1, i + 4, i + 3}, Triangle{i, i + 3, i + 2}, Triangle{i + 3, i + 5, i + 2}})
      roof.triangles.push_back(t);
  }
  for (const double beside : {0.0, 1e-9, 1e-4, 0.01, 0.04, 0.5}) {
    TestRun run(bouncing_ball({0, beside, 0.107}, {0, 0, -1}, {}));
    run.scene.settings.gravity = {};
    run.scene.pairs[0].friction = 0;
    run.scene.pairs[0].stiffness = 1e6;
    run.scene.settings.step = 2e-5;
    add_mesh_wall(run.scene, roof);
    run.start();
    std::int64_t most = 0;
    for (int n = 0; n < 1500; ++n) {
      run.simulation->advance();
      most = std::max(most, contact_count(run.simulation->state()));
    }
    EXPECT_EQ(most, 1) << beside;
    EXPECT_GT(run.velocity(0).z, 0.5) << beside;
    EXPECT_LE(std::abs(run.velocity(0).y), 1e-12) << beside;
  }
}

// Sphere against a free rock: momentum, angular momentum and energy are kept, in both orders of ids.
TEST(SphereOnMesh, collides_with_a_rock_without_losing_momentum_or_energy) {
  for (const bool sphere_first : {true, false}) {
    TestRun run(test::empty_scene(1e5, 1, 0, 0.004));
    run.scene.settings.steps_per_contact = 100;
    run.scene.shapes = {make_sphere("ball", 0.06), make_solid("rock", test::scaled(test::rock(3, 2), 0.1))};
    test::add_body(run.scene, sphere_first ? 0 : 1, {0.01, 0.02, 0.25}, {}, {0, 0, -1}, {1, 2, 3});
    test::add_body(run.scene, sphere_first ? 1 : 0, {0, 0, 0}, {}, {0, 0, 1}, {-2, 1, 4});
    run.start();
    const double energy = energies_of(run.simulation->state()).balance();
    const Vec3 L = run.angular_momentum(), p = run.momentum();
    std::int64_t touched = 0;
    for (int n = 0; n < 6000; ++n) {
      run.simulation->advance();
      touched += contact_count(run.simulation->state());
    }
    EXPECT_GT(touched, 50);
    EXPECT_NEAR(energies_of(run.simulation->state()).balance(), energy, 3e-3 * energy);
    EXPECT_LE(length(run.momentum() - p), 1e-12 * 10);
    EXPECT_LE(length(run.angular_momentum() - L), 1e-12 * 10);
  }
}

}  // namespace
}  // namespace scree
