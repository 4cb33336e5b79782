// Regions, frames and bodies that a user chooses.
#include "post/run/choice.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "core/base/error.hpp"
#include "post/run/contact_network.hpp"
#include "tests/post/sample_run.hpp"

namespace scree {
namespace {

TEST(Region, volumes_are_the_textbooks) {
  EXPECT_DOUBLE_EQ(parse_region("box:0,0,0,1,2,3").volume(), 6);
  EXPECT_DOUBLE_EQ(parse_region("bed=cylinder:0,0,0,0,0,2,0.5").volume(), std::numbers::pi / 2);
  EXPECT_DOUBLE_EQ(parse_region("sphere:1,1,1,10 cm").volume(), 4e-3 / 3 * std::numbers::pi);
  EXPECT_EQ(parse_region("bed=cylinder:0,0,0,0,0,2,0.5").name, "bed");
}

TEST(Region, the_part_of_a_segment_inside_has_the_length_of_the_chord) {
  const Region ball = parse_region("sphere:0,0,0,1");
  const auto chord = ball.part_inside({-2, 0.6, 0}, {2, 0.6, 0});  // half chord sqrt(1 - 0.36) = 0.8
  ASSERT_TRUE(chord.has_value());
  EXPECT_DOUBLE_EQ(chord->first, 0.3);
  EXPECT_DOUBLE_EQ(chord->second, 0.7);
  EXPECT_FALSE(ball.part_inside({-2, 1.1, 0}, {2, 1.1, 0}).has_value());
  const Region tube = parse_region("cylinder:0,0,0,0,0,1,1");
  const auto slanted = tube.part_inside({0, 0, -1}, {0, 0, 3});  // along the axis
  ASSERT_TRUE(slanted.has_value());
  EXPECT_DOUBLE_EQ(slanted->first, 0.25);
  EXPECT_DOUBLE_EQ(slanted->second, 0.5);
  const auto across = tube.part_inside({-2, 0, 0.5}, {2, 0, 0.5});
  ASSERT_TRUE(across.has_value());
  EXPECT_DOUBLE_EQ(across->second - across->first, 0.5);
  const Region box = parse_region("box:0,0,0,1,1,1");
  const auto diagonal = box.part_inside({-1, -1, -1}, {2, 2, 2});
  ASSERT_TRUE(diagonal.has_value());
  EXPECT_NEAR(diagonal->second - diagonal->first, 1.0 / 3, 1e-15);
  EXPECT_FALSE(box.part_inside({-1, 0.5, 0.5}, {-0.5, 0.5, 0.5}).has_value());
}

TEST(Region, points_on_the_side_between_two_boxes_are_in_one_of_them) {
  const Region low = parse_region("box:0,0,0,1,1,1"), high = parse_region("box:0,0,1,1,1,2");
  for (const double z : {0.0, 0.5, 1.0, 1.5}) EXPECT_NE(low.contains({0.5, 0.5, z}), high.contains({0.5, 0.5, z})) << z;
}

TEST(Region, a_wrong_text_is_refused_with_what_was_expected) {
  for (const char* text : {"box:1,2,3", "ring:0,0,0,1", "sphere:0,0,0,1 s", "box:0,0,0,1,1,0"})
    EXPECT_THROW(parse_region(text), UsageError) << text;
}

class Choice : public testing::Test {
 protected:
  static void SetUpTestSuite() { test::write_sample_run(std::filesystem::path(SCREE_TEST_FOLDER) / "choice" / "sample.run"); }
  scree::Run run = open_run(std::string(SCREE_TEST_FOLDER) + "/choice/sample.run");
};

TEST_F(Choice, frames_are_chosen_by_number_range_and_step) {
  using Indices = std::vector<std::size_t>;
  EXPECT_EQ(choose_frames(run, "all"), (Indices{0, 1, 2}));
  EXPECT_EQ(choose_frames(run, "last"), Indices{2});
  EXPECT_EQ(choose_frames(run, "-1,0"), (Indices{0, 2}));
  EXPECT_EQ(choose_frames(run, "1:"), (Indices{1, 2}));
  EXPECT_EQ(choose_frames(run, "::2"), (Indices{0, 2}));
  for (const char* text : {"7", "2:1", "a", "0:2:0", "1:2:1:1"}) EXPECT_THROW(choose_frames(run, text), UsageError) << text;
}

TEST_F(Choice, a_part_of_a_frame_has_its_bodies_and_the_contacts_among_them) {
  BodyChoice choice;
  choice.ids = {"2-4", "9"};
  const Frame part = ChosenBodies(choice, run.scene).part_of(load_frame(run, 1), run.boundary_ids);
  EXPECT_EQ(part.bodies.id, (std::vector<std::int64_t>{2, 3, 4, 9}));
  EXPECT_EQ(part.contacts.body_a, (std::vector<std::int64_t>{2, 3}));  // the sample has contacts i, i + 1
  EXPECT_EQ(part.bodies.position[3], load_frame(run, 1).bodies.position[9]);
  choice.ids.clear();
  choice.shapes = {"ball"};
  EXPECT_EQ(ChosenBodies(choice, run.scene).part_of(load_frame(run, 1), run.boundary_ids).bodies.size(), 4u);
  choice.shapes = {"bal"};
  EXPECT_THROW(ChosenBodies(choice, run.scene), UsageError);
}

TEST(ContactNetwork, a_pair_is_one_line_and_a_wall_one_for_each_point) {
  Frame frame;
  frame.bodies.id = {0, 2};  // body 1 was taken out
  frame.bodies.position = {{0, 0, 0}, {1, 0, 0}};
  test::add_contact(frame, 0, 2, 0, {-1, 0, 0}, 3);
  test::add_contact(frame, 0, 2, 1, {-1, 0, 0}, 1);
  test::add_contact(frame, 0, 9, 0, {0, 0, 1}, 2);
  test::add_contact(frame, 0, 9, 1, {0, 1, 0}, 5);
  const std::vector<NetworkLine> lines = network_of(frame, {});
  ASSERT_EQ(lines.size(), 3u);
  EXPECT_EQ(lines[0].points, 2);
  EXPECT_EQ(lines[0].normal_force, 4);
  EXPECT_EQ(lines[0].force, (Vec3{-4, 0, 0}));
  EXPECT_EQ(lines[0].to, (Vec3{1, 0, 0}));
  EXPECT_EQ(lines[1].index_b, -1);
  EXPECT_EQ(lines[1].to, (Vec3{0.1, 0.2, 1.0 / 3}));  // where add_contact puts it
  EXPECT_EQ(lines[2].normal_force, 5);
}

TEST(ContactNetwork, a_line_takes_the_short_way_through_a_periodic_side) {
  Frame frame;
  frame.bodies.id = {0, 1};
  frame.bodies.position = {{0.05, 0, 0}, {0.95, 0, 0}};
  test::add_contact(frame, 0, 1, 0, {1, 0, 0}, 1);
  const std::vector<NetworkLine> lines = network_of(frame, Periodicity({0, 0, 0}, {1, 1, 1}, {true, false, false}));
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_NEAR(lines[0].to.x, -0.05, 1e-15);
}

}  // namespace
}  // namespace scree
