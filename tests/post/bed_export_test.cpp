// Packed beds for other programs: caps, grids and kinds of contacts against closed forms.
#include "post/bed/bed_export.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/geometry/extruded.hpp"
#include "core/geometry/mass_properties.hpp"
#include "core/surface/self_intersections.hpp"
#include "post/bed/closed_cut.hpp"
#include "post/bed/part_bodies.hpp"
#include "post/bed/solid_grid.hpp"
#include "post/run/drawn_meshes.hpp"
#include "post/statistics/contact_kinds.hpp"

namespace scree {
namespace {

constexpr double kPi = std::numbers::pi;

TriangleMesh moved(TriangleMesh mesh, const Vec3& by, const Quat& turn = {}) {
  for (Vec3& p : mesh.vertices) p = by + rotate(turn, p);
  return mesh;
}
double volume(const TriangleMesh& mesh) { return mass_properties(mesh).volume; }

TriangleMesh ball(double radius, int level = 3) {
  TriangleMesh mesh = icosphere(level);
  for (Vec3& p : mesh.vertices) p *= radius;
  return mesh;
}

/// A square tube: outer side 2, bore 1, from z = -0.5 to 0.5.
TriangleMesh square_tube() {
  CrossSection section;
  for (const double half : {1.0, 0.5}) {
    for (const auto& [x, y] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}) section.points.push_back({half * x, half * y});
  }
  for (std::int32_t k = 0; k < 4; ++k) {
    const std::int32_t n = (k + 1) % 4;
    section.triangles.push_back({k, n, 4 + n});
    section.triangles.push_back({k, 4 + n, 4 + k});
  }
  section.loops = {{0, 1, 2, 3}, {7, 6, 5, 4}};
  return extruded(section, 1);
}

TEST(ClosedCut, takes_a_corner_off_a_cube) {
  TriangleMesh cube = box_mesh({1, 1, 1});
  const Vec3 diagonal = normalised(Vec3{1, 1, 1});
  const double height = 0.1;  // of the corner: a pyramid of three right angles, volume sqrt(3)/2 height^3
  ASSERT_EQ(cut_off(cube, (std::sqrt(3) / 2 - height) * diagonal, diagonal, {0.5, 0.5, 0.5}, 0.2, 1e-9), CutOutcome::cut);
  EXPECT_EQ(open_edges(cube), 0U);
  EXPECT_NEAR(volume(cube), 1 - std::sqrt(3) / 2 * height * height * height, 1e-14);
  EXPECT_TRUE(find_crossing_pairs(cube).empty());
  EXPECT_EQ(cut_off(cube, 2 * diagonal, diagonal, {}, 0.2, 1e-9), CutOutcome::nothing);
}

TEST(ClosedCut, leaves_a_mesh_whose_part_beyond_is_deeper_than_allowed) {
  TriangleMesh cube = box_mesh({1, 1, 1});
  EXPECT_EQ(cut_off(cube, {0, 0, 0.2}, {0, 0, 1}, {0, 0, 0.5}, 0.2, 1e-9), CutOutcome::deep);
  EXPECT_EQ(volume(cube), volume(box_mesh({1, 1, 1})));
  EXPECT_EQ(cut_off(cube, {0, 0, 0.4}, {0, 0, 1}, {0, 0, 0.5}, 0.2, 1e-9), CutOutcome::cut);
  EXPECT_NEAR(volume(cube), 0.9, 1e-14);
}

TEST(ClosedCut, closes_a_face_with_a_hole) {
  TriangleMesh tube = square_tube();
  ASSERT_NEAR(volume(tube), 3, 1e-12);
  ASSERT_EQ(cut_off(tube, {0, 0, 0.4}, {0, 0, 1}, {0.75, 0, 0.5}, 0.2, 1e-9), CutOutcome::cut);
  EXPECT_EQ(open_edges(tube), 0U);
  EXPECT_NEAR(volume(tube), 2.7, 1e-12);
  EXPECT_TRUE(find_crossing_pairs(tube).empty());
}

TEST(ClosedCut, takes_off_the_part_near_the_place_alone) {
  // a U of three boxes, whose two feet reach as far: the plane meets both, one is cut
  CrossSection section;
  section.points = {{-1, -1}, {-0.5, -1}, {-0.5, 0.5}, {0.5, 0.5}, {0.5, -1}, {1, -1}, {1, 1}, {-1, 1}};
  section.triangles = {{0, 1, 2}, {0, 2, 7}, {2, 3, 7}, {3, 6, 7}, {3, 5, 6}, {3, 4, 5}};
  section.loops = {{0, 1, 2, 3, 4, 5, 6, 7}};
  TriangleMesh arch = extruded(section, 1);
  ASSERT_NEAR(volume(arch), 2 * 1.5 * 0.5 + 2 * 0.5, 1e-12);
  ASSERT_EQ(cut_off(arch, {0, -0.9, 0}, {0, -1, 0}, {0.7, -1, 0}, 0.2, 1e-9), CutOutcome::cut);
  EXPECT_EQ(open_edges(arch), 0U);
  EXPECT_NEAR(volume(arch), 2.5 - 0.1 * 0.5, 1e-12);
  double lowest_left = 0, lowest_right = 0;
  for (const Vec3& p : arch.vertices) (p.x < 0 ? lowest_left : lowest_right) = std::min(p.x < 0 ? lowest_left : lowest_right, p.y);
  EXPECT_EQ(lowest_left, -1);
  EXPECT_NEAR(lowest_right, -0.9, 1e-15);
}

TEST(ClosedCut, merges_short_edges_and_turns_flat_triangles) {
  TriangleMesh cube = box_mesh({1, 1, 1});
  const Vec3 diagonal = normalised(Vec3{1, 1, 1});
  ASSERT_EQ(cut_off(cube, (std::sqrt(3) / 2 - 1e-5) * diagonal, diagonal, {0.5, 0.5, 0.5}, 0.2, 1e-9), CutOutcome::cut);
  ASSERT_GT(cube.triangle_count(), 12);
  collapse_short_edges(cube, 1e-4);
  EXPECT_EQ(open_edges(cube), 0U);
  EXPECT_EQ(cube.triangle_count(), 12);
  EXPECT_NEAR(volume(cube), 1, 1e-4);
  // a vertex that lies almost on the diagonal of a face
  TriangleMesh flat = box_mesh({1, 1, 1});
  const Triangle t = flat.triangles[0];
  const Vec3 middle = 0.5 * (flat.corner(0, 0) + flat.corner(0, 1)) + 1e-9 * (flat.corner(0, 2) - flat.corner(0, 0));
  flat.vertices.push_back(middle);
  flat.triangles[0] = {t[0], t[1], 8};
  flat.triangles.push_back({t[1], t[2], 8});
  flat.triangles.push_back({t[2], t[0], 8});
  ASSERT_EQ(open_edges(flat), 0U);
  flip_flat_triangles(flat, 1e-6);
  EXPECT_EQ(open_edges(flat), 0U);
  EXPECT_EQ(flat.triangle_count(), 14);
  for (std::int32_t k = 0; k < flat.triangle_count(); ++k)
    EXPECT_GT(length(cross(flat.corner(k, 1) - flat.corner(k, 0), flat.corner(k, 2) - flat.corner(k, 0))), 0.1);
}

double parted(std::vector<TriangleMesh>& bodies, double diameter, const std::vector<TriangleMesh>& walls = {},
              const Periodicity& period = {}, const std::vector<BedContact>& contacts = {}) {
  const std::vector<double> diameters(bodies.size(), diameter);
  const Parting parting = part_bodies(bodies, diameters, walls, period, contacts, {0.02});
  EXPECT_EQ(parting.parted, 1U);
  EXPECT_TRUE(parting.left.empty());
  EXPECT_EQ(parting.self_crossings, 0U);
  for (const TriangleMesh& body : bodies) EXPECT_EQ(open_edges(body), 0U);
  return parting.smallest_gap;
}

TEST(PartBodies, takes_the_overlap_and_the_gap_off_two_boxes) {
  // face to face: apart by less than half a gap, and overlapping; with the contact point of a run, and without
  for (const double overlap : {0.01, -0.001}) {
    for (const bool has_contact : {true, false}) {
      std::vector<TriangleMesh> boxes{box_mesh({1, 1, 1}), moved(box_mesh({1, 0.8, 0.8}), {1 - overlap, 0, 0})};
      std::vector<BedContact> contacts;
      if (has_contact) contacts.push_back({0, 1, {0.5 - 0.5 * overlap, 0.1, 0.1}, {-1, 0, 0}});
      EXPECT_NEAR(parted(boxes, 1, {}, {}, contacts), 0.02, 1e-6);
      // without a contact point the plane is that of the curve in which they cross, the face of the larger one
      const double share = has_contact || overlap < 0 ? 0.5 : 0;
      EXPECT_NEAR(volume(boxes[0]), 1 - (share * overlap + 0.01), 2e-7);
      EXPECT_NEAR(volume(boxes[1]), 0.64 * (1 - ((1 - share) * overlap + 0.01)), 2e-7);
    }
  }
}

TEST(PartBodies, parts_boxes_whose_curve_of_crossing_is_not_plane) {
  std::vector<TriangleMesh> boxes{box_mesh({1, 1, 1}), moved(box_mesh({1, 1, 1}), {0.99, 0.3, 0.2})};
  EXPECT_NEAR(parted(boxes, 1), 0.02, 1e-6);
  for (const TriangleMesh& box : boxes) EXPECT_NEAR(volume(box), 1, 0.5 * (0.01 + 0.02) + 1e-6);
}

TEST(PartBodies, takes_the_caps_of_two_balls) {
  const double overlap = 0.02, height = 0.5 * (overlap + 0.02);
  std::vector<TriangleMesh> balls{ball(0.5, 5), moved(ball(0.5, 5), {0.6, 0, 0.8 - overlap * 0.8}, {})};
  balls[1] = moved(ball(0.5, 5), (1 - overlap) * Vec3{0.6, 0, 0.8});
  const double whole = volume(balls[0]);
  EXPECT_NEAR(parted(balls, 1), 0.02, 1e-4);
  const double cap = kPi * height * height * (1.5 - height) / 3;
  for (const TriangleMesh& b : balls) EXPECT_NEAR(whole - volume(b), cap, 0.02 * cap);
}

TEST(PartBodies, takes_the_whole_gap_off_a_body_at_a_wall) {
  // a cube stands on its corner, 0.01 deep in the floor
  const Vec3 diagonal = normalised(Vec3{1, 1, 1}), axis = normalised(cross(-diagonal, Vec3{0, 0, -1}));
  const Quat turn = quaternion_of(axis, std::acos(dot(-diagonal, Vec3{0, 0, -1})));
  std::vector<TriangleMesh> cubes{moved(box_mesh({1, 1, 1}), {0, 0, std::sqrt(3) / 2 - 0.01}, turn)};
  TriangleMesh floor;
  floor.vertices = {{-2, -2, 0}, {2, -2, 0}, {2, 2, 0}, {-2, 2, 0}};
  floor.triangles = {{0, 1, 2}, {0, 2, 3}};
  EXPECT_NEAR(parted(cubes, 1, {floor}), 0.02, 1e-6);
  EXPECT_NEAR(1 - volume(cubes[0]), std::sqrt(3) / 2 * 0.03 * 0.03 * 0.03, 1e-7);
}

TEST(PartBodies, finds_neighbours_across_a_periodic_side) {
  const Periodicity period({0, 0, 0}, {4, 4, 4}, {true, false, false});
  std::vector<TriangleMesh> cubes{moved(box_mesh({1, 1, 1}), {0.2, 2, 2}), moved(box_mesh({1, 1, 1}), {3.21, 2, 2})};
  EXPECT_NEAR(parted(cubes, 1, {}, period), 0.02, 1e-6);
  // the second reaches to 3.71, the image of the first begins at 3.7
  for (const TriangleMesh& cube : cubes) EXPECT_NEAR(volume(cube), 1 - 0.5 * (0.01 + 0.02), 2e-7);
}

TEST(PartBodies, leaves_a_hollow_surface_whole) {
  // a ball that touches the inside of a bore all around: the tube keeps its volume, the ball loses a band
  std::vector<TriangleMesh> bodies{square_tube(), ball(0.505, 4)};
  const std::vector<double> diameters{1, 1};
  const double tube = volume(bodies[0]), whole = volume(bodies[1]);
  const Parting parting = part_bodies(bodies, diameters, {}, {}, {}, {0.02});
  EXPECT_TRUE(parting.left.empty());
  EXPECT_GE(parting.smallest_gap, 0.9 * 0.5 * 0.02);
  EXPECT_NEAR(volume(bodies[0]), tube, 0.01 * tube);
  EXPECT_LT(volume(bodies[1]), whole);
}

TEST(SolidGrid, gives_the_exact_share_of_every_cell) {
  // the corner of space under x + y + z = 1 in cells of 1/5: whole cells, 5/6 and 1/6 of those that the plane cuts
  TriangleMesh corner;
  corner.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  corner.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  const int n = 5;
  SolidGrid grid({{0, 0, 0}, {0.2, 0.2, 0.2}, {n, n, n}});
  grid.add(corner);
  const std::vector<double> share = grid.fractions();
  for (int z = 0; z < n; ++z) {
    for (int y = 0; y < n; ++y) {
      for (int x = 0; x < n; ++x) {
        const int sum = x + y + z;
        const double expected = sum + 3 <= n ? 1 : sum + 2 == n ? 5.0 / 6 : sum + 1 == n ? 1.0 / 6 : 0;
        EXPECT_NEAR(share[static_cast<std::size_t>((z * n + y) * n + x)], expected, 1e-13) << x << " " << y << " " << z;
      }
    }
  }
}

TEST(SolidGrid, holds_the_volume_of_what_lies_in_it) {
  const TriangleMesh turned = moved(square_tube(), {0.1, -0.2, 0.3}, quaternion_of(normalised(Vec3{1, 2, 3}), 0.7));
  const GridCells whole{{-2, -2, -2}, {0.13, 0.17, 0.11}, {31, 24, 37}};
  SolidGrid grid(whole);
  grid.add(turned);
  double sum = 0;
  for (const double share : grid.fractions()) sum += share * whole.cell_volume();
  EXPECT_NEAR(sum, volume(turned), 1e-12);
  // level faces in the planes of the grid, the highest one and an inner one
  SolidGrid level({{-0.5, -0.5, -0.5}, {0.1, 0.1, 0.1}, {10, 10, 10}});
  level.add(box_mesh({1, 1, 1}));
  for (const double share : level.fractions()) EXPECT_NEAR(share, 1, 1e-12);
  SolidGrid half({{-0.5, -0.5, -0.5}, {0.1, 0.1, 0.1}, {10, 10, 10}});
  half.add(box_mesh({1, 1, 0.4}));
  const std::vector<double> shares = half.fractions();
  for (std::size_t i = 0; i < shares.size(); ++i) EXPECT_NEAR(shares[i], i / 100 >= 3 && i / 100 < 7 ? 1 : 0, 1e-12) << i;
  // a grid that a box sticks out of on all sides is full, one that it lies beyond is empty
  const GridCells inner{{-0.5, -0.5, -0.5}, {0.25, 0.25, 0.25}, {4, 4, 4}};
  SolidGrid full(inner), none(inner);
  full.add(box_mesh({2, 2, 2}));
  none.add(box_mesh({1, 1, 1}), {0, 0, 3});
  none.add(box_mesh({1, 1, 1}), {0, 3, 0});
  for (const double share : full.fractions()) EXPECT_NEAR(share, 1, 1e-14);
  for (const double share : none.fractions()) EXPECT_NEAR(share, 0, 1e-14);
}

TEST(BedWalls, are_whole_where_they_are_in_the_frame_and_open_across_periodic_axes) {
  Scene scene;
  Wall box;
  box.kind = WallKind::box_inside;
  box.lower = {-1, -2, 0};
  box.upper = {1, 2, 30};
  const Quat quarter = quaternion_of(Vec3{0, 0, 1}, kPi / 2);
  Box3 room;
  room.add(Vec3{4.9, -0.1, 0});
  room.add(Vec3{5.1, 0.1, 0.2});
  const Box3 placed = bounding_box(wall_surface_in({}, box, scene, {{5, 0, 0}, quarter}, room, 0));
  EXPECT_NEAR(length(placed.lower - Vec3{3, -1, 0}), 0, 1e-12);
  EXPECT_NEAR(length(placed.upper - Vec3{7, 1, 30}), 0, 1e-12);
  scene.settings.domain.periodic = {true, false, false};
  EXPECT_EQ(wall_surface_in({}, box, scene, {}, room, 0).triangle_count(), 8);
  Wall tube;
  tube.kind = WallKind::cylinder_inside;
  tube.axis_start = {-1, 0, 0};
  tube.axis_end = {1, 0, 0};
  tube.radius = 0.5;
  const TriangleMesh sides = wall_surface_in({}, tube, scene, {}, room, 1e-4);
  EXPECT_NEAR(surface_area(sides), 2 * kPi * 0.5 * 2, 1e-3);
  for (std::int32_t t = 0; t < sides.triangle_count(); ++t) {
    const Vec3 middle = (1.0 / 3) * (sides.corner(t, 0) + sides.corner(t, 1) + sides.corner(t, 2));
    EXPECT_GT(std::hypot(middle.y, middle.z), 0.5 - 1.01e-4);
  }
  Wall plane;
  plane.normal = {0, 0, 1};
  const Box3 square = bounding_box(wall_surface_in({}, plane, scene, {{100, 0, 0.3}, quarter}, room, 0));
  EXPECT_TRUE(square.lower.x < 4.9 && square.upper.x > 5.1 && square.lower.y < -0.1 && square.upper.y > 0.1);
  EXPECT_NEAR(square.lower.z, 0.3, 1e-15);
}

/// Two cubes of volume 1 and a floor, with contact points put there.
struct ContactsByHand {
  scree::Run run;
  Frame frame;
  ContactsByHand() {
    Scene& scene = run.scene;
    scene.settings.output_contacts = true;
    scene.materials = {{"rock", 2000, 0, 0}};
    scene.shapes = {make_solid("cube", box_mesh({1, 1, 1}))};
    Wall floor;
    floor.id = 100;
    scene.walls = {floor};
    run.boundary_ids = {floor.id};
    for (std::int64_t id : {0, 1}) {
      FrameBodies& b = frame.bodies;
      b.id.push_back(id);
      b.shape.push_back(0);
      b.material.push_back(0);
      b.rank.push_back(0);
      b.scale.push_back(1);
      b.position.push_back({0, 0, 0.5 + static_cast<double>(id)});
      b.orientation.push_back({});
      b.velocity.push_back({});
      b.angular_velocity.push_back({});
    }
  }
  void touch(std::int64_t a, std::int64_t b, const Vec3& point, const Vec3& normal, double force = 1) {
    FrameContacts& c = frame.contacts;
    c.body_a.push_back(a);
    c.body_b.push_back(b);
    c.feature.push_back(static_cast<std::int64_t>(c.size()));
    c.point.push_back(point);
    c.normal.push_back(normal);
    c.overlap.push_back(1e-3);
    c.margin.push_back(0);
    c.normal_force.push_back(force);
    c.tangential_force.push_back({});
  }
};

TEST(ContactKinds, are_told_by_the_extent_of_the_contact_points) {
  ContactsByHand made;
  const Vec3 down{0, 0, -1};
  for (const auto& [x, y] : {std::pair{-0.5, -0.5}, {0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}}) made.touch(0, 1, {x, y, 1}, down);
  made.touch(0, 1, {0, 0, 1}, down, 0);  // carries nothing
  for (const double x : {-0.4, 0.0, 0.3}) made.touch(0, 100, {x, 0.5, 0}, -down);
  made.touch(1, 100, {0.5, 0.5, 1}, normalised(Vec3{-1, 0, 0}));  // a box wall: a side and a corner of another
  made.touch(1, 100, {0.5, 0.52, 1}, normalised(Vec3{-1, 0, 0}));
  made.touch(1, 100, {0.5, 0.5, 1}, normalised(Vec3{0, -1, 0}));
  const SceneFacts facts(made.run, std::nullopt, made.frame);
  const FrameView view(facts, made.frame);
  const std::vector<SurfaceContact> contacts = surface_contacts(view);
  ASSERT_EQ(contacts.size(), 4U);
  EXPECT_EQ(contacts[0].kind, ContactKind::face);
  EXPECT_EQ(contacts[0].points, 4);
  EXPECT_NEAR(contacts[0].length, std::sqrt(2), 1e-15);
  EXPECT_NEAR(contacts[0].width, std::sqrt(2) / 2, 1e-15);
  EXPECT_EQ(contacts[1].kind, ContactKind::edge);
  EXPECT_NEAR(contacts[1].length, 0.7, 1e-15);
  EXPECT_EQ(contacts[2].kind, ContactKind::point);
  EXPECT_EQ(contacts[2].points, 2);
  EXPECT_EQ(contacts[3].kind, ContactKind::point);
  const std::vector<BodyConstraints> bodies = body_constraints(view, contacts);
  EXPECT_EQ(bodies[0].with_friction, 0.5 * 6 + 5);
  EXPECT_EQ(bodies[1].with_friction, 0.5 * 6 + 3 + 3);
  EXPECT_EQ(bodies[0].without_friction, 3 + 2);
  EXPECT_EQ(bodies[1].without_friction, 3 + 1 + 1);
  const ConstraintMeasures all = constraint_measures(view, {"all"}, bodies);
  EXPECT_EQ(all.with_friction, 8.5);
  EXPECT_EQ(all.face, 1);
  EXPECT_EQ(all.edge, 0.5);
  EXPECT_EQ(all.point, 1);
}

}  // namespace
}  // namespace scree
