// Rows G1-G4 and G6 of the validation plan: closed forms and tables of published polyhedra.
#include "core/geometry/mass_properties.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "tests/support/shapes.hpp"

namespace scree {
namespace {

constexpr double kPi = std::numbers::pi;

TriangleMesh moved(TriangleMesh mesh, const Quat& rotation, const Vec3& offset) {
  for (Vec3& p : mesh.vertices) p = rotate(rotation, p) + offset;
  return mesh;
}

TriangleMesh finer(TriangleMesh mesh, int times) {
  for (int i = 0; i < times; ++i) mesh = test::subdivide(mesh, false);
  return mesh;
}

/// Largest difference of two tensors, relative to the largest entry of the second.
double relative_error(const Mat3& found, const Mat3& expected) {
  double error = 0, largest = 0;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      error = std::max(error, std::abs(found[i][j] - expected[i][j]));
      largest = std::max(largest, std::abs(expected[i][j]));
    }
  }
  return error / largest;
}

Mat3 diagonal(const Vec3& d) { return {{Vec3{d.x, 0, 0}, Vec3{0, d.y, 0}, Vec3{0, 0, d.z}}}; }
Mat3 turned(const Mat3& tensor, const Quat& q) { return matrix_of(q) * tensor * transpose(matrix_of(q)); }

// G1: box 0.4 x 0.2 x 0.1 at density 1000: m = 8, I = diag(1/30, 0.34/3, 0.4/3).
const Vec3 kBox{0.4, 0.2, 0.1};
const Vec3 kBoxMoments{1.0 / 30, 0.34 / 3, 0.4 / 3};
const Quat kTurn = normalised(Quat{0.3, -0.5, 0.7, 0.2});

TEST(MassProperties, a_box_of_12_triangles_matches_the_closed_form_to_1e_13) {
  const MassProperties mass = mass_properties(box_mesh(kBox));
  EXPECT_NEAR(1000 * mass.volume, 8, 8e-13);
  EXPECT_LE(length(mass.centre), 1e-14);
  EXPECT_LE(relative_error(mass.inertia, diagonal((1.0 / 1000) * kBoxMoments)), 1e-13);
}

TEST(MassProperties, a_box_of_3072_triangles_matches_the_closed_form_to_1e_13) {
  const TriangleMesh mesh = finer(box_mesh(kBox), 4);
  ASSERT_EQ(mesh.triangle_count(), 12 * 16 * 16);
  const MassProperties mass = mass_properties(mesh);
  EXPECT_NEAR(1000 * mass.volume, 8, 8e-13);
  EXPECT_LE(relative_error(mass.inertia, diagonal((1.0 / 1000) * kBoxMoments)), 1e-13);
}

TEST(MassProperties, a_turned_box_a_kilometre_away_loses_no_more_than_1e_10) {
  const Vec3 offset{1e3, -2e3, 5e2};
  for (int times : {0, 4}) {
    const MassProperties mass = mass_properties(moved(finer(box_mesh(kBox), times), kTurn, offset));
    EXPECT_NEAR(1000 * mass.volume, 8, 8e-10);
    EXPECT_LE(length(mass.centre - offset), 1e-10 * length(offset));
    EXPECT_LE(relative_error(mass.inertia, turned(diagonal((1.0 / 1000) * kBoxMoments), kTurn)), 1e-10);
  }
}

TEST(MassProperties, a_regular_tetrahedron_has_volume_a3_over_6_root_2_and_moments_m_a2_over_20) {
  TriangleMesh mesh;
  mesh.vertices = {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
  mesh.triangles = {{0, 1, 2}, {0, 3, 1}, {0, 2, 3}, {1, 3, 2}};
  const double a = std::sqrt(8.0);
  const MassProperties mass = mass_properties(mesh);
  const double volume = a * a * a / (6 * std::sqrt(2.0));
  EXPECT_NEAR(mass.volume, volume, 1e-13 * volume);
  const double moment = volume * a * a / 20;
  EXPECT_LE(relative_error(mass.inertia, diagonal({moment, moment, moment})), 1e-13);
}

TEST(MassProperties, icospheres_follow_the_table_of_volume_and_inertia) {
  const double volume_ratio[] = {.60546138, .87345320, .96616075, .99139384, .99783917, .99945921};
  const double inertia_ratio[] = {.72360680, .91447931, .97736101, .99425747, .99855913, .99963945};
  for (int level = 0; level <= 5; ++level) {
    const MassProperties mass = mass_properties(test::icosphere(level));
    EXPECT_NEAR(mass.volume / (4 * kPi / 3), volume_ratio[level], 1e-7) << "level " << level;
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(mass.inertia[i][i] / (0.4 * mass.volume), inertia_ratio[level], 1e-7) << "level " << level;
  }
}

TEST(MassProperties, the_volume_of_icospheres_converges_with_order_2) {
  double error[2];
  for (int i = 0; i < 2; ++i) error[i] = 1 - mass_properties(test::icosphere(4 + i)).volume / (4 * kPi / 3);
  EXPECT_NEAR(std::log2(error[0] / error[1]), 2, 0.01);
}

TEST(MassProperties, a_torus_of_64_by_32_follows_the_table) {
  constexpr int n = 64, m = 32;
  constexpr double R = 1, r = 0.25;
  TriangleMesh mesh;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < m; ++j) {
      const double u = 2 * kPi * i / n, v = 2 * kPi * j / m;
      mesh.vertices.push_back({(R + r * std::cos(v)) * std::cos(u), (R + r * std::cos(v)) * std::sin(u), r * std::sin(v)});
    }
  }
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < m; ++j) {
      const int a = i * m + j, b = (i + 1) % n * m + j, c = (i + 1) % n * m + (j + 1) % m, d = i * m + (j + 1) % m;
      mesh.triangles.push_back({a, b, c});
      mesh.triangles.push_back({a, c, d});
    }
  }
  const MassProperties mass = mass_properties(mesh);
  EXPECT_NEAR(mass.volume / (2 * kPi * kPi * R * r * r), .99199154, 1e-7);
  EXPECT_NEAR(mass.inertia[2][2] / mass.volume / (R * R + 0.75 * r * r), .99810858, 1e-7);
  EXPECT_NEAR(mass.inertia[0][0] / mass.volume / (0.5 * R * R + 0.625 * r * r), .99797776, 1e-7);
}

TEST(MassProperties, an_inward_mesh_has_the_negative_volume) {
  TriangleMesh mesh = box_mesh(kBox);
  for (Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
  EXPECT_NEAR(mass_properties(mesh).volume, -0.008, 1e-15);
}

// G6
TEST(MassProperties, the_principal_frame_of_a_turned_box_is_sorted_right_handed_and_gives_back_the_tensor) {
  const MassProperties mass = mass_properties(moved(box_mesh(kBox), kTurn, {}));
  const Vec3& p = mass.principal_moments;
  EXPECT_LT(p.x, p.y);
  EXPECT_LT(p.y, p.z);
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(1000 * p[i], kBoxMoments[i], 1e-12 * kBoxMoments.z);
  EXPECT_NEAR(norm(mass.body_from_principal), 1, 1e-14);  // a unit quaternion is right-handed by itself
  EXPECT_LE(relative_error(turned(diagonal(p), mass.body_from_principal), mass.inertia), 1e-12);
}

TEST(MassProperties, a_box_with_sorted_sides_keeps_its_axes_and_an_unsorted_one_is_turned) {
  EXPECT_EQ(mass_properties(box_mesh(kBox)).body_from_principal, Quat{});
  const MassProperties mass = mass_properties(box_mesh({0.1, 0.2, 0.4}));
  EXPECT_LT(mass.principal_moments.x, mass.principal_moments.y);
  EXPECT_LT(mass.principal_moments.y, mass.principal_moments.z);
  EXPECT_LE(relative_error(turned(diagonal(mass.principal_moments), mass.body_from_principal), mass.inertia), 1e-12);
}

TEST(MassProperties, rounding_does_not_choose_the_axes_of_equal_moments) {
  // A box with a square cross-section, along each axis and askew: what another triangulation's rounding adds to its tensor.
  for (const Vec3 sides :
       {Vec3{0.4, 0.1, 0.1}, Vec3{0.1, 0.4, 0.1}, Vec3{0.1, 0.1, 0.4}, Vec3{0.1, 0.4, 0.4}, Vec3{0.4, 0.1, 0.4}, Vec3{0.2, 0.2, 0.2}}) {
    for (const Quat& turn : {Quat{}, kTurn}) {
      const MassProperties drawn = mass_properties(moved(box_mesh(sides), turn, {}));
      const double noise = 1e-15 * drawn.principal_moments.z;
      for (int i = 0; i < 27; ++i) {
        MassProperties other = drawn;
        const Vec3 by = noise * Vec3{i % 3 - 1.0, i / 3 % 3 - 1.0, i / 9 - 1.0};
        other.inertia[0][1] = other.inertia[1][0] += by.x;
        other.inertia[0][2] = other.inertia[2][0] += by.y;
        other.inertia[1][2] = other.inertia[2][1] += by.z;
        other.inertia[0][0] += by.y;
        other.inertia[1][1] += by.z;
        find_principal_frame(other);
        const Quat difference = conjugate(drawn.body_from_principal) * other.body_from_principal;
        EXPECT_LE(std::hypot(difference.x, difference.y, difference.z), 1e-13) << i;
        EXPECT_LE(relative_error(turned(diagonal(other.principal_moments), other.body_from_principal), drawn.inertia), 1e-14);
      }
    }
  }
}

TEST(MassProperties, an_analytic_ball_has_two_fifths_m_r_squared) {
  const MassProperties mass = sphere_mass_properties(0.5);
  EXPECT_NEAR(mass.volume, kPi / 6, 1e-15);
  EXPECT_NEAR(mass.principal_moments.x, 0.4 * mass.volume * 0.25, 1e-16);
}

TEST(TriangleMesh, a_box_has_its_area_extent_and_bounding_radius) {
  const TriangleMesh mesh = box_mesh({3, 4, 12});
  EXPECT_DOUBLE_EQ(surface_area(mesh), 2 * (12 + 48 + 36));
  EXPECT_EQ(bounding_box(mesh).extent(), (Vec3{3, 4, 12}));
  EXPECT_DOUBLE_EQ(bounding_radius(mesh), 6.5);
}

}  // namespace
}  // namespace scree
