// Packings small enough to count by hand; expected values are exact fractions.
#include "post/statistics/contact_statistics.hpp"

#include <gtest/gtest.h>

#include "tests/post/sample_run.hpp"

namespace scree {
namespace {

/// n free bodies (ids 0..n-1); the wall has id 100.
Frame bodies(std::int64_t n) {
  Frame frame;
  for (std::int64_t i = 0; i < n; ++i) frame.bodies.id.push_back(i);
  return frame;
}
const std::unordered_set<std::int64_t> kWalls{100};

double trace(const Mat3& m) { return m[0].x + m[1].y + m[2].z; }

TEST(ContactStatistics, two_touching_bodies_have_one_neighbour_each) {
  Frame frame = bodies(2);
  test::add_contact(frame, 0, 1, 0, {0, 0, 1}, 3.5, 5e-4);
  const ContactStatistics s = contact_statistics(frame, kWalls);
  EXPECT_EQ(s.particles, 2u);
  EXPECT_EQ(s.coordination, 1);
  EXPECT_EQ(s.rattlers, 2u);                      // one neighbour cannot hold a body
  EXPECT_EQ(s.coordination_without_rattlers, 0);  // nobody is left
  EXPECT_EQ(s.contact_force.mean, 3.5);
  EXPECT_EQ(s.contact_force.median, 3.5);
  EXPECT_EQ(s.max_overlap_ratio, 0.25);
  EXPECT_EQ(s.fabric[2].z, 1);
  EXPECT_EQ(s.fabric[0].x, 0);
  EXPECT_EQ(s.fabric_principal.z, 1);
}

TEST(ContactStatistics, a_chain_of_three_follows_thorntons_formula) {
  Frame frame = bodies(3);
  test::add_contact(frame, 0, 1, 0, {1, 0, 0}, 1);
  test::add_contact(frame, 1, 2, 0, {1, 0, 0}, 1);
  const ContactStatistics s = contact_statistics(frame, kWalls);
  EXPECT_DOUBLE_EQ(s.coordination, 4.0 / 3.0);  // 2 * 2 / 3
  EXPECT_EQ(s.rattlers, 2u);
  EXPECT_EQ(s.coordination_without_rattlers, 2);  // (2 * 2 - 2) / (3 - 2)
}

TEST(ContactStatistics, a_wall_is_a_neighbour_but_no_particle) {
  Frame frame = bodies(2);
  test::add_contact(frame, 0, 100, 0, {0, 0, 1}, 2);
  test::add_contact(frame, 0, 1, 0, {0, 0, -1}, 1);
  const ContactStatistics s = contact_statistics(frame, kWalls);
  EXPECT_EQ(s.particles, 2u);
  EXPECT_EQ(s.pairs_of_particles, 1u);
  EXPECT_EQ(s.pairs_with_walls, 1u);
  EXPECT_DOUBLE_EQ(s.coordination, 1.5);  // (2 * 1 + 1) / 2
}

TEST(ContactStatistics, several_points_of_a_pair_are_one_neighbour) {
  Frame frame = bodies(2);
  for (std::int64_t feature = 0; feature < 4; ++feature) test::add_contact(frame, 0, 1, feature, {0, 1, 0}, 2);
  const ContactStatistics s = contact_statistics(frame, kWalls);
  EXPECT_EQ(s.coordination, 1);
  EXPECT_EQ(s.contacts_per_particle, 4);
  EXPECT_EQ(s.pair_force.mean, 8);  // four parallel forces of 2 N
  EXPECT_EQ(s.contact_force.mean, 2);
}

TEST(ContactStatistics, a_contact_that_does_not_press_does_not_count) {
  Frame frame = bodies(2);
  test::add_contact(frame, 0, 1, 0, {0, 1, 0}, 0);
  const ContactStatistics s = contact_statistics(frame, kWalls);
  EXPECT_EQ(s.contacts, 0u);
  EXPECT_EQ(s.coordination, 0);
  EXPECT_EQ(trace(s.fabric), 0);
}

TEST(ContactStatistics, normals_along_three_axes_are_isotropic) {
  Frame frame = bodies(4);
  test::add_contact(frame, 0, 1, 0, {1, 0, 0}, 1);
  test::add_contact(frame, 0, 2, 0, {0, -1, 0}, 5);
  test::add_contact(frame, 0, 3, 0, {0, 0, 1}, 9);
  const ContactStatistics s = contact_statistics(frame, kWalls);
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) EXPECT_DOUBLE_EQ(s.fabric[i][j], i == j ? 1.0 / 3.0 : 0.0);
  }
}

TEST(ContactStatistics, the_fabric_tensor_has_trace_one_for_any_unit_normals) {
  Frame frame = bodies(50);
  for (std::int64_t i = 0; i + 1 < 50; ++i) {
    const double a = 1.7 * static_cast<double>(i), b = 0.3 * static_cast<double>(i);
    test::add_contact(frame, i, i + 1, 0, {std::cos(a) * std::cos(b), std::sin(a) * std::cos(b), std::sin(b)}, 1);
  }
  const ContactStatistics s = contact_statistics(frame, kWalls);
  EXPECT_NEAR(trace(s.fabric), 1, 1e-14);
  EXPECT_NEAR(s.fabric_principal.x + s.fabric_principal.y + s.fabric_principal.z, 1, 1e-14);
}

TEST(ContactStatistics, wall_contacts_enter_only_the_fabric_with_walls) {
  Frame frame = bodies(2);
  test::add_contact(frame, 0, 1, 0, {1, 0, 0}, 1);
  test::add_contact(frame, 0, 100, 0, {0, 0, 1}, 1);
  const ContactStatistics s = contact_statistics(frame, kWalls);
  EXPECT_EQ(s.fabric[0].x, 1);
  EXPECT_EQ(s.fabric_with_walls[0].x, 0.5);
  EXPECT_EQ(s.fabric_with_walls[2].z, 0.5);
}

TEST(ContactStatistics, quantiles_of_one_to_five_are_the_textbooks) {
  const Distribution d = distribution_of({5, 3, 1, 4, 2});
  EXPECT_EQ(d.mean, 3);
  EXPECT_EQ(d.smallest, 1);
  EXPECT_EQ(d.q25, 2);
  EXPECT_EQ(d.median, 3);
  EXPECT_EQ(d.q75, 4);
  EXPECT_DOUBLE_EQ(d.q95, 4.8);
  EXPECT_EQ(d.largest, 5);
}

TEST(ContactStatistics, an_empty_frame_has_zeros_and_no_nan) {
  const ContactStatistics s = contact_statistics(bodies(0), kWalls);
  EXPECT_EQ(s.coordination, 0);
  EXPECT_EQ(s.contact_force.mean, 0);
  EXPECT_EQ(json_of(s).dump().find("null"), std::string::npos);  // JSON has no NaN: it would be null
}

}  // namespace
}  // namespace scree
