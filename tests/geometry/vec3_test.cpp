#include "core/geometry/vec3.hpp"

#include <gtest/gtest.h>

#include <numbers>

namespace scree {
namespace {

constexpr double kPi = std::numbers::pi;

void expect_near(const Vec3& a, const Vec3& b, double tolerance) { EXPECT_LE(length(a - b), tolerance); }

TEST(Vec3, the_cross_product_is_right_handed) {
  EXPECT_EQ(cross(Vec3{1, 0, 0}, Vec3{0, 1, 0}), (Vec3{0, 0, 1}));
  EXPECT_EQ(cross(Vec3{0, 1, 0}, Vec3{0, 0, 1}), (Vec3{1, 0, 0}));
  EXPECT_EQ(dot(Vec3{1, 2, 3}, Vec3{4, -5, 6}), 12);
  EXPECT_EQ(length(Vec3{2, 3, 6}), 7);
}

TEST(Quaternion, a_quarter_turn_about_z_takes_x_to_y) {
  const Quat q = quaternion_of(Vec3{0, 0, 1}, kPi / 2);
  expect_near(rotate(q, {1, 0, 0}), {0, 1, 0}, 1e-15);
  expect_near(rotate_inverse(q, {0, 1, 0}), {1, 0, 0}, 1e-15);
}

TEST(Quaternion, a_third_of_a_turn_about_the_diagonal_permutes_the_axes) {
  const Quat q{0.5, 0.5, 0.5, 0.5};
  EXPECT_EQ(rotate(q, {1, 2, 3}), (Vec3{3, 1, 2}));
}

TEST(Quaternion, a_product_rotates_by_the_right_factor_first) {
  const Quat about_x = quaternion_of(Vec3{1, 0, 0}, kPi / 2), about_z = quaternion_of(Vec3{0, 0, 1}, kPi / 2);
  // y -> z under x, and z stays under z; the other order would give y -> -x -> -x
  expect_near(rotate(about_z * about_x, {0, 1, 0}), {0, 0, 1}, 1e-15);
  expect_near(rotate(about_x * about_z, {0, 1, 0}), {-1, 0, 0}, 1e-15);
}

TEST(Quaternion, the_rotation_matrix_of_a_quarter_turn_about_x_is_the_textbook_one) {
  const Mat3 m = matrix_of(quaternion_of(Vec3{1, 0, 0}, kPi / 2));
  const double expected[3][3] = {{1, 0, 0}, {0, 0, -1}, {0, 1, 0}};
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) EXPECT_NEAR(m[i][j], expected[i][j], 1e-15);
  }
}

// Half turns make three of the four branches of Shepperd's method the largest in turn.
TEST(Quaternion, a_matrix_gives_back_its_quaternion_in_every_branch) {
  const Quat samples[] = {{1, 0, 0, 0},
                          {0, 1, 0, 0},
                          {0, 0, 1, 0},
                          {0, 0, 0, 1},
                          normalised(Quat{0.9, 0.1, -0.3, 0.2}),
                          normalised(Quat{0.1, 0.9, -0.3, 0.2}),
                          normalised(Quat{0.1, 0.2, -0.9, 0.3}),
                          normalised(Quat{-0.1, 0.3, 0.2, 0.9})};
  for (const Quat& q : samples) {
    const Quat back = quaternion_of(matrix_of(q));
    const double cosine = q.w * back.w + q.x * back.x + q.y * back.y + q.z * back.z;
    EXPECT_NEAR(std::abs(cosine), 1, 1e-15);
    EXPECT_NEAR(norm(back), 1, 1e-15);
  }
}

TEST(Matrix, rotating_by_quaternion_and_by_matrix_agree) {
  const Quat q = normalised(Quat{0.3, -0.5, 0.7, 0.2});
  const Vec3 v{1, -2, 0.5};
  expect_near(matrix_of(q) * v, rotate(q, v), 1e-15);
  expect_near(transpose_times(matrix_of(q), v), rotate_inverse(q, v), 1e-15);
  const Mat3 product = matrix_of(q) * transpose(matrix_of(q));
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) EXPECT_NEAR(product[i][j], i == j ? 1 : 0, 1e-15);
  }
}

}  // namespace
}  // namespace scree
