// The shared scene and its judge, against closed forms.
#include "tests/benchmarks/peers/peer_scene.hpp"

#include <gtest/gtest.h>

#include <set>

#include "core/base/error.hpp"
#include "core/geometry/mass_properties.hpp"

namespace scree {
namespace {

PeerShape cube(double side) {
  PeerShape shape;
  shape.mesh = box_mesh({side, side, side});
  shape.volume = side * side * side;
  const double moment = shape.volume * side * side / 6;
  shape.moments = {moment, moment, moment};
  shape.bounding_radius = side * std::sqrt(0.75);
  shape.bvh = build_bvh(shape.mesh);
  return shape;
}

PeerBody at(const Vec3& position) {
  PeerBody body;
  body.position = position;
  return body;
}

TEST(PeerShapes, are_closed_centred_and_of_the_volume_that_is_asked) {
  for (const std::string kind : {"rock", "convex"}) {
    for (const PeerShape& shape : make_peer_shapes(kind, 320, 2, 0.01)) {
      EXPECT_EQ(shape.mesh.triangle_count(), 320);
      std::set<std::pair<int, int>> edges;
      for (const Triangle& t : shape.mesh.triangles)
        for (std::size_t k = 0; k < 3; ++k) EXPECT_TRUE(edges.emplace(t[k], t[(k + 1) % 3]).second);
      for (const auto& [a, b] : edges) EXPECT_TRUE(edges.contains({b, a}));
      EXPECT_NEAR(shape.volume, 4.0 / 3 * 3.14159265358979 * 1e-6, 1e-15);
      const MassProperties mass = mass_properties(shape.mesh);
      EXPECT_LT(length(mass.centre), 1e-14);
      // the axes are principal: no products of inertia
      for (int i = 0; i < 3; ++i) EXPECT_LT(std::abs(mass.inertia[i][(i + 1) % 3]), 1e-12 * shape.moments.x);
    }
  }
}

TEST(PeerShapes, convex_ones_have_every_corner_behind_every_face) {
  for (const PeerShape& shape : make_peer_shapes("convex", 80, 4, 1)) {
    for (std::int32_t t = 0; t < shape.mesh.triangle_count(); ++t) {
      const Vec3 p = shape.mesh.corner(t, 0), n = cross(shape.mesh.corner(t, 1) - p, shape.mesh.corner(t, 2) - p);
      for (const Vec3& corner : shape.mesh.vertices) EXPECT_LT(dot(n, corner - p), 1e-12);
    }
  }
}

TEST(PeerShapes, of_an_unknown_kind_or_size_are_refused) {
  EXPECT_THROW(make_peer_shapes("round", 80, 1, 1), UsageError);
  EXPECT_THROW(make_peer_shapes("rock", 100, 1, 1), UsageError);
  EXPECT_THROW(read_peer_shapes("no_such_folder"), InputError);
}

TEST(PeerShapes, are_placed_at_the_gap_that_is_asked) {
  const std::vector<PeerShape> shapes = make_peer_shapes("rock", 80, 2, 1);
  const auto scratch = make_mesh_distance_scratch();
  const Placement p = placed_near(shapes[0], shapes[1], {}, normalised(Vec3{1, 2, 3}), 1e-2, *scratch);
  EXPECT_NEAR(mesh_distance({&shapes[0].mesh, &shapes[0].bvh}, {&shapes[1].mesh, &shapes[1].bvh}, p, 1e9, *scratch), 1e-2, 1e-10);
}

TEST(PeerFiles, give_back_what_was_written) {
  const std::vector<PeerShape> shapes = make_peer_shapes("rock", 20, 2, 0.01);
  const std::string folder = testing::TempDir() + "/peer_shapes";
  write_peer_shapes(folder, shapes);
  const std::vector<PeerShape> again = read_peer_shapes(folder);
  ASSERT_EQ(again.size(), 2u);
  EXPECT_EQ(again[1].mesh.vertices, shapes[1].mesh.vertices);
  EXPECT_EQ(again[1].mesh.triangles, shapes[1].mesh.triangles);
  EXPECT_EQ(again[1].moments, shapes[1].moments);
  std::vector<PeerBody> bodies(2);
  bodies[1] = {1, {1.0 / 3, 2, 3}, normalised(Quat{1, 2, 3, 4}), {4, 5, 6}, {7, 8, 9}};
  write_peer_state(folder + "/a.state", bodies);
  const std::vector<PeerBody> read = read_peer_state(folder + "/a.state");
  ASSERT_EQ(read.size(), 2u);
  EXPECT_EQ(read[1].position, bodies[1].position);
  EXPECT_EQ(read[1].angular_velocity, bodies[1].angular_velocity);
  EXPECT_NEAR(read[1].orientation.z, bodies[1].orientation.z, 4e-16);
}

TEST(Judge, finds_the_depth_of_a_corner_in_a_cube) {
  // shifted along all axes, a corner of each cube lies 0.1 behind the nearest faces of the other
  const Verdict v = judge_state({cube(1)}, {at({2, 2, 2}), at({2.8, 2.85, 2.9})}, 10, 1000, 9.81, 0.01);
  EXPECT_EQ(v.intersecting_pairs, 1);
  EXPECT_EQ(v.touching_pairs, 1);
  EXPECT_NEAR(v.deepest, 0.1, 1e-12);
}

TEST(Judge, tells_touching_from_cutting_and_from_apart) {
  const std::vector<PeerShape> shapes = {cube(1)};
  const Verdict near = judge_state(shapes, {at({2, 2, 2}), at({3.005, 2, 2})}, 10, 1000, 9.81, 0.01);
  EXPECT_EQ(near.touching_pairs, 1);
  EXPECT_EQ(near.intersecting_pairs, 0);
  EXPECT_EQ(near.deepest, 0);
  const Verdict apart = judge_state(shapes, {at({2, 2, 2}), at({3.02, 2, 2})}, 10, 1000, 9.81, 0.01);
  EXPECT_EQ(apart.touching_pairs, 0);
}

TEST(Judge, sees_a_body_inside_another_and_one_behind_a_wall) {
  PeerBody inner = at({5, 5, 5});
  inner.shape = 1;
  const Verdict nested = judge_state({cube(2), cube(0.5)}, {at({5, 5, 5}), inner}, 10, 1000, 9.81, 0.01);
  EXPECT_EQ(nested.intersecting_pairs, 1);
  EXPECT_NEAR(nested.deepest, 0.75, 1e-12);
  const Verdict sunk = judge_state({cube(1)}, {at({9.7, 5, 0.3})}, 10, 1000, 9.81, 0.01);
  EXPECT_NEAR(sunk.deepest, 0.2, 1e-12);
}

TEST(Judge, adds_up_the_energies_of_closed_form) {
  PeerBody body = at({5, 5, 4});
  body.orientation = normalised(Quat{1, 2, 3, 4});
  body.velocity = {3, 0, 4};
  body.angular_velocity = {0, 2, 0};
  const Verdict v = judge_state({cube(1)}, {body}, 10, 1000, 10, 0.01);
  EXPECT_NEAR(v.kinetic, 0.5 * 1000 * 25 + 0.5 * (1000.0 / 6) * 4, 1e-9);
  EXPECT_NEAR(v.potential, 1000 * 10 * 4, 1e-9);
  EXPECT_EQ(v.largest_speed, 5);
}

}  // namespace
}  // namespace scree
