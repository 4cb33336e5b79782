// Row G5 of the validation plan: each defect is planted in a mesh, and class and count are known by
// construction.
#include "mesher/check/mesh_check.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <numbers>

#include "mesher/repair/mesh_repair.hpp"
#include "tests/support/shapes.hpp"

namespace scree {
namespace {

TriangleMesh box(const Vec3& size, const Vec3& centre = {}) {
  TriangleMesh mesh = box_mesh(size);
  for (Vec3& p : mesh.vertices) p += centre;
  return mesh;
}

void invert(TriangleMesh& mesh) {
  for (Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
}

TriangleMesh with_vertices_of_their_own(const TriangleMesh& a, const TriangleMesh& b) {
  TriangleMesh mesh = a;
  mesh.vertices.insert(mesh.vertices.end(), b.vertices.begin(), b.vertices.end());
  for (Triangle t : b.triangles) {
    for (std::int32_t& v : t) v += a.vertex_count();
    mesh.triangles.push_back(t);
  }
  return mesh;
}

TriangleMesh both(const TriangleMesh& a, const TriangleMesh& b) {
  TriangleMesh mesh = with_vertices_of_their_own(a, b);
  weld_equal_positions(mesh);
  return mesh;
}

/// A unit box of which one triangle, but not its neighbour, is split at the middle of their common edge.
TriangleMesh box_with_t_junction() {
  TriangleMesh mesh = box({1, 1, 1});
  const Triangle t = mesh.triangles[0];
  const auto m = mesh.vertex_count();
  mesh.vertices.push_back(0.5 * (mesh.corner(0, 0) + mesh.corner(0, 1)));
  mesh.triangles[0] = {t[0], m, t[2]};
  mesh.triangles.push_back({m, t[1], t[2]});
  return mesh;
}

void expect_problem(const MeshCheck& check, const char* words) {
  EXPECT_FALSE(check.is_solid());
  std::string all;
  for (const std::string& p : check.problems) all += p + "\n";
  EXPECT_NE(all.find(words), std::string::npos) << "looked for '" << words << "' in\n" << all;
  EXPECT_FALSE(check.advice.empty());
}

TEST(MeshCheck, a_box_is_a_solid_without_any_defect) {
  const MeshCheck check = check_mesh(box({1, 2, 3}, {10, 0, 0}));
  EXPECT_TRUE(check.is_solid());
  EXPECT_TRUE(check.is_watertight());
  EXPECT_EQ(check.boundary_edges + check.non_manifold_edges + check.inconsistent_edges + check.non_manifold_vertices +
                check.degenerate_triangles + check.duplicate_triangles + check.unreferenced_vertices + check.t_junctions +
                check.crossing_pairs,
            0);
  EXPECT_EQ(check.components.size(), 1U);
  EXPECT_EQ(check.euler_characteristic, 2);
  EXPECT_NEAR(check.mass.volume, 6, 1e-13);
  EXPECT_NEAR(check.area, 22, 1e-13);
  EXPECT_NEAR(check.equivalent_diameter(), std::cbrt(36 / std::numbers::pi), 1e-14);
}

TEST(MeshCheck, the_verdict_does_not_depend_on_the_size_of_the_mesh) {
  for (double size : {1e-9, 1e-3, 1.0, 1e3, 1e9}) {
    EXPECT_TRUE(check_mesh(box(Vec3{size, size, size})).is_solid()) << size;
    TriangleMesh plate = box(Vec3{size, size, 1e-4 * size});
    EXPECT_TRUE(check_mesh(plate).is_solid()) << "a thin closed plate of " << size;
  }
}

TEST(MeshCheck, an_inverted_box_is_refused_with_its_signed_volume) {
  TriangleMesh mesh = box({1, 1, 1});
  invert(mesh);
  const MeshCheck check = check_mesh(mesh);
  EXPECT_EQ(check.inverted_components, 1);
  EXPECT_EQ(check.inconsistent_edges, 0);
  expect_problem(check, "inverted");
  expect_problem(check, "volume -1 ");
}

TEST(MeshCheck, one_flipped_facet_disagrees_along_its_three_edges) {
  TriangleMesh mesh = box({1, 1, 1});
  std::swap(mesh.triangles[5][0], mesh.triangles[5][1]);
  const MeshCheck check = check_mesh(mesh);
  EXPECT_EQ(check.inconsistent_edges, 3);
  EXPECT_TRUE(check.is_watertight());
  expect_problem(check, "3 edges between triangles that face opposite ways");
}

TEST(MeshCheck, a_missing_facet_leaves_three_boundary_edges_in_one_loop) {
  TriangleMesh mesh = box({1, 1, 1});
  mesh.triangles.pop_back();
  const MeshCheck check = check_mesh(mesh);
  EXPECT_EQ(check.boundary_edges, 3);
  EXPECT_EQ(check.boundary_loops, 1);
  EXPECT_EQ(check.t_junctions, 0);
  expect_problem(check, "3 boundary edges in 1 loop");
}

TEST(MeshCheck, two_missing_facets_that_do_not_touch_are_two_loops) {
  TriangleMesh mesh = test::icosphere(2);
  mesh.triangles.erase(mesh.triangles.begin() + 300);
  mesh.triangles.erase(mesh.triangles.begin());
  EXPECT_EQ(check_mesh(mesh).boundary_edges, 6);
  EXPECT_EQ(check_mesh(mesh).boundary_loops, 2);
}

TEST(MeshCheck, a_t_junction_is_counted_and_told_apart_from_a_hole) {
  const MeshCheck check = check_mesh(box_with_t_junction());
  EXPECT_EQ(check.t_junctions, 1);
  EXPECT_EQ(check.boundary_edges, 3);
  expect_problem(check, "1 T-junction");
}

TEST(MeshCheck, a_duplicated_facet_is_counted_and_dropped) {
  TriangleMesh mesh = box({1, 1, 1});
  mesh.triangles.push_back(mesh.triangles[3]);
  mesh.triangles.push_back({mesh.triangles[4][0], mesh.triangles[4][2], mesh.triangles[4][1]});  // the other winding
  EXPECT_EQ(check_mesh(mesh).duplicate_triangles, 2);
  const RepairCounts counts = clean_mesh(mesh, false);
  EXPECT_EQ(counts.duplicates_dropped, 2);
  EXPECT_EQ(counts.sentences().size(), 1U);
  EXPECT_TRUE(check_mesh(mesh).is_solid());
}

TEST(MeshCheck, a_zero_area_facet_on_an_edge_is_removed_without_opening_the_mesh) {
  TriangleMesh mesh = box_with_t_junction();
  const auto m = static_cast<std::int32_t>(8);
  const Triangle split = mesh.triangles[0];  // {a, m, c}; the other half is {m, b, c}
  const std::int32_t a = split[0], b = mesh.triangles.back()[1];
  mesh.triangles.push_back({a, b, m});  // fills the slit: a flat triangle
  const MeshCheck before = check_mesh(mesh);
  EXPECT_EQ(before.degenerate_triangles, 1);
  EXPECT_TRUE(before.is_watertight());
  const RepairCounts counts = clean_mesh(mesh, false);
  EXPECT_EQ(counts.slivers_flipped, 1);
  const MeshCheck after = check_mesh(mesh);
  EXPECT_EQ(after.degenerate_triangles, 0);
  EXPECT_TRUE(after.is_solid());
  EXPECT_NEAR(after.mass.volume, 1, 1e-14);
}

TEST(MeshCheck, a_facet_with_a_repeated_vertex_is_dropped_and_counted) {
  TriangleMesh mesh = box({1, 1, 1});
  mesh.triangles.push_back({0, 0, 1});
  mesh.triangles.push_back({3, 3, 3});
  EXPECT_EQ(clean_mesh(mesh, false).degenerate_dropped, 2);
  EXPECT_TRUE(check_mesh(mesh).is_solid());
}

TEST(MeshCheck, two_boxes_that_share_an_edge_have_one_non_manifold_edge) {
  const MeshCheck check = check_mesh(both(box({1, 1, 1}), box({1, 1, 1}, {1, 1, 0})));
  EXPECT_EQ(check.non_manifold_edges, 1);
  expect_problem(check, "1 non-manifold edge with more than two triangles");
}

TEST(MeshCheck, two_boxes_that_touch_at_a_corner_have_one_non_manifold_vertex_and_pass) {
  const MeshCheck check = check_mesh(both(box({1, 1, 1}), box({1, 1, 1}, {1, 1, 1})));
  EXPECT_EQ(check.non_manifold_vertices, 1);
  EXPECT_EQ(check.components.size(), 2U);
  EXPECT_TRUE(check.is_solid());
  EXPECT_EQ(check.remarks.size(), 2U);
}

TEST(MeshCheck, a_box_with_an_inward_cavity_is_a_solid_of_the_difference_in_volume) {
  TriangleMesh cavity = box({1, 1, 1});
  invert(cavity);
  const MeshCheck check = check_mesh(both(box({2, 2, 2}), cavity));
  EXPECT_TRUE(check.is_solid());
  EXPECT_NEAR(check.mass.volume, 7, 1e-13);
  EXPECT_EQ(check.components[1].depth, 1);
}

TEST(MeshCheck, a_box_inside_a_box_would_count_its_volume_twice_and_is_refused) {
  const MeshCheck check = check_mesh(both(box({2, 2, 2}), box({1, 1, 1})));
  EXPECT_EQ(check.overlapping_components, 1);
  expect_problem(check, "count twice");
}

TEST(MeshCheck, two_boxes_that_pass_through_each_other_are_refused) {
  const MeshCheck check = check_mesh(both(box({1, 1, 1}), box({1, 1, 1}, {0.4, 0.3, 0.2})));
  EXPECT_EQ(check.crossing_components, 1);
  EXPECT_GT(check.crossing_pairs, 0);
  expect_problem(check, "through each other");
}

// Also turned, where rounding puts faces that are one on the other a little apart or into each other.
TEST(MeshCheck, boxes_that_touch_have_no_common_volume_and_those_that_share_planes_may_have_one) {
  const Vec3 unit{1, 1, 1};
  const struct {
    Vec3 size, offset;
    bool is_common;
  } cases[] = {{unit, {1, 0.3, 0.2}, false},               // a face on a part of a face
               {unit, {1, 0, 0}, false},                   // a face on a face
               {unit, {1, 1, 0}, false},                   // an edge on an edge
               {unit, {1, 1, 0.3}, false},                 // an edge on a part of an edge
               {{0.2, 0.3, 0.4}, {0.6, 0.1, 0.1}, false},  // a face within a face
               {unit, {0.5, 0, 0}, true},                  // pushed along its edges
               {unit, {0.5, 0.5, 0}, true},
               {unit, {0, 0, 0}, true},  // one in the place of the other
               {{0.5, 0.5, 0.5}, {0.25, 0.25, 0.25}, true},
               {{0.5, 2, 0.5}, {0, 0, 0.25}, true}};
  for (const auto& c : cases) {
    for (const double angle : {0.0, 0.7, 2.1}) {
      TriangleMesh mesh = with_vertices_of_their_own(box(unit), box(c.size, c.offset));
      const Quat turn = quaternion_of(normalised(Vec3{1, 2, 3}), angle);
      for (Vec3& v : mesh.vertices) v = rotate(turn, v);
      const MeshCheck check = check_mesh(mesh);
      EXPECT_EQ(check.is_solid(), !c.is_common) << c.offset.x << " " << c.offset.y << " " << c.offset.z << " " << angle;
      EXPECT_LE(check.crossing_components + check.touching_components, 1);
      EXPECT_NEAR(check.mass.volume, 1 + c.size.x * c.size.y * c.size.z, 1e-13);
    }
  }
}

TEST(MeshCheck, a_vertex_pushed_through_the_opposite_side_is_remarked_as_self_intersection) {
  TriangleMesh mesh = test::icosphere(2);
  mesh.vertices[0] = -1.2 * mesh.vertices[0];
  const MeshCheck check = check_mesh(mesh);
  EXPECT_GT(check.crossing_pairs, 0);
  EXPECT_EQ(check.crossing_components, 0);
  EXPECT_FALSE(check.remarks.empty());
}

TEST(MeshCheck, a_prism_over_a_crossed_outline_has_the_inertia_of_no_body_and_is_refused) {
  // the left lobe counts 16/3, the right one -4/3: the volume is 4, but the second moment along x is below 0
  TriangleMesh mesh;
  for (double z : {0.0, 1.0}) {
    for (const auto& p : {std::array{0.0, -1.0}, std::array{8.0, 0.5}, std::array{8.0, -0.5}, std::array{0.0, 1.0}})
      mesh.vertices.push_back({p[0], p[1], z});
  }
  mesh.triangles = {{0, 2, 1}, {0, 3, 2}, {4, 5, 6}, {4, 6, 7}};
  for (std::int32_t i = 0; i < 4; ++i) {
    const std::int32_t j = (i + 1) % 4;
    mesh.triangles.push_back({i, j, j + 4});
    mesh.triangles.push_back({i, j + 4, i + 4});
  }
  const MeshCheck check = check_mesh(mesh);
  EXPECT_TRUE(check.is_watertight());
  EXPECT_NEAR(check.mass.volume, 4, 1e-12);
  expect_problem(check, "no body has its inertia");
}

TEST(MeshCheck, a_smooth_sphere_has_no_self_intersection) { EXPECT_EQ(check_mesh(test::icosphere(4)).crossing_pairs, 0); }

TEST(MeshCheck, a_nan_vertex_is_named) {
  TriangleMesh mesh = box({1, 1, 1});
  mesh.vertices[5].y = std::numeric_limits<double>::quiet_NaN();
  mesh.vertices[6].y = std::numeric_limits<double>::infinity();
  const MeshCheck check = check_mesh(mesh);
  EXPECT_EQ(check.nonfinite_vertices, 2);
  expect_problem(check, "first vertex 5");
}

TEST(MeshCheck, an_unused_vertex_is_a_remark_and_is_dropped_with_a_count) {
  TriangleMesh mesh = box({1, 1, 1});
  mesh.vertices.push_back({9, 9, 9});
  EXPECT_EQ(check_mesh(mesh).unreferenced_vertices, 1);
  EXPECT_TRUE(check_mesh(mesh).is_solid());
  EXPECT_EQ(clean_mesh(mesh, false).vertices_unreferenced, 1);
  EXPECT_EQ(mesh.vertex_count(), 8);
}

TEST(MeshCheck, a_mesh_without_triangles_is_refused) { expect_problem(check_mesh(TriangleMesh{}), "no triangles"); }

TEST(MeshRepair, a_triangle_soup_becomes_a_box_by_welding) {
  const TriangleMesh original = box({1, 2, 3});
  TriangleMesh soup;
  for (std::int32_t t = 0; t < original.triangle_count(); ++t) {
    for (int k = 0; k < 3; ++k) soup.vertices.push_back(original.corner(t, k));
    soup.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
  }
  soup.vertices[0].x *= 1.0;
  EXPECT_EQ(weld_equal_positions(soup), 36 - 8);
  EXPECT_TRUE(check_mesh(soup).is_solid());
}

TEST(MeshRepair, zero_and_minus_zero_are_one_position) {
  TriangleMesh mesh;
  mesh.vertices = {{0.0, 0, 0}, {-0.0, 0, 0}};
  EXPECT_EQ(weld_equal_positions(mesh), 1);
}

TEST(MeshRepair, turning_outward_mends_an_inverted_box_and_single_facets) {
  TriangleMesh mesh = box({1, 1, 1});
  invert(mesh);
  EXPECT_EQ(turn_outward(mesh), 12);
  EXPECT_TRUE(check_mesh(mesh).is_solid());
  std::swap(mesh.triangles[5][0], mesh.triangles[5][1]);
  std::swap(mesh.triangles[8][0], mesh.triangles[8][1]);
  EXPECT_EQ(turn_outward(mesh), 2);
  EXPECT_TRUE(check_mesh(mesh).is_solid());
  EXPECT_EQ(turn_outward(mesh), 0);
}

TEST(MeshRepair, turning_outward_makes_an_inner_box_a_cavity) {
  TriangleMesh mesh = both(box({2, 2, 2}), box({1, 1, 1}));
  EXPECT_EQ(turn_outward(mesh), 12);
  EXPECT_NEAR(check_mesh(mesh).mass.volume, 7, 1e-13);
}

// One vertex of a part that overlaps another may lie within it: that makes no cavity of the part.
TEST(MeshRepair, turning_outward_leaves_boxes_that_overlap_outward_whichever_corner_lies_within) {
  for (int corner = 0; corner < 8; ++corner) {
    const auto side = [&](int axis) { return (corner >> axis & 1) != 0 ? 1.0 : -1.0; };
    for (const double size : {2.0, 0.5}) {  // the second with its vertices within the box of the first
      const Vec3 centre = (size > 1 ? 0.7 : 0.9) * Vec3{side(0), side(1), side(2)};
      TriangleMesh mesh = both(box({2, 2, 2}), box({size, size, size}, centre));
      const MeshCheck check = check_mesh(mesh);
      EXPECT_EQ(check.inverted_components, 0) << corner;
      EXPECT_EQ(check.components[0].depth + check.components[1].depth, 0) << corner;
      EXPECT_EQ(check.crossing_components, 1) << corner;
      EXPECT_EQ(turn_outward(mesh), 0) << corner;
    }
  }
}

TEST(MeshRepair, a_moebius_strip_has_no_outside) {
  TriangleMesh strip;
  constexpr int n = 12;
  for (int i = 0; i < n; ++i) {
    const double u = 2 * std::numbers::pi * i / n;
    for (double s : {-0.3, 0.3}) {
      const double r = 1 + s * std::cos(u / 2);
      strip.vertices.push_back({r * std::cos(u), r * std::sin(u), s * std::sin(u / 2)});
    }
  }
  for (std::int32_t i = 0; i < n; ++i) {
    const bool last = i == n - 1;  // the ends meet with the sides exchanged
    const std::int32_t a = 2 * i, b = a + 1, c = last ? 1 : a + 2, d = last ? 0 : a + 3;
    strip.triangles.push_back({a, c, b});
    strip.triangles.push_back({b, c, d});
  }
  const TriangleMesh before = strip;
  EXPECT_EQ(turn_outward(strip), -1);
  EXPECT_EQ(strip.triangles, before.triangles);
}

TEST(WindingNumber, it_is_one_inside_and_zero_outside) {
  const TriangleMesh mesh = test::icosphere(2);
  std::vector<std::int32_t> all(mesh.triangles.size());
  for (std::size_t t = 0; t < all.size(); ++t) all[t] = static_cast<std::int32_t>(t);
  EXPECT_NEAR(winding_number(mesh, all, {0.3, -0.2, 0.5}), 1, 1e-12);
  EXPECT_NEAR(winding_number(mesh, all, {3, -2, 5}), 0, 1e-12);
}

}  // namespace
}  // namespace scree
