// Simplifying, refining and the distance between surfaces.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/error.hpp"
#include "core/geometry/mass_properties.hpp"
#include "core/geometry/mesh_refine.hpp"
#include "mesher/check/mesh_check.hpp"
#include "mesher/check/mesh_deviation.hpp"
#include "mesher/edit/mesh_simplify.hpp"
#include "tests/support/shapes.hpp"

namespace scree {
namespace {

TriangleMesh moved(TriangleMesh mesh, const Vec3& shift, double factor = 1) {
  for (Vec3& p : mesh.vertices) p = factor * p + shift;
  return mesh;
}

TriangleMesh torus(double large, double small, int n, int m) {
  TriangleMesh mesh;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < m; ++j) {
      const double u = 2 * std::numbers::pi * i / n, v = 2 * std::numbers::pi * j / m;
      mesh.vertices.push_back(
          {(large + small * std::cos(v)) * std::cos(u), (large + small * std::cos(v)) * std::sin(u), small * std::sin(v)});
      const auto at = [&](int a, int b) { return (a % n) * m + b % m; };
      mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  return mesh;
}

/// The bounds hold the true distance and lie as near to each other as promised.
void expect_bounds(const HausdorffDistance& h, double expected) {
  EXPECT_LE(h.lower(), expected * (1 + 1e-12));
  EXPECT_GE(h.upper(), expected * (1 - 1e-12));
  EXPECT_LE(h.upper(), (1 + kDeviationTolerance) * h.lower() + 1e-5 * expected + 1e-300);
}

TEST(MeshDeviation, concentric_cubes_are_as_far_apart_as_their_corners) {
  // from the larger cube to the smaller one: the corner, half the difference along each axis
  const HausdorffDistance h = hausdorff_distance(box_mesh({1, 1, 1}), box_mesh({2, 2, 2}));
  expect_bounds(h, std::sqrt(3.0) / 2);
  EXPECT_NEAR(h.forth.lower, 0.5, 0.005);  // the other way it is the distance of the faces
}

TEST(MeshDeviation, the_largest_distance_may_lie_inside_a_triangle) {
  // a flat square against a tent over it: farthest is the ridge from the square and the middle from the tent
  TriangleMesh flat, tent;
  flat.vertices = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
  flat.triangles = {{0, 1, 2}, {0, 2, 3}};
  tent = flat;
  tent.vertices.push_back({0, 0, 0.5});
  tent.triangles = {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}};
  const HausdorffDistance h = hausdorff_distance(flat, tent);
  EXPECT_NEAR(h.back.lower, 0.5, 0.005);
  EXPECT_NEAR(h.forth.lower, 0.5 / std::sqrt(1.25), 0.005);  // foot on the slope 1 : 2
  expect_bounds(h, 0.5);
}

TEST(MeshDeviation, it_is_nothing_for_the_same_surface_with_other_triangles) {
  const TriangleMesh rock = test::rock(3, 0);
  TriangleMesh fine = rock;
  split_in_four(fine);
  const HausdorffDistance h = hausdorff_distance(rock, fine);
  EXPECT_LE(h.lower(), 1e-14);
  EXPECT_LE(h.back.upper, 1e-14);  // each fine triangle lies in one coarse triangle, which bounds it at once
  EXPECT_LE(h.forth.upper, 0.05);  // the other way pieces across edges must be cut small
}

TEST(MeshDeviation, it_grows_with_the_scale_and_does_not_mind_the_place) {
  const TriangleMesh a = test::icosphere(1), b = test::icosphere(3);
  const double unit = hausdorff_distance(a, b).lower();
  const Vec3 far{1e3, -2e3, 5e2};
  const HausdorffDistance h = hausdorff_distance(moved(a, far, 8), moved(b, far, 8));
  EXPECT_NEAR(h.lower(), 8 * unit, 8 * unit * 1e-2);
}

TEST(MeshSimplify, a_sphere_keeps_its_volume_and_stays_a_solid) {
  TriangleMesh mesh = test::icosphere(4);
  const TriangleMesh before = mesh;
  const SimplifyCounts counts = simplify_mesh(mesh, 500, true);
  EXPECT_TRUE(counts.reached_target);
  EXPECT_LE(mesh.triangle_count(), 500);
  EXPECT_GE(mesh.triangle_count(), 498);
  const MeshCheck check = check_mesh(mesh);
  EXPECT_TRUE(check.is_solid());
  EXPECT_EQ(check.euler_characteristic, 2);
  EXPECT_EQ(check.crossing_pairs, 0);
  EXPECT_NEAR(check.mass.volume, mass_properties(before).volume, 1e-12);
  // 500 equal triangles have edges of 0.24; the sagitta of such a triangle's circumcircle is 0.0098
  EXPECT_LE(hausdorff_distance(before, mesh).upper(), 0.02);
}

// Its corners stay to rounding: an edge next to a corner whose joint vertex folds a triangle anywhere but off the corner has to wait.
TEST(MeshSimplify, a_cuboid_of_many_triangles_becomes_the_one_of_twelve) {
  for (const int n : {4, 8, 16, 32}) {
    for (const Vec3& size : {Vec3{1, 1, 1}, Vec3{1, 2, 3}}) {
      TriangleMesh mesh = test::grid_box(n, size);
      EXPECT_TRUE(simplify_mesh(mesh, 12, true).reached_target);
      EXPECT_EQ(mesh.triangle_count(), 12) << n;
      EXPECT_EQ(mesh.vertex_count(), 8) << n;
      EXPECT_TRUE(check_mesh(mesh).is_solid()) << n;
      for (const Vec3& p : mesh.vertices) {
        for (int k = 0; k < 3; ++k) EXPECT_NEAR(std::abs(p[k]), size[k] / 2, 1e-14) << n;
      }
      EXPECT_NEAR(mass_properties(mesh).volume, size.x * size.y * size.z, 1e-13) << n;
    }
  }
}

TEST(MeshSimplify, a_torus_keeps_its_hole) {
  TriangleMesh mesh = torus(1, 0.4, 64, 32);
  EXPECT_TRUE(simplify_mesh(mesh, 200, true).reached_target);
  const MeshCheck check = check_mesh(mesh);
  EXPECT_TRUE(check.is_solid());
  EXPECT_EQ(check.euler_characteristic, 0);
}

TEST(MeshSimplify, a_handle_smaller_than_the_triangles_is_cut_unless_the_topology_must_stay) {
  // a tunnel through a ball from one triangle to another near it, as scans have them
  TriangleMesh ball = test::icosphere(4);
  const Triangle t1 = ball.triangles[0], t2 = ball.triangles[40];
  for (std::int32_t v : t1) ASSERT_EQ(std::count(t2.begin(), t2.end(), v), 0);
  ball.triangles.erase(ball.triangles.begin() + 40);
  ball.triangles.erase(ball.triangles.begin());
  const Triangle far{t2[1], t2[0], t2[2]};
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t next = (k + 1) % 3;
    ball.triangles.push_back({t1[k], t1[next], far[next]});
    ball.triangles.push_back({t1[k], far[next], far[k]});
  }
  ASSERT_TRUE(check_mesh(ball).is_watertight());
  ASSERT_EQ(check_mesh(ball).euler_characteristic, 0);
  TriangleMesh kept = ball;
  simplify_mesh(kept, 300, false);
  EXPECT_TRUE(check_mesh(kept).is_watertight());
  EXPECT_EQ(check_mesh(kept).euler_characteristic, 0);
  const SimplifyCounts counts = simplify_mesh(ball, 300, true);
  EXPECT_GT(counts.handles_cut, 0);
  EXPECT_TRUE(check_mesh(ball).is_solid());
  EXPECT_EQ(check_mesh(ball).euler_characteristic, 2);
}

TEST(MeshSimplify, an_open_sheet_keeps_its_border) {
  TriangleMesh mesh;
  constexpr int n = 20;
  for (int i = 0; i <= n; ++i) {
    for (int j = 0; j <= n; ++j) {
      mesh.vertices.push_back({i / double(n), j / double(n), 0});
      if (i == n || j == n) continue;
      const std::int32_t a = i * (n + 1) + j, b = a + n + 1;
      mesh.triangles.push_back({a, b, b + 1});
      mesh.triangles.push_back({a, b + 1, a + 1});
    }
  }
  EXPECT_TRUE(simplify_mesh(mesh, 8, true).reached_target);
  EXPECT_NEAR(surface_area(mesh), 1, 1e-6);
}

TEST(MeshSimplify, scale_and_place_do_not_matter) {
  TriangleMesh small = test::rock(5, 3), large = moved(small, {1024, 0, 0}, 4096);
  simplify_mesh(small, 100, true);
  simplify_mesh(large, 100, true);
  EXPECT_EQ(small.triangle_count(), large.triangle_count());
  EXPECT_NEAR(mass_properties(large).volume / mass_properties(small).volume, std::pow(4096.0, 3), 1e-6 * std::pow(4096.0, 3));
}

TEST(MeshRefine, edges_become_short_and_the_surface_stays) {
  TriangleMesh mesh = box_mesh({1, 2, 3});
  refine_mesh(mesh, 0.3, 100000);
  double longest = 0;
  for (std::int32_t t = 0; t < mesh.triangle_count(); ++t) {
    for (int k = 0; k < 3; ++k) longest = std::max(longest, length(mesh.corner(t, (k + 1) % 3) - mesh.corner(t, k)));
  }
  EXPECT_LE(longest, 0.3);
  const MeshCheck check = check_mesh(mesh);
  EXPECT_TRUE(check.is_solid());
  EXPECT_NEAR(check.mass.volume, 6, 1e-13);
  EXPECT_NEAR(check.area, 22, 1e-12);
}

TEST(MeshRefine, too_short_an_edge_is_refused_before_anything_is_split) {
  TriangleMesh mesh = box_mesh({1, 2, 3});
  // 22 m^2 in triangles of at most sqrt(3)/4 L^2
  EXPECT_THROW(refine_mesh(mesh, 1e-9, 1000000), UsageError);
  EXPECT_EQ(mesh.triangle_count(), 12);
  EXPECT_THROW(refine_mesh(mesh, 0.02, 100000), UsageError);
}

TEST(MeshRefine, splitting_in_four_makes_four_times_as_many) {
  TriangleMesh mesh = test::icosphere(1);
  const double volume = mass_properties(mesh).volume;
  split_in_four(mesh);
  EXPECT_EQ(mesh.triangle_count(), 320);
  EXPECT_NEAR(mass_properties(mesh).volume, volume, 1e-14);
}

}  // namespace
}  // namespace scree
