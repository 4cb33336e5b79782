// What a contact on a piece moves: mass, centre and inertia of all that bonds hold to it, against sums over bodies of known place.
#include <gtest/gtest.h>

#include <random>

#include "solver/bodies/particle_set.hpp"
#include "solver/neighbours/fragment_masses.hpp"
#include "tests/support/scenes.hpp"
#include "tests/support/shapes.hpp"

namespace scree {
namespace {

constexpr std::int64_t kNever = kHolds;

/// Bricks of different sizes in a ring of bonds 0-1-2-3-0 and a tail 3-4-5. Each has a mesh with axes of its own, so that no two of them
/// are turned alike: what is one frame in the world is another in every body.
Scene ring_with_tail() {
  Scene scene = test::empty_scene(1e4, 0.5, 0.3, 1e-4);
  std::mt19937 generator(7);
  const Vec3 places[6] = {{0, 0, 0}, {0.3, 0, 0.02}, {0.3, 0.25, 0}, {0, 0.25, -0.03}, {-0.2, 0.4, 0.1}, {-0.2, 0.7, 0.1}};
  const Vec3 sizes[6] = {{0.2, 0.1, 0.1}, {0.15, 0.2, 0.1}, {0.1, 0.1, 0.3}, {0.2, 0.2, 0.1}, {0.05, 0.1, 0.2}, {0.1, 0.1, 0.12}};
  for (std::int32_t b = 0; b < 6; ++b) {
    const Quat turn = test::random_quaternion(generator);
    TriangleMesh mesh = test::grid_box(1, sizes[b]);
    for (Vec3& p : mesh.vertices) p = rotate_inverse(turn, p);
    scene.shapes.push_back(make_solid("brick", mesh));
    test::add_body(scene, b, places[b], turn);
  }
  const auto bond = [&](std::int64_t a, std::int64_t b) {
    Bond between;
    between.a = std::min(a, b);
    between.b = std::max(a, b);
    const auto row_a = static_cast<std::size_t>(between.a), row_b = static_cast<std::size_t>(between.b);
    // a face anywhere between both, in any direction
    const Vec3 face = 0.5 * (scene.bodies.position[row_a] + scene.bodies.position[row_b]) + Vec3{0.01, -0.02, 0.005};
    const Quat frame = test::random_quaternion(generator);
    between.point_a = rotate_inverse(scene.bodies.orientation[row_a], face - scene.bodies.position[row_a]);
    between.point_b = rotate_inverse(scene.bodies.orientation[row_b], face - scene.bodies.position[row_b]);
    between.frame_a = conjugate(scene.bodies.orientation[row_a]) * frame;
    between.frame_b = conjugate(scene.bodies.orientation[row_b]) * frame;
    between.area = 1e-2;
    between.moment_1 = between.moment_2 = 1e-5;
    between.height = 0.1;
    between.rim_radius = 0.05;
    between.normal_stiffness = between.tangential_stiffness = 1e8;
    scene.bonds.push_back(between);
  };
  bond(0, 1);
  bond(1, 2);
  bond(2, 3);
  bond(0, 3);
  bond(3, 4);
  bond(4, 5);
  return scene;
}

Mat3 in_world(const Quat& q, const Mat3& m) {
  const Mat3 r = matrix_of(q);
  return r * m * transpose(r);
}

/// What `of` gives for a body, in world axes, against the sum over these bodies.
void expect_fragment(const Scene& scene, const SolverScene& solver, const FragmentMasses& masses, std::int64_t id,
                     const std::vector<std::size_t>& members) {
  const BondedMass* found = masses.of(id);
  ASSERT_NE(found, nullptr) << id;
  double mass = 0;
  Vec3 moment;
  const auto mass_of = [&](std::size_t b) { return scene.mass(scene.bodies.shape[b], scene.bodies.material[b], scene.bodies.scale[b]); };
  for (const std::size_t b : members) {
    mass += mass_of(b);
    moment += mass_of(b) * scene.bodies.position[b];
  }
  const Vec3 centre = (1 / mass) * moment;
  Mat3 inertia;
  for (const std::size_t b : members) {
    const Shape& shape = scene.shapes[static_cast<std::size_t>(scene.bodies.shape[b])];
    const Mat3 own = in_world(scene.bodies.orientation[b], shape.mass.inertia);
    const Vec3 arm = scene.bodies.position[b] - centre;
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j)
        inertia[i][j] += mass_of(b) / shape.mass.volume * own[i][j] + mass_of(b) * ((i == j ? squared_length(arm) : 0.0) - arm[i] * arm[j]);
    }
  }
  const auto row = static_cast<std::size_t>(id);
  const Quat principal = scene.bodies.orientation[row] * solver.shape(scene.bodies.shape[row]).body_from_principal;
  EXPECT_NEAR(found->inverse_mass * mass, 1, 1e-13) << id;
  EXPECT_LT(length(scene.bodies.position[row] + rotate(principal, found->centre) - centre), 1e-13) << id;
  const Mat3 product = in_world(principal, found->inverse_inertia) * inertia;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) EXPECT_NEAR(product[i][j], i == j ? 1.0 : 0.0, 1e-11) << id;
  }
}

TEST(FragmentMasses, of_any_piece_are_those_of_all_that_bonds_hold_to_it) {
  const Scene scene = ring_with_tail();
  const SolverScene solver(scene);
  const FragmentMasses masses(solver);
  for (std::int64_t id = 0; id < 6; ++id) expect_fragment(scene, solver, masses, id, {0, 1, 2, 3, 4, 5});
  EXPECT_EQ(masses.of(6), nullptr);
}

TEST(FragmentMasses, follow_what_breaks_and_not_what_breaks_in_a_ring) {
  const Scene scene = ring_with_tail();
  const SolverScene solver(scene);
  FragmentMasses masses(solver);
  std::vector<std::int64_t> broken_at(6, kNever);
  EXPECT_FALSE(masses.update(broken_at, 100));
  broken_at[4] = 40;  // the tail, 3-4
  EXPECT_FALSE(masses.update(broken_at, 40)) << "it broke in the step after which it is looked at";
  expect_fragment(scene, solver, masses, 4, {0, 1, 2, 3, 4, 5});
  EXPECT_TRUE(masses.update(broken_at, 41));
  for (const std::int64_t id : {0, 1, 2, 3}) expect_fragment(scene, solver, masses, id, {0, 1, 2, 3});
  for (const std::int64_t id : {4, 5}) expect_fragment(scene, solver, masses, id, {4, 5});
  EXPECT_FALSE(masses.update(broken_at, 1000)) << "known already";
  broken_at[1] = 50;  // 1-2: the ring holds by the other way round
  masses.update(broken_at, 1000);
  for (const std::int64_t id : {0, 1, 2, 3}) expect_fragment(scene, solver, masses, id, {0, 1, 2, 3});
  broken_at[3] = 60;  // 0-3
  broken_at[5] = 60;  // 4-5: both are alone, and move what they are
  EXPECT_TRUE(masses.update(broken_at, 1000));
  for (const std::int64_t id : {0, 1}) expect_fragment(scene, solver, masses, id, {0, 1});
  for (const std::int64_t id : {2, 3}) expect_fragment(scene, solver, masses, id, {2, 3});
  EXPECT_EQ(masses.of(4), nullptr);
  EXPECT_EQ(masses.of(5), nullptr);
}

TEST(FragmentMasses, are_the_same_bits_whatever_broke_together) {
  const Scene scene = ring_with_tail();
  const SolverScene solver(scene);
  FragmentMasses steps(solver), at_once(solver);
  std::vector<std::int64_t> broken_at(6, kNever);
  for (const std::size_t bond : {4, 1, 3}) {
    broken_at[bond] = 10;
    steps.update(broken_at, 11);
  }
  at_once.update(broken_at, 11);  // as a run that is restarted finds them
  for (std::int64_t id = 0; id < 6; ++id) {
    const BondedMass *a = steps.of(id), *b = at_once.of(id);
    ASSERT_EQ(a == nullptr, b == nullptr);
    if (a == nullptr) continue;
    EXPECT_EQ(a->inverse_mass, b->inverse_mass);
    for (int i = 0; i < 3; ++i) {
      EXPECT_EQ(a->centre[i], b->centre[i]);
      for (int j = 0; j < 3; ++j) EXPECT_EQ(a->inverse_inertia[i][j], b->inverse_inertia[i][j]);
    }
  }
}

TEST(FragmentMasses, hold_nothing_that_does_not_move_as_a_whole) {
  for (const bool fixed : {true, false}) {
    Scene scene = ring_with_tail();
    (fixed ? scene.bodies.fixed : scene.bodies.lock_rotation)[5] = 1;
    const SolverScene solver(scene);
    FragmentMasses masses(solver);
    for (std::int64_t id = 0; id < 6; ++id) EXPECT_EQ(masses.of(id), nullptr) << "one of them is held: each counts alone";
    std::vector<std::int64_t> broken_at(6, kNever);
    broken_at[5] = 3;
    EXPECT_TRUE(masses.update(broken_at, 16));
    for (const std::int64_t id : {0, 4}) expect_fragment(scene, solver, masses, id, {0, 1, 2, 3, 4});
    EXPECT_EQ(masses.of(5), nullptr);
  }
}

}  // namespace
}  // namespace scree
