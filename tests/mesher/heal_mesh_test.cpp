// What repair makes of meshes that were broken on purpose: exact volumes say whether the right thing was done.
#include <gtest/gtest.h>

#include <algorithm>

#include "mesher/check/mesh_check.hpp"
#include "mesher/repair/heal_mesh.hpp"
#include "mesher/repair/remesh.hpp"
#include "tests/support/shapes.hpp"

namespace scree {
namespace {

TriangleMesh box(const Vec3& size, const Vec3& centre = {}) {
  TriangleMesh mesh = box_mesh(size);
  for (Vec3& p : mesh.vertices) p += centre;
  return mesh;
}

/// Both meshes as one; vertices of equal position are welded by the healing, as by every import.
TriangleMesh both(TriangleMesh a, const TriangleMesh& b) {
  const std::int32_t offset = a.vertex_count();
  a.vertices.insert(a.vertices.end(), b.vertices.begin(), b.vertices.end());
  for (const Triangle& t : b.triangles) a.triangles.push_back({t[0] + offset, t[1] + offset, t[2] + offset});
  return a;
}

/// Heals, and expects a solid of this volume.
std::vector<std::string> expect_healed(TriangleMesh& mesh, double volume, double tolerance = 1e-12) {
  std::vector<std::string> steps;
  heal_mesh(mesh, {}, steps);
  const MeshCheck check = check_mesh(mesh);
  EXPECT_TRUE(check.is_solid()) << (check.problems.empty() ? "" : check.problems.front());
  EXPECT_NEAR(check.mass.volume, volume, tolerance);
  EXPECT_FALSE(steps.empty());
  return steps;
}

TEST(HealMesh, a_missing_facet_is_filled) {
  TriangleMesh mesh = box({1, 2, 3});
  mesh.triangles.erase(mesh.triangles.begin() + 4);
  const auto steps = expect_healed(mesh, 6);
  EXPECT_NE(steps.front().find("1 hole closed"), std::string::npos) << steps.front();
}

TEST(HealMesh, a_missing_cap_of_a_sphere_is_filled_flat) {
  TriangleMesh mesh = test::icosphere(3);
  const double before = check_mesh(mesh).mass.volume;
  std::erase_if(mesh.triangles, [&](const Triangle& t) {
    return std::all_of(t.begin(), t.end(), [&](std::int32_t v) { return mesh.vertices[static_cast<std::size_t>(v)].z > 0.9; });
  });
  std::vector<std::string> steps;
  heal_mesh(mesh, {}, steps);
  const MeshCheck check = check_mesh(mesh);
  EXPECT_TRUE(check.is_solid());
  // at most the cap above z = 0.9 is lost: pi h^2 (3 - h) / 3 with h = 0.1
  EXPECT_LT(check.mass.volume, before);
  EXPECT_GT(check.mass.volume, before - 0.0305);
}

TEST(HealMesh, a_hole_as_large_as_half_the_surface_stays_open) {
  TriangleMesh mesh = test::icosphere(3);
  std::erase_if(mesh.triangles, [&](const Triangle& t) { return mesh.vertices[static_cast<std::size_t>(t[0])].z > 0; });
  std::vector<std::string> steps;
  heal_mesh(mesh, {}, steps);
  EXPECT_GT(check_mesh(mesh).boundary_edges, 0);
}

TEST(HealMesh, a_gap_of_rounding_is_welded) {
  TriangleMesh mesh = box({1, 1, 1});
  const Triangle t = mesh.triangles[3];
  for (int k = 0; k < 3; ++k)
    mesh.vertices.push_back(mesh.vertices[static_cast<std::size_t>(t[static_cast<std::size_t>(k)])] + Vec3{1e-7, -1e-7, 0});
  mesh.triangles[3] = {8, 9, 10};
  EXPECT_GT(check_mesh(mesh).boundary_edges, 0);
  expect_healed(mesh, 1, 1e-6);
  EXPECT_EQ(mesh.vertex_count(), 8);
}

TEST(HealMesh, a_t_junction_is_split) {
  TriangleMesh mesh = box({1, 1, 1});
  const Triangle t = mesh.triangles[0];
  mesh.vertices.push_back(0.5 * (mesh.vertices[static_cast<std::size_t>(t[0])] + mesh.vertices[static_cast<std::size_t>(t[1])]));
  mesh.triangles[0] = {t[0], 8, t[2]};
  mesh.triangles.push_back({8, t[1], t[2]});
  EXPECT_EQ(check_mesh(mesh).t_junctions, 1);
  const auto steps = expect_healed(mesh, 1);
  EXPECT_NE(steps.front().find("T-junction"), std::string::npos) << steps.front();
}

TEST(HealMesh, mixed_and_inverted_facets_are_turned) {
  TriangleMesh mesh = test::icosphere(2);
  const double volume = check_mesh(mesh).mass.volume;
  for (std::size_t t = 0; t < mesh.triangles.size(); t += 7) std::swap(mesh.triangles[t][0], mesh.triangles[t][1]);
  expect_healed(mesh, volume);
}

TEST(HealMesh, two_boxes_that_share_an_edge_are_parted) {
  TriangleMesh mesh = both(box({1, 1, 1}), box({1, 1, 1}, {1, 1, 0}));
  std::vector<std::string> steps;
  heal_mesh(mesh, {}, steps);
  const MeshCheck check = check_mesh(mesh);
  EXPECT_EQ(check.non_manifold_edges, 0);
  EXPECT_TRUE(check.is_watertight());
  EXPECT_NEAR(check.mass.volume, 2, 1e-12);
}

TEST(HealMesh, a_partition_inside_a_box_is_dropped) {
  // two boxes with a common face, stored once, and the face between them as a wall
  TriangleMesh left = box({1, 1, 1}), right = box({1, 1, 1}, {1, 0, 0});
  std::erase_if(right.triangles, [&](const Triangle& t) {
    return std::all_of(t.begin(), t.end(), [&](std::int32_t v) { return right.vertices[static_cast<std::size_t>(v)].x < 0.6; });
  });
  TriangleMesh mesh = both(left, right);
  const auto steps = expect_healed(mesh, 2);
  EXPECT_TRUE(
      std::any_of(steps.begin(), steps.end(), [](const std::string& s) { return s.find("inside the solid") != std::string::npos; }));
}

TEST(HealMesh, a_fin_is_dropped) {
  TriangleMesh mesh = box({1, 1, 1});
  mesh.vertices.push_back({0, 0, 2});
  mesh.triangles.push_back({4, 5, 8});
  const auto steps = expect_healed(mesh, 1);
  EXPECT_NE(steps.front().find("fin"), std::string::npos) << steps.front();
}

TEST(HealMesh, a_vertex_pushed_through_the_opposite_side_is_cut_out) {
  TriangleMesh mesh = test::icosphere(3);
  const double volume = check_mesh(mesh).mass.volume;
  mesh.vertices[0] = -1.2 * mesh.vertices[0];
  EXPECT_GT(check_mesh(mesh).crossing_pairs, 0);
  std::vector<std::string> steps;
  heal_mesh(mesh, {}, steps);
  const MeshCheck check = check_mesh(mesh);
  EXPECT_TRUE(check.is_solid());
  EXPECT_EQ(check.crossing_pairs, 0);
  EXPECT_NEAR(check.mass.volume, volume, 0.05 * volume);
}

TEST(HealMesh, what_is_sound_stays_as_it_is) {
  TriangleMesh mesh = test::rock(4, 3);
  const TriangleMesh before = mesh;
  std::vector<std::string> steps;
  heal_mesh(mesh, {}, steps);
  EXPECT_TRUE(steps.empty());
  EXPECT_EQ(mesh.triangles, before.triangles);
  EXPECT_EQ(mesh.vertices, before.vertices);
}

TEST(Remesh, two_overlapping_boxes_become_one_solid_of_their_union) {
  const TriangleMesh mesh = both(box({1, 1, 1}), box({1, 1, 1}, {0.5, 0.5, 0.5}));
  const MeshCheck check = check_mesh(remesh(mesh, 0.05));
  EXPECT_TRUE(check.is_solid()) << (check.problems.empty() ? "" : check.problems.front());
  EXPECT_EQ(check.components.size(), 1U);
  // union 2 - 1/8; edges are chamfered by at most half a lattice edge: 28 edge lengths times 0.025^2 / 2
  EXPECT_NEAR(check.mass.volume, 1.875, 0.02);
}

TEST(Remesh, a_ball_with_a_hole_is_spanned) {
  TriangleMesh mesh = test::icosphere(3);
  const double volume = check_mesh(mesh).mass.volume;
  mesh.triangles.resize(mesh.triangles.size() - 12);
  const MeshCheck check = check_mesh(remesh(mesh, 0.1));
  EXPECT_TRUE(check.is_solid());
  EXPECT_EQ(check.euler_characteristic, 2);
  EXPECT_NEAR(check.mass.volume, volume, 0.02 * volume);
}

TEST(HealMesh, components_come_apart) {
  const std::vector<TriangleMesh> parts = components_of(both(box({1, 1, 1}), box({2, 2, 2}, {5, 0, 0})));
  ASSERT_EQ(parts.size(), 2U);
  EXPECT_EQ(parts[0].vertex_count(), 8);
  EXPECT_NEAR(check_mesh(parts[1]).mass.volume, 8, 1e-12);
}

}  // namespace
}  // namespace scree
