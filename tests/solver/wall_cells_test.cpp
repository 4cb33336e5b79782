// A very large wall divided into cells: exact forces, energy kept across cells, distant contacts that do not share stiffness.
#include <gtest/gtest.h>

#include "tests/support/shapes.hpp"
#include "tests/support/test_run.hpp"

namespace scree {
namespace {

using test::TestRun;

/// A body above terrain whose cells have the side `cell` (0: none).
TestRun above(const TriangleMesh& terrain, const Shape& body, double stiffness, double margin, double cell, double restitution) {
  TestRun run(test::empty_scene(stiffness, restitution, 0, margin));
  run.scene.shapes = {body, make_surface("terrain", terrain)};
  Wall wall;
  wall.id = 100;
  wall.kind = WallKind::mesh;
  wall.shape = 1;
  wall.cell_size = cell;
  run.scene.walls.push_back(wall);
  return run;
}

TriangleMesh floor_mesh() {
  TriangleMesh mesh = test::grid_box(3, {12, 4, 1});
  for (Vec3& p : mesh.vertices) p.z -= .5;
  return mesh;
}

// Weights of all cells sum to 1 and their gradients to 0, and the gradient is the derivative.
TEST(WallCells, weights_are_a_partition_of_unity_with_exact_gradients) {
  const TestRun run = above(floor_mesh(), make_solid("rock", test::rock(3, 1)), 1e4, .01, .3, 1);
  const SolverScene scene(run.scene);
  std::mt19937 g(5);
  std::uniform_real_distribution<double> u(-2, 2);
  std::vector<ContactFeature> features(1);
  std::vector<CellShare> shares, moved;
  int split = 0;
  for (int i = 0; i < 200; ++i) {
    PairBody a{&scene.shape(0), 1, {u(g), u(g), u(g)}, test::random_quaternion(g)},
        b{&scene.shape(1), 1, {u(g), u(g), u(g)}, test::random_quaternion(g)};
    features[0].key = static_cast<std::int64_t>(i % scene.shape(0).features.corners.size()) << 30;
    find_cell_shares(a, b, .3, CellSide::b, features, shares);
    double sum = 0;
    Vec3 gradient;
    for (const CellShare& s : shares) {
      sum += s.weight;
      gradient += s.gradient.force;
    }
    EXPECT_NEAR(sum, 1, 1e-14);
    EXPECT_LE(length(gradient), 1e-12);
    split += shares.size() > 1 ? 1 : 0;
    constexpr double kStep = 1e-7;
    const Vec3 along = rotate(a.q, Vec3{.6, 0, .8});
    a.x += kStep * along;
    find_cell_shares(a, b, .3, CellSide::b, features, moved);
    if (moved.size() != shares.size()) continue;
    for (std::size_t s = 0; s < shares.size(); ++s) {
      EXPECT_NEAR((moved[s].weight - shares[s].weight) / kStep, dot(shares[s].gradient.force, {.6, 0, .8}), 1e-4);
    }
  }
  EXPECT_GT(split, 100);
}

// A ball that slides over a floor of cells without friction has one contact throughout: cells change nothing.
TEST(WallCells, a_single_contact_does_not_feel_them) {
  for (const double cell : {.0, .37}) {
    TestRun run = above(floor_mesh(), make_sphere("ball", .1), 1e5, .002, cell, .5);
    run.scene.settings.gravity = {0, 0, -9.81};
    const double mass = 1000 * 4.0 / 3 * std::numbers::pi * 1e-3, height = .1 + .004 - mass * 9.81 / 1e5;
    test::add_body(run.scene, 0, {-2.05, .11, height}, {}, {1, .3, 0});
    run.start();
    double low = 1, high = 0;
    while (run.position(1).x < 0) {
      for (int n = 0; n < 20; ++n) run.simulation->advance();
      low = std::min(low, run.position(1).z);
      high = std::max(high, run.position(1).z);
    }
    EXPECT_NEAR(low, height, 1e-9) << cell;
    EXPECT_NEAR(high, height, 1e-9) << cell;
    EXPECT_NEAR(run.velocity(1).x, 1, 1e-9) << cell;
  }
}

// Nor does its friction: a ball that comes to stick where four cells meet swings on its spring as without them.
TEST(WallCells, the_friction_of_a_single_contact_does_not_feel_them) {
  constexpr double kSide = .37;
  std::vector<Vec3> places[2];
  for (const double cell : {.0, kSide}) {
    TestRun run = above(floor_mesh(), make_sphere("ball", .1), 1e5, .002, cell, .5);
    run.scene.settings.gravity = {0, 0, -9.81};
    run.scene.pairs[0].friction = run.scene.pairs[0].friction_sliding = .9;
    const double mass = 1000 * 4.0 / 3 * std::numbers::pi * 1e-3;
    test::add_body(run.scene, 0, {-6 * kSide, .01, .1 + .004 - mass * 9.81 / 1e5}, {}, {.02, .006, 0});
    run.start();
    for (int n = 0; n < 100; ++n) {
      run.simulation->advance();
      places[cell > 0 ? 1 : 0].push_back(run.position(1));
    }
    EXPECT_LT(length(run.velocity(1)), .8 * length(Vec3{.02, .006, 0}));  // it has come to stick
  }
  const double way = length(places[0].back() - places[0].front());
  for (std::size_t i = 0; i < places[0].size(); ++i) EXPECT_LE(length(places[0][i] - places[1][i]), 1e-9 * way) << i;
}

// A beam of 8 m on a floor: four corners in one potential give k 4^(1/4), two and two in two potentials 2 k 2^(1/4).
TEST(WallCells, let_distant_contacts_carry_on_their_own) {
  const double k = 1e6, margin = .01, weight = 1000 * 8 * .2 * .2 * 9.81;
  for (const double cell : {0.0, 2.0}) {
    TestRun run = above(floor_mesh(), make_solid("beam", test::grid_box(1, {8, .2, .2})), k, margin, cell, .2);
    run.scene.settings.gravity = {0, 0, -9.81};
    const double stiffness = cell > 0 ? 2 * k * std::pow(2, .25) : k * std::sqrt(2.0);
    const double height = .1 + 2 * margin - weight / stiffness;
    test::add_body(run.scene, 0, {0, 1, height + 1e-4}, {}, {});
    run.start();
    run.run_for(3);
    EXPECT_NEAR(run.position(1).z, height, 1e-3 * weight / stiffness) << cell;
    EXPECT_LE(length(run.velocity(1)), 1e-6) << cell;
  }
}

// The same for a free body of its own cells: the beam, on a plane and on a mesh.
TEST(WallCells, of_a_long_free_body_let_its_distant_contacts_carry_on_their_own) {
  const double k = 1e6, margin = .01, weight = 1000 * 8 * .2 * .2 * 9.81;
  for (const bool plane : {true, false}) {
    for (const double cell : {0.0, 2.0}) {
      TestRun run(test::empty_scene(k, .2, 0, margin));
      if (plane) test::add_plane(run.scene, {}, {0, 0, 1});
      run.scene.settings.gravity = {0, 0, -9.81};
      run.scene.shapes = {make_solid("beam", test::grid_box(1, {8, .2, .2})), make_solid("floor", test::grid_box(2, {12, 4, 1}))};
      run.scene.shapes[0].cell_size = cell;
      // both corners of an end lie beside the border of two cells and are shared by them: y = 0.1 m is t = 0.6 of the way across
      const double t = (.1 / 2 + .5 - .25) / .5, share = t * t * (3 - 2 * t);
      const double apart = 2 * std::pow(std::pow(share, 4) + std::pow(1 - share, 4), .25);
      const double height = .1 + 2 * margin - weight / (cell > 0 ? 2 * k * apart : k * std::sqrt(2.0));
      test::add_body(run.scene, 0, {0, 1, height + 1e-4});
      if (!plane) {
        test::add_body(run.scene, 1, {0, 0, -.5});
        run.scene.bodies.fixed[1] = 1;
      }
      const auto id = static_cast<std::int64_t>(run.scene.bodies.id[0]);
      run.start();
      run.run_for(3);
      EXPECT_NEAR(run.position(id).z, height, 1e-3 * weight / k) << cell;
      EXPECT_LE(length(run.velocity(id)), 1e-6) << cell;
    }
  }
}

// Elastic rocks that bounce over bumpy terrain of cells keep their energy as they do on terrain of one potential.
TEST(WallCells, keep_the_energy_of_bouncing_rocks) {
  for (const double cell : {0.0, .3}) {  // half the rock: smaller cells need smaller steps
    double worst = 0, scale = 0;
    int contacts = 0;
    for (unsigned seed = 1; seed <= 4; ++seed) {
      TestRun run = above(test::bumpy_bed(), make_solid("rock", test::scaled(test::rock(seed, 2), .3)), 4e6, .01, cell, 1);
      run.scene.settings.gravity = {0, 0, -9.81};
      run.scene.settings.steps_per_contact = 200;
      std::mt19937 g(seed);
      test::add_body(run.scene, 0, {.1, .05, .8}, test::random_quaternion(g), {.2, .1, -1}, {1, 2, 0});
      run.start();
      const double before = energies_of(run.simulation->state()).balance();
      scale = .5 * 1000 * run.scene.shapes[0].mass.volume;  // kinetic energy of the start, about
      for (int n = 0; n < 20000; ++n) {
        run.simulation->advance();
        contacts += static_cast<int>(contact_count(run.simulation->state()));
      }
      worst = std::max(worst, std::abs(energies_of(run.simulation->state()).balance() - before) / scale);
    }
    std::printf("cells of %.2f m: energy of bouncing rocks off by %.1e, %d contacts\n", cell, worst, contacts);
    EXPECT_GT(contacts, 100);
    EXPECT_LE(worst, 5e-3) << cell;
  }
}

}  // namespace
}  // namespace scree
