// Counts of corners and edges follow from Euler's formula for the shapes, however finely they are meshed.
#include "core/geometry/features.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <optional>
#include <set>
#include <vector>

#include "tests/support/shapes.hpp"

namespace scree {
namespace {

TriangleMesh finer(TriangleMesh mesh, int times) {
  for (int i = 0; i < times; ++i) mesh = test::subdivide(mesh, false);
  return mesh;
}

/// Prism of height 1 over an L: 12 corners, 18 edges of which the one along the inner corner is concave.
TriangleMesh l_shape() {
  const double outline[6][2] = {{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}};
  const Triangle caps[4] = {{0, 1, 2}, {0, 2, 3}, {0, 3, 5}, {3, 4, 5}};
  TriangleMesh mesh;
  for (double z : {0.0, 1.0}) {
    for (const auto& p : outline) mesh.vertices.push_back({p[0], p[1], z});
  }
  for (const Triangle& t : caps) {
    mesh.triangles.push_back({t[0], t[2], t[1]});
    mesh.triangles.push_back({t[0] + 6, t[1] + 6, t[2] + 6});
  }
  for (std::int32_t i = 0; i < 6; ++i) {
    const std::int32_t j = (i + 1) % 6;
    mesh.triangles.push_back({i, j, j + 6});
    mesh.triangles.push_back({i, j + 6, i + 6});
  }
  return mesh;
}

/// Every corner is owned once, by a triangle that has it; every feature edge by at least one triangle along
/// it.
void expect_owned(const TriangleMesh& mesh, const FeatureTable& table) {
  std::multiset<std::int32_t> corners;
  std::set<std::int32_t> edges;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      if (table.owns_corner(t, k)) {
        const std::int32_t c = table.corner_of[static_cast<std::size_t>(mesh.triangles[t][k])];
        corners.insert(c);
        EXPECT_EQ(table.corners[static_cast<std::size_t>(c)], mesh.triangles[t][k]);
      }
      if (const std::int32_t e = table.owned_edge(t, k); e >= 0) {
        edges.insert(e);
        const FeatureEdge& edge = table.edges[static_cast<std::size_t>(e)];
        const Vec3& a = mesh.vertices[static_cast<std::size_t>(edge.vertex_a)];
        const Vec3 along = mesh.vertices[static_cast<std::size_t>(edge.vertex_b)] - a;
        for (std::size_t end : {k, (k + 1) % 3}) {  // the piece lies on the whole edge
          const Vec3 d = mesh.vertices[static_cast<std::size_t>(mesh.triangles[t][end])] - a;
          EXPECT_LE(length(cross(d, along)), 1e-12 * squared_length(along));
        }
      }
    }
  }
  EXPECT_EQ(corners.size(), table.corners.size());
  EXPECT_EQ(std::set<std::int32_t>(corners.begin(), corners.end()).size(), table.corners.size());
  EXPECT_EQ(edges.size(), table.edges.size());
}

TEST(Features, a_box_has_8_corners_and_12_edges_however_finely_it_is_meshed) {
  for (int times = 0; times <= 4; ++times) {
    const TriangleMesh mesh = finer(box_mesh({3, 2, 1}), times);
    const FeatureTable table = find_features(mesh);
    EXPECT_EQ(table.corners.size(), 8U) << mesh.triangle_count() << " triangles";
    EXPECT_EQ(table.edges.size(), 12U) << mesh.triangle_count() << " triangles";
    EXPECT_EQ(table.region_count, 6);
    expect_owned(mesh, table);
  }
}

TEST(Features, a_turned_box_far_away_has_the_same_features) {
  TriangleMesh mesh = finer(box_mesh({3, 2, 1}), 3);
  for (Vec3& p : mesh.vertices) p = rotate(normalised(Quat{0.3, -0.5, 0.7, 0.2}), p) + Vec3{1e3, -2e3, 5e2};
  const FeatureTable table = find_features(mesh);
  EXPECT_EQ(table.corners.size(), 8U);
  EXPECT_EQ(table.edges.size(), 12U);
}

TEST(Features, every_vertex_and_edge_of_an_icosphere_is_one) {
  for (int level = 0; level <= 3; ++level) {
    const FeatureTable table = find_features(test::icosphere(level));
    const std::size_t n = std::size_t{1} << (2 * level);
    EXPECT_EQ(table.corners.size(), 10 * n + 2);
    EXPECT_EQ(table.edges.size(), 30 * n);
    EXPECT_EQ(static_cast<std::size_t>(table.region_count), 20 * n);
  }
}

TEST(Features, the_inner_edge_of_an_l_shape_is_concave_and_no_feature) {
  for (int times = 0; times <= 2; ++times) {
    const TriangleMesh mesh = finer(l_shape(), times);
    const FeatureTable table = find_features(mesh);
    EXPECT_EQ(table.corners.size(), 12U);
    EXPECT_EQ(table.edges.size(), 17U);
    EXPECT_EQ(table.region_count, 8);
    expect_owned(mesh, table);
    int concave = 0;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      for (std::size_t k = 0; k < 3; ++k) concave += table.edge_kind(t, k) == EdgeKind::concave ? 1 : 0;
    }
    EXPECT_EQ(concave, 2 << times);  // 2^times pieces, each seen from two triangles
  }
}

TEST(Features, the_conormals_of_a_box_edge_run_into_its_two_faces) {
  const TriangleMesh mesh = box_mesh({2, 2, 2});
  for (const FeatureEdge& edge : find_features(mesh).edges) {
    const Vec3& a = mesh.vertices[static_cast<std::size_t>(edge.vertex_a)];
    const Vec3 along = normalised(mesh.vertices[static_cast<std::size_t>(edge.vertex_b)] - a);
    const Vec3 middle = a + along;  // edges have length 2
    for (const int side : {0, 1}) {
      const Vec3 c = conormal(mesh, edge, side);
      EXPECT_NEAR(length(c), 1, 1e-15);
      EXPECT_NEAR(dot(c, along), 0, 1e-15);
      EXPECT_NEAR(dot(c, middle), -1,
                  1e-15);  // towards the middle of a face: the coordinate across is given up
    }
    EXPECT_NEAR(dot(conormal(mesh, edge, 0), conormal(mesh, edge, 1)), 0, 1e-15);
  }
}

TEST(Features, a_square_sheet_has_4_corners_and_4_boundary_edges) {
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  for (int times = 0; times <= 3; ++times) {
    const TriangleMesh sheet = finer(mesh, times);
    const FeatureTable table = find_features(sheet);
    EXPECT_EQ(table.corners.size(), 4U);
    EXPECT_EQ(table.edges.size(), 4U);
    EXPECT_EQ(table.region_count, 1);
    for (const FeatureEdge& edge : table.edges) EXPECT_EQ(conormal(sheet, edge, 1), Vec3{});
  }
}

/// A roof of two slopes along y, and the same with triangles turned.
TriangleMesh roof(const std::vector<std::size_t>& turned) {
  TriangleMesh mesh;
  mesh.vertices = {{-1, -1, -0.3}, {0, -1, 0}, {1, -1, -0.3}, {-1, 1, -0.3}, {0, 1, 0}, {1, 1, -0.3}};
  mesh.triangles = {{0, 1, 3}, {1, 4, 3}, {1, 2, 4}, {2, 5, 4}};
  for (const std::size_t t : turned) std::swap(mesh.triangles[t][1], mesh.triangles[t][2]);
  return mesh;
}

TEST(Features, of_a_wall_are_the_same_for_any_winding) {
  for (const std::vector<std::size_t>& turned : {std::vector<std::size_t>{}, {0, 1, 2, 3}, {0, 1}, {1, 3}, {0, 2, 3}, {3}}) {
    for (int times = 0; times <= 2; ++times) {
      const TriangleMesh mesh = finer(roof(turned), times);
      const FeatureTable table = find_features(mesh, Sides::both);
      EXPECT_EQ(table.region_count, 2);
      EXPECT_EQ(table.corners.size(), 6U);
      EXPECT_EQ(table.edges.size(), 7U);  // the ridge, and six on the boundary
      expect_owned(mesh, table);
      int ridges = 0;
      for (const FeatureEdge& edge : table.edges) {
        const Vec3 sum = conormal(mesh, edge, 0) + conormal(mesh, edge, 1);
        if (edge.face[1] < 0) continue;
        ++ridges;
        EXPECT_NEAR(sum.z, -2 * 0.3 / std::hypot(1, 0.3), 1e-15);  // both slope down, away from where it is convex
        EXPECT_NEAR(sum.x, 0, 1e-15);
      }
      EXPECT_EQ(ridges, 1);
    }
  }
}

TEST(Features, the_inner_edge_of_an_l_shape_is_one_of_a_wall_and_comes_last) {
  const TriangleMesh mesh = finer(l_shape(), 1);
  const FeatureTable outside = find_features(mesh), both = find_features(mesh, Sides::both);
  ASSERT_EQ(both.edges.size(), outside.edges.size() + 1);
  for (std::size_t e = 0; e < outside.edges.size(); ++e) {
    EXPECT_EQ(both.edges[e].vertex_a, outside.edges[e].vertex_a);
    EXPECT_EQ(both.edges[e].vertex_b, outside.edges[e].vertex_b);
  }
  EXPECT_EQ(both.corners, outside.corners);
  EXPECT_EQ(both.region, outside.region);
  expect_owned(mesh, both);
}

// Where a web stands on a sheet nothing is convex; where three sheets meet at an edge the widest angle between two of them may be.
TEST(Features, where_several_sheets_of_a_wall_meet_the_widest_angle_tells_whether_an_edge_is_convex) {
  const auto star = [](const std::vector<double>& angles) {
    TriangleMesh mesh;
    mesh.vertices = {{0, 0, 0}, {0, 0, 1}};
    for (const double degrees : angles) {
      const double angle = degrees / 180 * std::numbers::pi;
      const auto v = mesh.vertex_count();
      mesh.vertices.push_back({std::cos(angle), std::sin(angle), 0});
      mesh.vertices.push_back({std::cos(angle), std::sin(angle), 1});
      mesh.triangles.push_back({0, v, v + 1});
      mesh.triangles.push_back({0, v + 1, 1});
    }
    return mesh;
  };
  const auto convex_side = [&](const std::vector<double>& angles) -> std::optional<Vec3> {
    const TriangleMesh mesh = star(angles);
    for (const FeatureEdge& edge : find_features(mesh, Sides::both).edges) {
      if (edge.vertex_a > 1 || edge.vertex_b > 1) continue;
      return -(conormal(mesh, edge, 0) + conormal(mesh, edge, 1));
    }
    return {};
  };
  EXPECT_FALSE(convex_side({0, 90, 180}));
  EXPECT_FALSE(convex_side({0, 120, 240}));
  const std::optional<Vec3> sharp = convex_side({10, 90, 170});
  ASSERT_TRUE(sharp);
  EXPECT_NEAR(sharp->x, 0, 1e-15);
  EXPECT_NEAR(sharp->y, -2 * std::sin(10.0 / 180 * std::numbers::pi), 1e-15);
  const std::optional<Vec3> doubled = convex_side({0, 0, 90, 90});  // a sheet drawn from both sides
  ASSERT_TRUE(doubled);
  EXPECT_NEAR(doubled->x, -1, 1e-15);
  EXPECT_NEAR(doubled->y, -1, 1e-15);
}

TEST(Features, the_centre_of_an_analytic_sphere_is_a_corner) {
  TriangleMesh point;
  point.vertices = {Vec3{}};
  EXPECT_EQ(find_features(point).corners.size(), 1U);
}

}  // namespace
}  // namespace scree
