// Descriptors, hulls and generated shapes against closed forms.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <tuple>

#include "core/base/error.hpp"
#include "core/geometry/blades.hpp"
#include "mesher/check/mesh_check.hpp"
#include "mesher/edit/convex_hull.hpp"
#include "mesher/edit/descriptors.hpp"
#include "mesher/edit/sieve_opening.hpp"
#include "mesher/make/primitives.hpp"
#include "mesher/make/random_rock.hpp"
#include "mesher/make/sections.hpp"
#include "tests/support/shapes.hpp"

namespace scree {
namespace {

constexpr double kPi = std::numbers::pi;

TEST(Descriptors, of_a_box_follow_from_its_sides) {
  const Descriptors d = describe(box_mesh({4, 2, 1}));
  EXPECT_NEAR(d.volume, 8, 1e-13);
  EXPECT_NEAR(d.area, 28, 1e-13);
  EXPECT_NEAR(d.volume_diameter, std::cbrt(48 / kPi), 1e-13);
  EXPECT_NEAR(d.area_diameter, std::sqrt(28 / kPi), 1e-13);
  EXPECT_NEAR(d.sphericity, std::cbrt(kPi * 48 * 48) / 28, 1e-13);
  EXPECT_NEAR(d.convexity, 1, 1e-12);
  EXPECT_NEAR(d.elongation, 0.5, 1e-12);
  EXPECT_NEAR(d.flatness, 0.5, 1e-12);
  EXPECT_NEAR(d.angularity, 0.5, 1e-12);
  EXPECT_NEAR(d.principal_moments.x, 8.0 / 12 * (4 + 1), 1e-12);
  EXPECT_NEAR(d.principal_moments.z, 8.0 / 12 * (16 + 4), 1e-12);
}

TEST(Descriptors, do_not_change_with_place_scale_turn_or_the_meshing_of_faces) {
  TriangleMesh mesh = test::grid_box(5, {4, 2, 1});
  const Quat q = normalised(Quat{0.7, 0.2, -0.5, 0.4});
  for (Vec3& p : mesh.vertices) p = 1000 * rotate(q, p) + Vec3{1e3, -2e3, 5e2};
  const Descriptors d = describe(mesh);
  EXPECT_NEAR(d.sphericity, std::cbrt(kPi * 48 * 48) / 28, 1e-10);
  EXPECT_NEAR(d.convexity, 1, 1e-9);
  EXPECT_NEAR(d.elongation, 0.5, 1e-9);
  EXPECT_NEAR(d.flatness, 0.5, 1e-9);
  EXPECT_NEAR(d.angularity, 0.5, 1e-9);
}

TEST(Descriptors, of_a_tetrahedron_follow_from_its_dihedral_angle) {
  const Descriptors d = describe(platonic_solid("tetrahedron"));
  EXPECT_NEAR(d.volume, 1 / std::sqrt(72.0), 1e-14);
  EXPECT_NEAR(d.area, std::sqrt(3.0), 1e-14);
  EXPECT_NEAR(d.angularity, 1 - std::acos(1.0 / 3) / kPi, 1e-13);
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(d.principal_moments[i], d.volume / 20, 1e-14);  // m a^2 / 20
}

TEST(Descriptors, of_two_boxes_joined_as_an_l_have_the_convexity_of_the_l) {
  // unit squares at (0,0), (1,0), (0,1), one high: volume 3, hull 3.5
  TriangleMesh mesh;
  const double outline[6][2] = {{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}};
  for (double z : {0.0, 1.0}) {
    for (const auto& p : outline) mesh.vertices.push_back({p[0], p[1], z});
  }
  for (const Triangle& t : {Triangle{0, 1, 2}, Triangle{0, 2, 3}, Triangle{0, 3, 4}, Triangle{0, 4, 5}}) {
    mesh.triangles.push_back({t[0], t[2], t[1]});
    mesh.triangles.push_back({t[0] + 6, t[1] + 6, t[2] + 6});
  }
  for (std::int32_t i = 0; i < 6; ++i) {
    const std::int32_t j = (i + 1) % 6;
    mesh.triangles.push_back({i, j, j + 6});
    mesh.triangles.push_back({i, j + 6, i + 6});
  }
  ASSERT_TRUE(check_mesh(mesh).is_solid());
  const Descriptors d = describe(mesh);
  EXPECT_NEAR(d.volume, 3, 1e-13);
  EXPECT_NEAR(d.hull_volume, 3.5, 1e-12);
  EXPECT_NEAR(d.convexity, 6.0 / 7, 1e-12);
}

TEST(Descriptors, of_a_fine_sphere_tend_to_one_and_zero) {
  const Descriptors d = describe(test::icosphere(5));
  EXPECT_NEAR(d.sphericity, 1, 2e-3);
  EXPECT_NEAR(d.convexity, 1, 1e-12);
  EXPECT_NEAR(d.elongation, 1, 2e-3);
  EXPECT_LT(d.angularity, 0.02);
}

// ---- sieves

/// Points of an ellipsoid, so many that widths are exact to 3e-4.
std::vector<Vec3> points_of_ellipsoid(const Vec3& half_axes, const Quat& turned) {
  std::vector<Vec3> points = test::icosphere(5).vertices;
  for (Vec3& p : points) p = rotate(turned, Vec3{p.x * half_axes.x, p.y * half_axes.y, p.z * half_axes.z});
  return points;
}

TEST(SieveOpening, of_ellipsoids_is_the_diagonal_of_their_middle_and_shortest_axes) {
  const Quat turned = normalised(Quat{0.3, -0.5, 0.7, 0.2});
  for (const Vec3& h : {Vec3{1, 1, 1}, Vec3{3, 1, 1}, Vec3{2, 1.5, 0.4}, Vec3{1, 1, 0.2}}) {
    const double closed = std::sqrt(2 * (h.y * h.y + h.z * h.z)), found = sieve_opening(points_of_ellipsoid(h, turned));
    EXPECT_NEAR(found / closed, 1, 1e-3) << h.x << " " << h.y << " " << h.z;
  }
}

TEST(SieveOpening, of_a_tetrahedron_is_the_published_one) {
  // a regular tetrahedron passes a square hole if and only if its diagonal is at least the edge (Itoh, Tanoue and Zamfirescu 2006)
  TriangleMesh mesh = platonic_solid("tetrahedron");
  for (Vec3& p : mesh.vertices) p = rotate(normalised(Quat{0.9, 0.1, 0.3, -0.2}), p) + Vec3{3, 2, 1};
  EXPECT_NEAR(sieve_opening(mesh.vertices), std::sqrt(0.5), 1e-6);
}

TEST(SieveOpening, of_boxes_is_their_middle_side_or_the_diagonal_passage_of_a_plate) {
  const auto opening = [](const Vec3& sides) {
    TriangleMesh mesh = box_mesh(sides);
    for (Vec3& p : mesh.vertices) p = rotate(normalised(Quat{0.4, 0.8, -0.1, 0.3}), p);
    return sieve_opening(mesh.vertices);
  };
  EXPECT_NEAR(opening({1, 1, 1}), 1, 1e-6);
  EXPECT_NEAR(opening({4, 2, 1}), 2, 2e-6);
  EXPECT_NEAR(opening({4, 2, 0.5}), 2.5 / std::sqrt(2.0), 2e-6);  // across the corners of the opening: thinner than .414 of the middle side
  EXPECT_NEAR(opening({3, 2, 0.1}), 2.1 / std::sqrt(2.0), 2e-6);
}

TEST(SieveOpening, no_pair_of_directions_of_a_fine_grid_is_better) {
  for (const std::uint64_t seed : {1u, 2u, 3u}) {
    RockForm form;
    form.seed = seed;
    const std::vector<Vec3> corners = convex_hull(random_rock(form).vertices).vertices;
    const double found = sieve_opening(corners);
    double least = 1e300;
    const auto width = [&](const Vec3& u) {
      double low = 1e300, high = -1e300;
      for (const Vec3& p : corners) low = std::min(low, dot(p, u)), high = std::max(high, dot(p, u));
      return high - low;
    };
    constexpr int kGrid = 40;
    for (int i = 0; i < kGrid; ++i) {
      for (int j = 0; j < 2 * kGrid; ++j) {
        const double polar = 0.5 * kPi * (i + 0.5) / kGrid, azimuth = kPi * j / kGrid;
        const Vec3 n{std::sin(polar) * std::cos(azimuth), std::sin(polar) * std::sin(azimuth), std::cos(polar)};
        const Vec3 e{std::cos(polar) * std::cos(azimuth), std::cos(polar) * std::sin(azimuth), -std::sin(polar)}, f = cross(n, e);
        for (int k = 0; k < kGrid; ++k) {
          const double a = 0.5 * kPi * k / kGrid;
          least = std::min(least, std::max(width(std::cos(a) * e + std::sin(a) * f), width(std::cos(a) * f - std::sin(a) * e)));
        }
      }
    }
    EXPECT_LE(found, least * (1 + 1e-12));
    EXPECT_GT(found, 0.97 * least);  // and it is one of its neighbours, not nonsense
  }
}

TEST(ConvexHull, of_a_cube_with_points_inside_and_on_its_faces_is_the_cube) {
  std::vector<Vec3> points = test::grid_box(6, {1, 2, 3}).vertices;
  for (int i = 0; i < 200; ++i) points.push_back({0.4 * std::sin(i), 0.9 * std::sin(3.1 * i), 1.4 * std::cos(7.7 * i)});
  const TriangleMesh hull = convex_hull(points);
  const MeshCheck check = check_mesh(hull);
  EXPECT_TRUE(check.is_solid());
  EXPECT_NEAR(check.mass.volume, 6, 1e-9);
}

TEST(ConvexHull, of_points_on_a_sphere_holds_all_of_them) {
  const TriangleMesh ball = test::icosphere(4);
  const TriangleMesh hull = convex_hull(ball.vertices);
  EXPECT_EQ(hull.vertex_count(), ball.vertex_count());
  EXPECT_EQ(hull.triangle_count(), ball.triangle_count());
  EXPECT_TRUE(check_mesh(hull).is_solid());
}

TEST(ConvexHull, of_a_turned_box_with_points_on_its_faces_has_its_vertices_alone) {
  std::vector<Vec3> points = test::grid_box(6, {1, 2, 3}).vertices;
  for (Vec3& p : points) p = rotate(quaternion_of(Vec3{0.36, 0.48, 0.8}, 0.7), p);
  const TriangleMesh hull = convex_hull(points);
  EXPECT_EQ(hull.vertex_count(), 8);
  EXPECT_EQ(hull.triangle_count(), 12);
  EXPECT_NEAR(check_mesh(hull).mass.volume, 6, 1e-12);
}

TEST(ConvexHull, of_stones_cut_again_and_again_is_solid_and_convex) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    RockForm form;
    form.seed = seed;
    const TriangleMesh stone = crushed_stone(form), hull = convex_hull(stone.vertices);
    EXPECT_TRUE(check_mesh(hull).is_solid()) << seed;
    EXPECT_NEAR(check_mesh(hull).mass.volume, check_mesh(stone).mass.volume, 1e-9) << seed;
    for (std::int32_t t = 0; t < hull.triangle_count(); ++t) {
      const Vec3 n = normalised(cross(hull.corner(t, 1) - hull.corner(t, 0), hull.corner(t, 2) - hull.corner(t, 0)));
      for (const Vec3& p : hull.vertices) ASSERT_LT(dot(n, p - hull.corner(t, 0)), 1e-9) << seed;
    }
  }
}

TEST(ConvexHull, of_points_in_a_plane_is_empty) {
  EXPECT_TRUE(convex_hull({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {0.3, 0.4, 0}}).triangles.empty());
  EXPECT_TRUE(convex_hull(std::vector<Vec3>(10)).triangles.empty());
}

TEST(Primitives, platonic_solids_have_their_volumes_and_faces) {
  const double g = (1 + std::sqrt(5.0)) / 2;
  const struct {
    const char* name;
    double volume;
    int corners;
  } solids[] = {{"tetrahedron", 1 / std::sqrt(72.0), 4},
                {"cube", 1, 8},
                {"octahedron", std::sqrt(2.0) / 3, 6},
                {"dodecahedron", (15 + 7 * std::sqrt(5.0)) / 4, 20},
                {"icosahedron", 5 * g * g / 6, 12}};
  for (const auto& solid : solids) {
    const MeshCheck check = check_mesh(platonic_solid(solid.name));
    EXPECT_TRUE(check.is_solid()) << solid.name;
    EXPECT_NEAR(check.mass.volume, solid.volume, 1e-12 * solid.volume) << solid.name;
    EXPECT_EQ(check.vertex_count, solid.corners) << solid.name;
    for (int i = 0; i < 3; ++i) {
      EXPECT_NEAR(check.mass.principal_moments[i], check.mass.principal_moments.x, 1e-12) << solid.name;
    }
  }
}

TEST(Primitives, a_torus_has_the_moments_of_its_polygons) {
  // ratios at 64 x 32 from VALIDATION G4 of the design papers
  const MassProperties mass = mass_properties(torus(1, 0.25, 64, 32));
  EXPECT_NEAR(mass.volume / (2 * kPi * kPi * 0.0625), 0.99199154, 1e-7);
  EXPECT_NEAR(mass.inertia[2].z / mass.volume / (1 + 0.75 * 0.0625), 0.99810858, 1e-7);
  EXPECT_NEAR(mass.inertia[0].x / mass.volume / (0.5 + 0.625 * 0.0625), 0.99797776, 1e-7);
}

TEST(Primitives, icospheres_have_the_published_volumes_and_moments) {
  // VALIDATION G3: inscribed in the unit sphere, levels 0 to 5
  const double volume[] = {.60546138, .87345320, .96616075, .99139384, .99783917, .99945921};
  const double moment[] = {.72360680, .91447931, .97736101, .99425747, .99855913, .99963945};
  for (int level = 0; level < 6; ++level) {
    const MassProperties mass = mass_properties(icosphere(level));
    EXPECT_NEAR(mass.volume / (4 * kPi / 3), volume[level], 1e-8) << level;
    EXPECT_NEAR(mass.inertia[0].x / (0.4 * mass.volume), moment[level], 1e-8) << level;
  }
}

TEST(Primitives, capsule_cone_and_ellipsoid_tend_to_their_volumes) {
  const auto expect_volume = [](const TriangleMesh& mesh, double volume, double tolerance) {
    const MeshCheck check = check_mesh(mesh);
    EXPECT_TRUE(check.is_solid());
    EXPECT_NEAR(check.mass.volume / volume, 1, tolerance);
    EXPECT_LE(check.mass.volume, volume * (1 + 1e-12));
  };
  expect_volume(capsule(1, 2, 128), kPi * (2 + 4.0 / 3), 2e-3);
  expect_volume(capsule(1, 0, 128), kPi * 4.0 / 3, 2e-3);
  expect_volume(cone(1, 0, 3, 128), kPi, 1e-3);
  expect_volume(cone(2, 1, 3, 128), kPi * 7, 1e-3);
  expect_volume(ellipsoid({3, 2, 1}, 4), 8 * kPi, 3e-3);
  expect_volume(superellipsoid({3, 2, 1}, 1, 1, 4), 8 * kPi, 3e-3);
  // (cos^e, sin^e) with exponents 0.5: V = 2 a b c e n B(n/2 + 1, n) B(e/2, e/2) (Barr 1981)
  const double e = 0.5, n = 0.5;
  expect_volume(superellipsoid({1, 1, 1}, e, n, 5), 2 * e * n * std::beta(n / 2 + 1, n) * std::beta(e / 2, e / 2), 6e-3);
}

/// Of a regular polygon with corners on a circle of radius 1.
double area_of_polygon(int corners) { return 0.5 * corners * std::sin(2 * kPi / corners); }

TEST(Primitives, tablets_have_the_volumes_of_their_caps_and_their_band) {
  // flat faces with a bevel: a prism between two frustums, exact for the polygon
  MeshCheck check = check_mesh(tablet(5, 3, 1, 2, 24, 0));
  EXPECT_TRUE(check.is_solid());
  const double frustums = 2 * (25 + 5 * 3 + 9) / 3.0;  // 2 h (R^2 + R r + r^2) / 3, h = 1
  EXPECT_NEAR(check.mass.volume, area_of_polygon(24) * (3 * 25 + frustums), 1e-11);
  // round caps: the error falls with the square of the edges, to those of a ball where the caps are half balls
  for (const double cup : {0.5, 2.0, 5.0}) {
    const double volume = kPi * 25 * 3 + kPi * cup * (3 * 25 + cup * cup) / 3;
    double error[2];
    for (int k = 0; k < 2; ++k) {
      const int n = k == 0 ? 32 : 64;
      check = check_mesh(tablet(5, 3, cup, 0, n, n / 4));
      EXPECT_TRUE(check.is_solid());
      error[k] = 1 - check.mass.volume / volume;
      EXPECT_GT(error[k], 0) << "vertices lie on the tablet";
    }
    EXPECT_LT(error[1], 1.05 * 4 * kPi * kPi / (64 * 64) / 3) << cup << ": of a ball, twice what a polygon of 64 corners lacks";
    EXPECT_NEAR(error[0] / error[1], 4, 0.1) << cup;
  }
}

TEST(Extruded, cylinders_with_holes_have_the_volume_of_their_polygons) {
  struct Form {
    Drilled disc;
    int sectors, hole_sectors;
  };
  for (const Form& f :
       {Form{{5, 2, 0, 0, 0}, 16, 0}, Form{{5, 0, 2, 1, 2.5}, 16, 12}, Form{{5, 0, 3, 1.2, 2.6}, 24, 9}, Form{{5, 1, 4, 0.9, 3}, 32, 16},
        Form{{5, 1.2, 6, 0.8, 3.2}, 36, 8}, Form{{5, 0, 19, 0.3, 4}, 38, 8}, Form{{5, 0, 5, 1.4, 2.5}, 10, 40}}) {
    SCOPED_TRACE(fmt::format("{} holes, inner {}", f.disc.holes, f.disc.inner));
    ASSERT_STREQ(fault_of(f.disc), "");
    const TriangleMesh mesh = extruded(drilled(f.disc, f.sectors, f.hole_sectors), 7);
    const MeshCheck check = check_mesh(mesh);
    EXPECT_TRUE(check.is_solid());
    const auto area = [](double r, int n) { return n > 0 ? r * r * area_of_polygon(n) : 0.0; };
    const double expected =
        7 * (area(f.disc.radius, f.sectors) - area(f.disc.inner, f.sectors) - f.disc.holes * area(f.disc.hole_radius, f.hole_sectors));
    EXPECT_NEAR(check.mass.volume, expected, 1e-11);
    // Euler's number of a body with g holes through it is 2 - 2 g
    EXPECT_EQ(mesh.vertex_count() - mesh.triangle_count() / 2, 2 - 2 * (f.disc.holes + (f.disc.inner > 0 ? 1 : 0)));
  }
}

TEST(Extruded, discs_whose_holes_meet_are_refused) {
  EXPECT_STRNE(fault_of(Drilled{5, 5, 0, 0, 0}), "");
  EXPECT_STRNE(fault_of(Drilled{5, 0, 3, 1, 4}), "") << "the rim";
  EXPECT_STRNE(fault_of(Drilled{5, 0, 3, 1, 1}), "") << "the middle";
  EXPECT_STRNE(fault_of(Drilled{5, 2, 3, 1, 3}), "") << "the hole in the middle";
  EXPECT_STRNE(fault_of(Drilled{5, 0, 8, 1, 2.5}), "") << "each other";
  EXPECT_STRNE(fault_of(Drilled{5, 1.8, 3, 0.5, 3}), "") << "not all of the middle is seen";
}

TEST(Extruded, lobes_have_the_area_of_their_union) {
  // two discs: twice their area less that of the lens between them
  const double r = 1.2, d = 0.9, lens = 2 * r * r * std::acos(d / r) - 2 * d * std::sqrt(r * r - d * d);
  EXPECT_NEAR(area_of_lobes(2, r, d), 2 * kPi * r * r - lens, 1e-12);
  for (const auto& [count, radius, spread] : {std::tuple(2, 1.2, 0.9), {3, 1.0, 1.0}, {3, 1.0, 1.15}, {4, 1.0, 0.8}, {6, 1.0, 1.9}}) {
    SCOPED_TRACE(fmt::format("{} lobes of {} at {}", count, radius, spread));
    double error[2];
    for (int k = 0; k < 2; ++k) {
      const MeshCheck check = check_mesh(extruded(lobes(count, radius, spread, k == 0 ? 24 : 48), 3));
      EXPECT_TRUE(check.is_solid());
      error[k] = 1 - check.mass.volume / (3 * area_of_lobes(count, radius, spread));
    }
    EXPECT_GT(error[0], 0);
    EXPECT_LT(error[1], 2e-3);
    EXPECT_NEAR(error[0] / error[1], 4, 0.1);
    // how many of many points lie in any disc or between the middles of the discs: another way to the area
    int inside = 0;
    constexpr int kAcross = 1000;
    const double reach = radius + spread;
    for (int i = 0; i < kAcross * kAcross; ++i) {
      const double x = reach * (2.0 * (i % kAcross + 0.5) / kAcross - 1), y = reach * (2.0 * (i / kAcross + 0.5) / kAcross - 1);
      bool in_disc = false, between = true;
      for (int lobe = 0; lobe < count; ++lobe) {
        const double angle = 2 * kPi * lobe / count, side = angle + kPi / count;
        in_disc = in_disc || std::hypot(x - spread * std::cos(angle), y - spread * std::sin(angle)) < radius;
        between = between && x * std::cos(side) + y * std::sin(side) < spread * std::cos(kPi / count);
      }
      inside += in_disc || between ? 1 : 0;
    }
    EXPECT_NEAR(area_of_lobes(count, radius, spread) / (4 * reach * reach * inside / kAcross / kAcross), 1, 1e-3);
  }
}

TEST(Blades, a_paddle_wheel_has_the_area_of_its_shaft_and_its_blades_and_twists) {
  for (const auto& [blades, thickness] : {std::tuple(1, 0.5), {2, 1.2}, {4, 0.3}, {7, 0.6}}) {
    SCOPED_TRACE(fmt::format("{} blades of {}", blades, thickness));
    const PaddleWheel wheel{1, 3, thickness, blades};
    ASSERT_STREQ(fault_of(wheel), "");
    // how many of many points lie in the disc or in a bar: another way to the area
    int inside = 0;
    constexpr int kAcross = 1000;
    for (int i = 0; i < kAcross * kAcross; ++i) {
      const double x = 3 * (2.0 * (i % kAcross + 0.5) / kAcross - 1), y = 3 * (2.0 * (i / kAcross + 0.5) / kAcross - 1);
      bool is_inside = std::hypot(x, y) < 1;
      for (int b = 0; b < blades; ++b) {
        const double c = std::cos(2 * kPi * b / blades), s = std::sin(2 * kPi * b / blades), along = c * x + s * y;
        const bool in_bar = std::abs(c * y - s * x) < 0.5 * thickness && along > 0 && along < std::sqrt(9 - 0.25 * thickness * thickness);
        is_inside = is_inside || in_bar;
      }
      inside += is_inside ? 1 : 0;
    }
    EXPECT_NEAR(area_of(wheel) / (36.0 * inside / kAcross / kAcross), 1, 2e-3);
    const double gap = 2 * kPi / blades - 2 * std::asin(0.5 * thickness);
    const auto segments = static_cast<int>(std::lround(2 * kPi * 10 / gap));  // ten steps between two blades, then twenty
    for (const double turn : {0.0, 0.7, -2.0}) {
      double error[2];
      for (int k = 0; k < 2; ++k) {
        const MeshCheck check = check_mesh(extruded(section_of(wheel, (k + 1) * segments), 2, turn, turn == 0 ? 1 : k == 0 ? 40 : 80));
        EXPECT_TRUE(check.is_solid());
        error[k] = 1 - check.mass.volume / (2 * area_of(wheel));
      }
      EXPECT_LT(std::abs(error[1]), 1e-2);
      EXPECT_NEAR(error[0] / error[1], 4, 0.6) << "second order, turned by " << turn;
    }
  }
  EXPECT_STRNE(fault_of(PaddleWheel{1, 1, 0.1, 2}), "");
  EXPECT_STRNE(fault_of(PaddleWheel{1, 3, 2, 2}), "");
  EXPECT_STRNE(fault_of(PaddleWheel{1, 3, 0.9, 8}), "");
}

TEST(Extruded, a_twisted_prism_of_a_circle_is_the_prism) {
  // corners a step of the circle apart stand above each other
  constexpr int kCorners = 24;
  const CrossSection disc = drilled({1, 0, 0, 0, 0}, kCorners, 0);
  for (const double sign : {1.0, -1.0})
    EXPECT_NEAR(check_mesh(extruded(disc, 3, sign * 2 * kPi * 6 / kCorners, 6)).mass.volume, 3 * area_of_polygon(kCorners), 1e-13);
}

TEST(Primitives, a_straight_rod_is_a_prism_and_a_u_follows_its_path) {
  const double area16 = 8 * std::sin(2 * kPi / 16);  // of a regular polygon of 16 corners, radius 1
  MeshCheck check = check_mesh(rod({{0, 0, 0}, {0, 0, 1}, {0, 0, 5}}, 1, 16));
  EXPECT_TRUE(check.is_solid());
  EXPECT_NEAR(check.mass.volume, 5 * area16, 1e-12);
  // mitred pieces between planes that hold the path's points: cross-section times length, up to the polygon's asymmetry
  const std::vector<Vec3> path = u_path(6, 4, 8, 16);
  double length_of_path = 0;
  for (std::size_t i = 1; i < path.size(); ++i) length_of_path += length(path[i] - path[i - 1]);
  check = check_mesh(rod(path, 1, 16));
  EXPECT_TRUE(check.is_solid());
  EXPECT_EQ(check.crossing_pairs, 0);
  EXPECT_NEAR(check.mass.volume, length_of_path * area16, 1e-3 * check.mass.volume);
}

TEST(RandomRock, meets_its_form_and_repeats_by_seed) {
  for (std::uint64_t seed : {1U, 2U, 3U}) {
    RockForm form;
    form.diameter = 0.02;
    form.elongation = 0.7;
    form.flatness = 0.6;
    form.triangles = 500;
    form.seed = seed;
    const TriangleMesh rock = random_rock(form);
    EXPECT_EQ(rock.triangle_count(), 500);
    const MeshCheck check = check_mesh(rock);
    EXPECT_TRUE(check.is_solid());
    EXPECT_EQ(check.crossing_pairs, 0);
    const Descriptors d = describe(rock);
    EXPECT_NEAR(d.volume_diameter, 0.02, 1e-12);
    EXPECT_NEAR(d.elongation, 0.7, kFormTolerance);
    EXPECT_NEAR(d.flatness, 0.6, kFormTolerance);
    EXPECT_LT(d.convexity, 1);
    EXPECT_EQ(random_rock(form).vertices, rock.vertices);
  }
}

TEST(RandomRock, a_rougher_one_is_less_convex) {
  RockForm smooth, rough;
  smooth.roughness = 0.02;
  rough.roughness = 0.2;
  EXPECT_GT(describe(random_rock(smooth)).convexity, describe(random_rock(rough)).convexity + 0.02);
}

TEST(RandomRock, a_crushed_stone_is_convex_and_angular) {
  RockForm form;
  form.elongation = 0.75;
  form.flatness = 0.65;
  for (std::uint64_t seed : {1U, 2U, 3U}) {
    form.seed = seed;
    const TriangleMesh stone = crushed_stone(form);
    EXPECT_TRUE(check_mesh(stone).is_solid());
    const Descriptors d = describe(stone);
    EXPECT_NEAR(d.convexity, 1, 1e-8);
    EXPECT_NEAR(d.elongation, 0.75, kFormTolerance);
    EXPECT_NEAR(d.flatness, 0.65, kFormTolerance);
    EXPECT_GT(d.angularity, 0.15);
  }
}

TEST(RandomRock, a_form_out_of_range_is_refused) {
  RockForm form;
  form.elongation = 1.5;
  EXPECT_THROW(random_rock(form), UsageError);
}

}  // namespace
}  // namespace scree
