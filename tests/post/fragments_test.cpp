// Fragments by connected bonds.
#include <gtest/gtest.h>

#include "post/statistics/fragments.hpp"

namespace scree {
namespace {

/// Five balls of one size, bonded in two groups: 0-1-2 and 3-4.
Scene two_groups() {
  Scene scene;
  scene.shapes = {make_sphere("ball", 0.01)};
  scene.materials = {{"m", 1000, 0, 0}};
  for (std::int64_t id = 0; id < 5; ++id) {
    BodyRow row;
    row.id = id;
    scene.bodies.add(row);
  }
  const auto bond = [&](std::int64_t a, std::int64_t b) {
    Bond between;
    between.a = a;
    between.b = b;
    scene.bonds.push_back(between);
  };
  bond(0, 1);
  bond(1, 2);
  bond(3, 4);
  return scene;
}

FrameBodies bodies_of(const Scene& scene) {
  FrameBodies bodies;
  bodies.id = scene.bodies.id;
  bodies.shape = scene.bodies.shape;
  bodies.material = scene.bodies.material;
  bodies.scale = scene.bodies.scale;
  return bodies;
}

TEST(Fragments, bodies_that_bonds_hold_are_one_fragment) {
  const Scene scene = two_groups();
  const std::vector<Fragment> whole = fragments_of(scene, bodies_of(scene), {0, 1, 2}),
                              split = fragments_of(scene, bodies_of(scene), {1, 2});
  ASSERT_EQ(whole.size(), 2u);
  EXPECT_EQ(whole[0].pieces, 3);
  EXPECT_EQ(whole[1].parent, 3);
  ASSERT_EQ(split.size(), 3u);
  EXPECT_EQ(split[0].id, 1);  // the larger of the first parent
  EXPECT_EQ(split[0].parent, 0);
  EXPECT_EQ(split[0].pieces, 2);
  EXPECT_EQ(split[1].id, 0);
  EXPECT_NEAR(split[0].mass, 2 * split[1].mass, 1e-15);
  EXPECT_NEAR(split[1].diameter, 0.02, 1e-15);
  const FragmentNumbers numbers = numbers_of(split, whole);
  EXPECT_EQ(numbers.fragments, 3u);
  EXPECT_NEAR(numbers.largest_share, 4.0 / 5, 1e-14);
  EXPECT_EQ(numbers.t10, 0);
  EXPECT_NEAR(numbers_of(whole, whole).largest_share, 1, 1e-14);
  EXPECT_NEAR(numbers.present, 1, 1e-14);
  // the largest piece has left: it is none of those that are there, and the share says so
  const FragmentNumbers rest = numbers_of({split[1], split[2]}, whole);
  EXPECT_NEAR(rest.present, 3.0 / 5, 1e-14);
  EXPECT_NEAR(rest.largest_share, 3.0 / 5, 1e-14);
}

TEST(Fragments, what_is_finer_than_a_tenth_of_its_parent_counts_in_t10) {
  Scene scene = two_groups();
  scene.bodies.scale[0] = 0.05;  // a diameter of 1 mm beside two of 20 mm
  const std::vector<Fragment> whole = fragments_of(scene, bodies_of(scene), {0, 1, 2}),
                              split = fragments_of(scene, bodies_of(scene), {1, 2});
  const double small = 0.05 * 0.05 * 0.05;
  EXPECT_NEAR(numbers_of(split, whole).t10, small / (4 + small), 1e-15);
}

TEST(Fragments, a_body_that_left_is_in_none) {
  const Scene scene = two_groups();
  FrameBodies bodies = bodies_of(scene);
  take_rows(bodies, {});
  EXPECT_TRUE(fragments_of(scene, bodies, {}).empty());
}

}  // namespace
}  // namespace scree
