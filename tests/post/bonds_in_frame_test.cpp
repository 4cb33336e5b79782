// Faces of bonds, fragments apart and their colours, of bodies whose places are known.
#include "post/run/bonds_in_frame.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/base/error.hpp"
#include "post/run/body_colours.hpp"

namespace scree {
namespace {

/// Balls of one size in a row along x, 2 cm apart; 0-1-2 bonded at the start, 3 never. The faces are 3 mm x 1 mm across x, turned by 30
/// degrees about it, and the bodies by 90 degrees about z.
struct Row {
  Run run;
  Frame frame;
};

Row row_of_balls() {
  Row row;
  Scene& scene = row.run.scene;
  scene.shapes = {make_sphere("ball", 0.01)};
  scene.materials = {{"m", 1000, 0, 0}};
  const Quat turn = quaternion_of({0, 0, 1}, 0.5 * std::numbers::pi);
  for (std::int64_t id = 0; id < 4; ++id) {
    BodyRow body;
    body.id = id;
    body.position = {0.02 * static_cast<double>(id), 0, 0};
    body.orientation = turn;
    scene.bodies.add(body);
  }
  for (std::int64_t a = 0; a < 2; ++a) {
    Bond bond;
    bond.a = a;
    bond.b = a + 1;
    bond.point_a = rotate_inverse(turn, Vec3{0.01, 0.001, 0});
    bond.point_b = rotate_inverse(turn, Vec3{-0.01, 0.001, 0});
    bond.frame_a = bond.frame_b = conjugate(turn) * quaternion_of({1, 0, 0}, std::numbers::pi / 6);
    bond.area = 3e-6;
    bond.moment_1 = 3e-3 * 1e-9 / 12;  // about y, over which the face is 3 mm wide
    bond.moment_2 = 1e-3 * 27e-9 / 12;
    scene.bonds.push_back(bond);
  }
  row.frame.bodies.id = scene.bodies.id;
  row.frame.bodies.shape = scene.bodies.shape;
  row.frame.bodies.material = scene.bodies.material;
  row.frame.bodies.scale = scene.bodies.scale;
  row.frame.bodies.position = scene.bodies.position;
  row.frame.bodies.orientation = scene.bodies.orientation;
  row.frame.bodies.velocity.assign(4, {});
  row.frame.bodies.angular_velocity.assign(4, {});
  row.frame.bodies.rank.assign(4, 0);
  row.frame.has_bonds = true;
  return row;
}

void let_hold(Frame& frame, std::int64_t bond, const Vec3& force) {
  frame.bonds.bond.push_back(bond);
  frame.bonds.force.push_back(force);
  frame.bonds.energy.push_back(2e-6);
  frame.bonds.load.push_back(0.25);
}

TEST(BondsInFrame, a_face_is_a_rectangle_where_both_sides_meet_and_bears_force_over_area) {
  Row row = row_of_balls();
  row.frame.bodies.position[1].x += 1e-4;  // opened
  let_hold(row.frame, 0, {6.0, 0, 1.5});   // on body 0: pulled along x
  let_hold(row.frame, 1, {-3.0, 0, 0});    // pressed
  const std::vector<BondFace> faces = bond_faces(row.run.scene, row.frame);
  ASSERT_EQ(faces.size(), 2u);
  const auto& c = faces[0].corners;
  EXPECT_NEAR(length(0.25 * (c[0] + c[1] + c[2] + c[3]) - Vec3{0.01 + 0.5e-4, 0.001, 0}), 0, 1e-15);
  EXPECT_NEAR(length(c[1] - c[0]), 3e-3, 1e-15);
  EXPECT_NEAR(length(c[3] - c[0]), 1e-3, 1e-15);
  // its long side is 30 degrees from y, about x
  EXPECT_NEAR(length(normalised(c[1] - c[0]) - Vec3{0, std::sqrt(0.75), 0.5}), 0, 1e-13);
  EXPECT_NEAR(faces[0].normal_stress, 2e6, 1e-6);
  EXPECT_NEAR(faces[0].shear_stress, 0.5e6, 1e-6);
  EXPECT_NEAR(faces[1].normal_stress, -1e6, 1e-6);
  EXPECT_EQ(faces[1].load, 0.25);
  EXPECT_EQ(bond_quantity("shear_stress").value, &BondFace::shear_stress);
  EXPECT_THROW(bond_quantity("stress"), UsageError);
  // a body that is not in the frame has no face
  take_rows(row.frame.bodies, {1, 2, 3});
  ASSERT_EQ(bond_faces(row.run.scene, row.frame).size(), 1u);
  EXPECT_EQ(bond_faces(row.run.scene, row.frame)[0].body_a, 1);
}

TEST(BondsInFrame, fragments_move_from_the_middle_of_their_parent_and_what_is_whole_stays) {
  Row row = row_of_balls();
  let_hold(row.frame, 0, {});
  let_hold(row.frame, 1, {});
  for (const Vec3& way : ways_apart(row.run.scene, row.frame)) EXPECT_EQ(length(way), 0);
  row.frame.bonds = {};
  let_hold(row.frame, 0, {});  // 0-1 and 2; the middle of all three is that of 1
  const Frame apart = taken_apart(row.run.scene, row.frame, 0.5);
  EXPECT_NEAR(apart.bodies.position[0].x, 0.5 * (0.01 - 0.02), 1e-15);
  EXPECT_NEAR(apart.bodies.position[1].x - apart.bodies.position[0].x, 0.02, 1e-15);
  EXPECT_NEAR(apart.bodies.position[2].x, 0.04 + 0.5 * 0.02, 1e-15);
  EXPECT_EQ(apart.bodies.position[3].x, row.frame.bodies.position[3].x);
}

TEST(BondsInFrame, a_fragment_keeps_the_colour_of_its_lowest_body) {
  Row row = row_of_balls();
  let_hold(row.frame, 1, {});  // 0 and 1-2
  const BodyColours colours = body_colours(row.run, RunBodies(row.run), row.frame, "fragment");
  EXPECT_EQ(colours.value, (std::vector<double>{0, 1, 1, 3}));
  EXPECT_EQ(colours.kinds, (std::map<int, std::string>{{0, "1 piece"}, {1, "2 pieces"}, {3, "without bonds"}}));
  row.run.scene.bonds.clear();
  EXPECT_THROW(body_colours(row.run, RunBodies(row.run), row.frame, "fragment"), UsageError);
}

}  // namespace
}  // namespace scree
