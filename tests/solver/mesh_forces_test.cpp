// Pairs of meshes side by side in lanes against the general path: the same bits, of bodies, springs and what each pair did, on every
// instruction set.
#include <gtest/gtest.h>
#include <omp.h>

#include "core/distance/triangle_distance.hpp"
#include "solver/pairs/mesh_evaluation.hpp"
#include "tests/solver/lane_bits.hpp"
#include "tests/support/parallel_scenes.hpp"

namespace scree {
namespace {

using namespace test;

/// Rocks of several sizes and two materials, some fixed or locked, that fall onto each other and rub.
Scene falling_rocks(ContactLaw law, double friction, bool periodic, int level) {
  Scene scene = rock_scene(level);
  scene.settings.gravity = {1, 0, -30};
  scene.settings.law = law;
  scene.settings.impact_speed = 2;
  scene.materials = {{"stone", 1000, 2e7, 0.3}, {"light", 400, 1e7, 0.2}};
  if (law == ContactLaw::hertz_mindlin) scene.pairs[0].stiffness = 0;
  scene.pairs[0].friction = friction;
  const MaterialPair first = scene.pairs[0];
  for (const std::int32_t a : {0, 1}) {
    MaterialPair pair = first;
    pair.a = a;
    pair.b = 1;
    pair.friction *= 0.5;
    pair.restitution = a == 0 ? 0.4 : 0.9;
    if (a == 1 && law == ContactLaw::linear) {
      pair.stiffness = 0;
      pair.modulus = 4e6;  // stiffness that goes with size
    }
    scene.pairs.push_back(pair);
  }
  for (MaterialPair& pair : scene.pairs) pair.restitution_speed = 0.5;
  add_box_walls(scene, {-0.005, -0.005, 0}, {0.32, 0.32, 1});
  if (periodic) {
    scene.settings.domain.bounded = true;
    scene.settings.domain.lower = {-0.005, -0.005, 0};
    scene.settings.domain.upper = {0.32, 0.32, 1};
    scene.settings.domain.periodic = {true, true, false};
  }
  fill_lattice(scene, 3, 3, 3, {0, 0, 0.005}, 0.105, {0.4, 0.2, -2});
  BodyTable& b = scene.bodies;
  for (std::size_t i = 0; i < b.size(); ++i) {
    b.material[i] = static_cast<std::int32_t>(i % 3 == 0);
    b.scale[i] = 1 - 0.05 * static_cast<double>(i % 4);
    b.fixed[i] = i % 17 == 5;
    b.lock_rotation[i] = i % 11 == 3;
    if (b.fixed[i]) b.velocity[i] = b.angular_velocity[i] = {};
  }
  return scene;
}

std::string expect_same_bits_of_rocks(const Scene& scene, int steps) {
  EXPECT_NE(SolverScene(scene).lane_laws().kind, LaneLawKind::none);
  return expect_same_bits(scene, steps);
}

class EveryMeshLaw : public testing::TestWithParam<ContactLaw> {};

TEST_P(EveryMeshLaw, has_the_bits_of_the_general_path) {
  for (const double friction : {0.0, 0.5}) {
    for (const bool periodic : {false, true}) {
      SCOPED_TRACE(fmt::format("friction {}, periodic {}", friction, periodic));
      expect_same_bits_of_rocks(falling_rocks(GetParam(), friction, periodic, 0), 2500);
    }
  }
}

TEST_P(EveryMeshLaw, has_the_same_bits_on_every_instruction_set) {
  const Scene scene = falling_rocks(GetParam(), 0.5, false, 1);
  std::vector<std::string> hashes;
  for (const char* name : {"best", "avx512", "avx2", "sse4", "scalar"}) {
    try {
      limit_simd(name);
    } catch (const UsageError&) {
      continue;
    }
    hashes.push_back(expect_same_bits_of_rocks(scene, 1600));
  }
  limit_simd("best");
  for (const std::string& hash : hashes) EXPECT_EQ(hash, hashes[0]);
}

INSTANTIATE_TEST_SUITE_P(MeshForces, EveryMeshLaw,
                         testing::Values(ContactLaw::linear, ContactLaw::hunt_crossley, ContactLaw::hertz_mindlin));

// Features that share a place, whose weights depend on each other, and pairs with more features than lanes take.
TEST(MeshForces, have_the_same_bits_of_fine_meshes_and_of_boxes_that_lie_on_each_other) {
  expect_same_bits_of_rocks(falling_rocks(ContactLaw::linear, 0.5, false, 2), 2000);
  Scene boxes = falling_rocks(ContactLaw::linear, 0.5, false, 0);
  boxes.settings.gravity.z = -10;  // faces that lie on each other carry more than rocks
  for (Shape& shape : boxes.shapes) shape = make_solid(shape.name, grid_box(1, {0.085, 0.09, 0.08}));
  for (Quat& q : boxes.bodies.orientation) q = {};
  expect_same_bits_of_rocks(boxes, 2500);
}

// Faster impacts than the step was made for limit damping, which lanes leave to the general path.
TEST(MeshForces, have_the_same_bits_where_damping_is_limited) {
  for (const ContactLaw law : {ContactLaw::hunt_crossley, ContactLaw::linear}) {
    Scene scene = falling_rocks(law, 0.5, false, 0);
    for (MaterialPair& pair : scene.pairs) {
      pair.restitution = 0.05;
      pair.restitution_speed = 0.02;
    }
    scene.settings.steps_per_contact = 12;
    expect_same_bits_of_rocks(scene, 2500);
  }
}

TEST(MeshForces, leave_to_the_general_path_what_lanes_have_no_formula_for) {
  EXPECT_EQ(SolverScene(necked_heap()).lane_laws().kind, LaneLawKind::none);
  EXPECT_EQ(SolverScene(layered_heap()).lane_laws().kind, LaneLawKind::none);
  Scene scene = falling_rocks(ContactLaw::linear, 0.5, false, 0);
  scene.pairs[0].rolling_friction = 0.1;
  expect_same_bits(scene, 2000);
}

// Two pairs fail in the same step: the first in the order of the list is named, whichever is computed first.
TEST(MeshForces, name_the_first_of_the_pairs_that_make_a_run_invalid) {
  Scene scene = rock_scene(0);
  fill_lattice(scene, 4, 1, 1, {0, 0, 0.1}, 0.2, {});
  for (const std::size_t i : {std::size_t{1}, std::size_t{3}}) scene.bodies.position[i] = scene.bodies.position[i - 1] + Vec3{0.03, 0, 0};
  const int threads = omp_get_max_threads();
  for (const int count : {1, 3}) {
    omp_set_num_threads(count);
    TestRun run(scene);
    try {
      run.start();
      FAIL() << "two pairs of rocks lie in each other";
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find("bodies 0 and 1 intersect"), std::string::npos) << error.what();
    }
  }
  omp_set_num_threads(threads);
}

}  // namespace
}  // namespace scree
