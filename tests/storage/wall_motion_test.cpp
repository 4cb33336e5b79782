// Every kind of wall motion that is prescribed: velocities are derivatives of the pose, no point is faster than it says, and files bring it
// back.
#include "core/storage/wall_motion.hpp"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/error.hpp"
#include "core/storage/scene_settings.hpp"
#include "core/storage/wall_axis.hpp"
#include "core/storage/wall_state.hpp"

namespace scree {
namespace {

/// One of each kind that answers to force, from 0.2 to 0.9 s.
std::vector<WallMotion> answering() {
  std::vector<WallMotion> all;
  for (const MotionKind& kind : std::initializer_list<MotionKind>{
           Servo{.axis = {0, 2, 1}, .centre = {0.1, 0, 1.0 / 3}, .torque = 2, .max_rate = 3, .swing = {-0.1, 0.7}},
           OuterMotion{.axis = {0, 2, 1}, .centre = {0.1, 0, 1.0 / 3}, .max_rate = 3, .swing = {-0.1, 0.7}},
           Free{.hinge = {1, 2, 3},
           .centre = {0.1, -0.2, 1.0 / 3},
           .mass = 2,
           .inertia = 0.3,
           .mass_centre = {0.2, 0.2, 0},
           .torque = -1,
           .turn_damping = 0.1},
           Motor{.axis = normalised(Vec3{1, 2, 3}), .centre = {0.1, -0.2, 1.0 / 3}, .torque = 5, .inertia = 0.2, .max_rate = 4}}) {
    all.push_back({kind, 0.2, 0.9});
  }
  return all;
}

/// One of each other kind, from 0.2 to 0.9 s. A new kind that is missing here fails the test below.
std::vector<WallMotion> one_of_each() {
  std::vector<WallMotion> all;
  for (const MotionKind& kind : std::initializer_list<MotionKind>{
           Rotate{.axis = normalised(Vec3{1, 2, 3}), .centre = {0.1, -0.2, 1.0 / 3}, .rate = 5},
           Translate{.axis = normalised(Vec3{0, 1, -2}), .rate = -2.0 / 3},
           Oscillate{.axis = normalised(Vec3{1, 0, 1}), .amplitude = 0.02, .frequency = 7, .phase = 0.4},
           FollowTable{.time = {0, 0.3, 0.5, 0.9}, .position = {{0, 0, 0}, {0.1, 0, 1.0 / 7}, {0.1, 0.2, 0}, {0, 0, -0.1}}}}) {
    all.push_back({kind, 0.2, 0.9});
  }
  return all;
}

const std::vector<Vec3> kPoints{{0.3, 0, 0}, {-1, 0.5, 0.2}, {0, 0, 2}, {0.7, -0.7, -0.1}};

TEST(WallMotion, is_tested_here_in_every_kind) {
  std::vector<std::string> tested, known;
  for (const auto& some : {one_of_each(), answering()}) {
    for (const WallMotion& m : some) tested.emplace_back(m.word());
  }
  for_each_motion([&](auto kind) { known.emplace_back(kind.kWord); });
  EXPECT_EQ(tested, known);
}

TEST(WallMotion, has_the_velocity_with_which_its_pose_changes) {
  const Pose start{{0.5, 0.1, 0}, quaternion_of(normalised(Vec3{0, 1, 1}), 0.3)};
  for (const WallMotion& m : one_of_each()) {
    for (double time = 0.0137; time < 1.2; time += 0.0371) {
      constexpr double h = 1e-6;
      const MotionState before = m.state(time - h, start), now = m.state(time, start), after = m.state(time + h, start);
      EXPECT_LE(length((1 / (2 * h)) * (after.pose.position - before.pose.position) - now.velocity), 1e-6) << m.word() << " at " << time;
      const Quat turn = after.pose.orientation * conjugate(before.pose.orientation);
      EXPECT_LE(length((1 / h) * Vec3{turn.x, turn.y, turn.z} - now.angular_velocity), 1e-6) << m.word() << " at " << time;
    }
    EXPECT_EQ(m.state(0, start).pose.position, m.state(0.2, start).pose.position) << m.word();
    EXPECT_EQ(m.state(0.9, start).pose.position, m.state(7, start).pose.position) << m.word();
  }
}

TEST(WallMotion, is_never_faster_than_it_says_and_reaches_that_speed) {
  for (const WallMotion& m : one_of_each()) {
    double fastest = 0;
    for (double time = 0; time < 1; time += 1e-4) {
      const MotionState now = m.state(time, {});
      for (const Vec3& p : kPoints)
        fastest = std::max(fastest, length(now.velocity + cross(now.angular_velocity, rotate(now.pose.orientation, p))));
    }
    const double said = m.fastest(kPoints);
    EXPECT_LE(fastest, said * (1 + 1e-12)) << m.word();
    EXPECT_GE(fastest, said * (1 - 1e-3)) << m.word();
  }
}

TEST(WallMotion, stays_in_the_box_around_its_displacements) {
  for (const WallMotion& m : one_of_each()) {
    if (m.turn_axis()) continue;
    Vec3 lower, upper;
    for (const Vec3& d : m.displacements(1)) {
      lower = component_min(lower, d);
      upper = component_max(upper, d);
    }
    for (double time = 0; time <= 1; time += 1e-3) {
      const Vec3 d = m.state(time, {}).pose.position;
      for (int k = 0; k < 3; ++k) EXPECT_TRUE(d[k] >= lower[k] - 1e-15 && d[k] <= upper[k] + 1e-15) << m.word() << " at " << time;
    }
  }
}

TEST(WallMotion, ends_when_its_pose_changes_for_the_last_time) {
  for (WallMotion m : one_of_each()) {
    EXPECT_DOUBLE_EQ(m.end(), 0.9) << m.word();
    m.stop = 1e300;
    EXPECT_EQ(m.end(), std::holds_alternative<FollowTable>(m.kind) ? 0.2 + 0.9 : 1e300) << m.word();
  }
  EXPECT_EQ(WallMotion{}.end(), 0);
  EXPECT_FALSE((WallMotion{Rotate{.rate = 0}, 0, 1e300}.moves()));
  EXPECT_FALSE((WallMotion{Oscillate{.amplitude = 1}, 0, 1e300}.moves()));
  EXPECT_FALSE((WallMotion{FollowTable{.time = {0, 1}, .position = {{1, 0, 0}, {1, 0, 0}}}, 0, 1e300}.moves()));
}

TEST(WallMotion, that_answers_to_force_goes_where_its_drive_is) {
  for (const WallMotion& m : answering()) {
    Wall wall;
    wall.position = {0.5, 0.1, 0};
    wall.orientation = quaternion_of(normalised(Vec3{0, 1, 1}), 0.3);
    wall.motion = m;
    EXPECT_EQ(wall_state(wall, 0.5).position, wall.position) << m.word() << ": nobody has moved it";
    const DriveState drive{.way = 0.4, .rate = 1.5, .rate_before = 0.5};
    const WallState state = wall_state(wall, 0.5, 1e-3, &drive);
    const TurnAxis axis = *m.turn_axis();
    EXPECT_LT(length(state.angular_velocity - 1.5 * axis.direction), 1e-15) << m.word();
    EXPECT_LT(length(state.angular_velocity_before - 0.5 * axis.direction), 1e-15) << m.word();
    EXPECT_EQ(state.pivot, axis.point) << m.word();
    const Rotate same{.axis = axis.direction, .centre = axis.point, .rate = 1.5};
    const MotionState there = same.state(0.4 / 1.5, {wall.position, wall.orientation});
    EXPECT_LT(length(there.pose.position - state.position), 1e-15) << m.word();
    EXPECT_LT(length(there.velocity - state.velocity), 1e-15) << m.word();
  }
  Wall wall;
  wall.motion.kind = Servo{.direction = {0, 0, -3}, .stress = 5, .area = 2, .max_speed = 1};
  const DriveState drive{.way = 0.4, .rate = 1.5, .rate_before = 0.5};
  const WallState state = wall_state(wall, 0.5, 1e-3, &drive);
  EXPECT_EQ(state.position, (Vec3{0, 0, -0.4}));
  EXPECT_EQ(state.velocity, (Vec3{0, 0, -1.5}));
  EXPECT_EQ(state.velocity_before, (Vec3{0, 0, -0.5}));
  EXPECT_EQ(state.pivot_velocity_before, (Vec3{0, 0, -0.5}));
  EXPECT_EQ(wall.motion.drive()->push, 10);
}

TEST(WallMotion, has_the_axis_of_the_last_part_that_turns_where_later_parts_have_carried_it) {
  const double quarter = 0.5 * std::numbers::pi;
  Wall wall;
  EXPECT_FALSE(own_axis(wall, 1));
  const WallMotion turn{Rotate{.axis = {0, 1, 0}, .centre = {1, 0, 2}, .rate = 3}}, go{Translate{.axis = {1, 0, 0}, .rate = 0.5}};
  wall.motion = turn;
  EXPECT_EQ(own_axis(wall, 7)->point, (Vec3{1, 0, 2}));
  wall.motion.kind = Several{{turn, go}};
  EXPECT_LT(length(own_axis(wall, 4)->point - Vec3{3, 0, 2}), 1e-14);
  EXPECT_EQ(own_axis(wall, 4)->direction, (Vec3{0, 1, 0}));
  wall.motion.kind = Several{{go, turn}};
  EXPECT_EQ(own_axis(wall, 4)->point, (Vec3{1, 0, 2})) << "what goes before the turn does not move its axis";
  // the surface of a wall that is turned by a quarter about z: its axis turns along
  wall.motion = go;
  wall.surface.motion.kind = Rotate{.axis = {1, 0, 0}, .centre = {0, 1, 0}, .rate = 2};
  EXPECT_LT(length(own_axis(wall, 2)->point - Vec3{1, 1, 0}), 1e-14);
  EXPECT_EQ(own_axis(wall, 2)->direction, (Vec3{1, 0, 0}));
  // a wall that turns itself has that axis, whatever its surface does
  wall.motion.kind = Rotate{.axis = {0, 0, 1}, .rate = quarter};
  EXPECT_EQ(own_axis(wall, 1)->direction, (Vec3{0, 0, 1}));
  // (7, 8, 9) - (1, 0, 2) x (4, 5, 6) along y
  EXPECT_DOUBLE_EQ(axis_torque({{1, 0, 2}, {0, 1, 0}}, {4, 5, 6}, {7, 8, 9}), 6);
}

// The weight of a part on a hinge goes with its arm.
TEST(WallMotion, on_a_hinge_weighs_by_its_arm) {
  const Drive d = Free{.hinge = {0, 1, 0}, .centre = {1, 0, 0}, .mass = 2, .inertia = 1, .mass_centre = {1.5, 0, 0}}.drive();
  for (const double way : {0.0, 0.7, -2.0}) EXPECT_NEAR(d.weight({0, 0, -10}, way), 2 * 10 * 0.5 * std::cos(way), 1e-14) << way;
}

TEST(WallMotion, moves_with_the_origin_of_the_world) {
  const Vec3 origin{3, -4, 5}, place{0.5, 0.1, 0};
  for (const WallMotion& m : one_of_each()) {
    WallMotion moved = m;
    moved.move_origin(origin);
    for (const double time : {0.1, 0.3, 0.6, 2.0}) {
      const Vec3 there = m.state(time, {place, {}}).pose.position, here = moved.state(time, {place - origin, {}}).pose.position;
      EXPECT_LE(length(there - here - origin), 1e-14) << m.word();
    }
  }
}

TEST(WallMotion, says_in_words_what_it_does) {
  std::vector<std::string> texts{WallMotion{}.text()};
  for (const WallMotion& m : one_of_each()) texts.push_back(m.text());
  EXPECT_EQ(texts, (std::vector<std::string>{"fixed", "rotates at 5 rad/s", "translates at -0.6667 m/s", "oscillates by 0.02 m at 7 Hz",
                                             "follows a table"}));
}

/// Pairs of the kinds above, in both orders, and three at once.
std::vector<WallMotion> several() {
  std::vector<WallMotion> all;
  const std::vector<WallMotion> each = one_of_each();
  for (std::size_t i = 0; i < each.size(); ++i) {
    for (std::size_t j = 0; j < each.size(); ++j) {
      if (i != j) all.push_back({Several{{each[i], each[j]}}, 0, 1e300});
    }
  }
  const Rotate other{.axis = normalised(Vec3{-1, 1, 0.5}), .centre = {0.4, 0.3, -0.2}, .rate = -3};
  all.push_back({Several{{each[0], each[2], {other, 0.1, 0.7}}}, 0, 1e300});
  return all;
}

TEST(SeveralMotions, have_the_velocity_with_which_their_pose_changes) {
  const Pose start{{0.5, 0.1, 0}, quaternion_of(normalised(Vec3{0, 1, 1}), 0.3)};
  for (const WallMotion& m : several()) {
    for (double time = 0.0137; time < 1.2; time += 0.0371) {
      constexpr double h = 1e-6;
      const MotionState before = m.state(time - h, start), now = m.state(time, start), after = m.state(time + h, start);
      EXPECT_LE(length((1 / (2 * h)) * (after.pose.position - before.pose.position) - now.velocity), 1e-6) << m.text() << " at " << time;
      const Quat turn = after.pose.orientation * conjugate(before.pose.orientation);
      EXPECT_LE(length((1 / h) * Vec3{turn.x, turn.y, turn.z} - now.angular_velocity), 1e-6) << m.text() << " at " << time;
    }
    EXPECT_EQ(m.end(), 0.9) << m.text();
    EXPECT_TRUE(m.moves());
  }
}

TEST(SeveralMotions, are_never_faster_than_they_say) {
  for (const WallMotion& m : several()) {
    double fastest = 0;
    for (double time = 0; time < 1; time += 1e-3) {
      const MotionState now = m.state(time, {});
      for (const Vec3& p : kPoints)
        fastest = std::max(fastest, length(now.velocity + cross(now.angular_velocity, rotate(now.pose.orientation, p))));
    }
    EXPECT_LE(fastest, m.fastest(kPoints) * (1 + 1e-12)) << m.text();
  }
}

TEST(SeveralMotions, apply_the_second_to_where_the_first_has_the_wall) {
  const Rotate quarter{.axis = {0, 0, 1}, .centre = {0, 0, 0}, .rate = std::numbers::pi / 2};
  const Translate along{.axis = {1, 0, 0}, .rate = 2};
  const Pose place{{1, 0, 0}, {}};
  const WallMotion turned_first{Several{{{quarter, 0, 1}, {along, 0, 1}}}, 0, 1e300};
  const WallMotion turned_last{Several{{{along, 0, 1}, {quarter, 0, 1}}}, 0, 1e300};
  EXPECT_LT(length(turned_first.state(5, place).pose.position - Vec3{2, 1, 0}), 1e-15);
  EXPECT_LT(length(turned_last.state(5, place).pose.position - Vec3{0, 3, 0}), 1e-15);
}

// A wheel that rolls: a cycloid; arms are taken to the hub, which goes along.
TEST(SeveralMotions, carry_the_pivot_along) {
  const double radius = 0.2, speed = 3;
  Wall wheel;
  wheel.position = {radius, 0, radius};
  wheel.motion.kind = Several{{{Rotate{.axis = {0, 1, 0}, .centre = {0, 0, radius}, .rate = speed / radius}, 0, 1e300},
                               {Translate{.axis = {1, 0, 0}, .rate = speed}, 0, 1e300}}};
  for (const double time : {0.01, 0.3, 1.7}) {
    const double angle = speed * time / radius, h = 1e-3;
    const WallState s = wall_state(wheel, time, h);
    EXPECT_LT(length(s.position - Vec3{speed * time + radius * std::cos(angle), 0, radius - radius * std::sin(angle)}), 1e-13);
    EXPECT_LT(length(s.pivot - Vec3{speed * time, 0, radius}), 1e-13);
    EXPECT_LT(length(s.pivot_velocity_before - Vec3{speed, 0, 0}), 1e-12);
    const Vec3 foot{speed * time, 0, 0};  // where it touches the ground it stands still
    EXPECT_LT(length(s.velocity + cross(s.angular_velocity, foot - s.position)), 1e-12);
  }
}

TEST(SeveralMotions, move_with_the_origin_and_start_earlier) {
  const Vec3 origin{3, -4, 5}, place{0.5, 0.1, 0};
  for (const WallMotion& m : several()) {
    WallMotion moved = m, earlier = m;
    moved.move_origin(origin);
    earlier.advance_clock(0.25);
    for (const double time : {0.1, 0.3, 0.6, 2.0}) {
      const Vec3 there = m.state(time, {place, {}}).pose.position, here = moved.state(time, {place - origin, {}}).pose.position;
      EXPECT_LE(length(there - here - origin), 1e-13) << m.text();
      EXPECT_LE(length(earlier.state(time - 0.25, {place, {}}).pose.position - there), 1e-13) << m.text();
    }
  }
}

nlohmann::json scene_text(const WallMotion& m) {
  Scene scene;
  scene.materials.push_back({"steel", 7800, 0, 0});
  Wall wall;
  wall.motion = m;
  scene.walls.push_back(wall);
  return settings_json(scene);
}

WallMotion read_again(const nlohmann::json& text) {
  Scene scene;
  read_settings_json(text, "X", scene);
  return scene.walls[0].motion;
}

TEST(WallMotion, comes_back_from_a_file_bit_for_bit) {
  const Pose start{{0.5, 0.1, 0}, quaternion_of(normalised(Vec3{0, 1, 1}), 0.3)};
  std::vector<WallMotion> all = one_of_each();
  all.emplace_back();
  for (const WallMotion& m : answering()) all.push_back(m);
  for (const WallMotion& m : several()) all.push_back(m);
  for (const WallMotion& m : all) {
    const WallMotion again = read_again(nlohmann::json::parse(scene_text(m).dump()));
    EXPECT_STREQ(again.word(), m.word());
    EXPECT_EQ(scene_text(again), scene_text(m)) << m.word();
    for (const double time : {0.0, 0.31, 0.62, 5.0}) {
      EXPECT_EQ(again.state(time, start).pose.position, m.state(time, start).pose.position) << m.word();
      EXPECT_EQ(again.state(time, start).pose.orientation, m.state(time, start).pose.orientation) << m.word();
    }
  }
}

// Readers of older versions ask for the members of all kinds in every motion.
TEST(WallMotion, is_written_as_older_readers_expect_it) {
  const nlohmann::json text = scene_text({Translate{.axis = {1, 0, 0}, .rate = 2}, 0.5, 1e300})["walls"][0]["motion"];
  EXPECT_EQ(text.dump(),
            "{\"amplitude\":0.0,\"axis\":[1.0,0.0,0.0],\"centre\":[0.0,0.0,0.0],\"frequency\":0.0,\"kind\":\"translate\",\"phase\":0.0,"
            "\"rate\":2.0,\"start\":0.5,\"stop\":1e+300,\"table_position\":[],\"table_time\":[]}");
}

TEST(WallMotion, that_cannot_be_is_refused_by_name) {
  const auto message_for = [](nlohmann::json text, const char* place, const nlohmann::json& value) -> std::string {
    text[nlohmann::json::json_pointer(std::string("/walls/0/motion") + place)] = value;
    try {
      read_again(text);
    } catch (const InputError& e) {
      return e.what();
    }
    return "";
  };
  const nlohmann::json turns = scene_text(one_of_each()[0]), table = scene_text(one_of_each()[3]);
  EXPECT_EQ(message_for(turns, "/kind", "magic"),
            "X.walls[0].motion.kind: 'magic' found, expected one of none, rotate, translate, oscillate, table, servo, outer, free, motor");
  EXPECT_EQ(message_for(turns, "/axis", {0, 0, 2}), "X.walls[0].motion.axis: length 2 found, a unit vector expected");
  EXPECT_EQ(message_for(table, "/table_time", {0, 1}),
            "X.walls[0].motion: time has 2 rows and position 4; expected as many, and at least one");
  EXPECT_EQ(message_for(table, "/table_time", {0, 1, 1, 2}), "X.walls[0].motion: time must ascend");
}

}  // namespace
}  // namespace scree
