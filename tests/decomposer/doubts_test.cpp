// What is allowed and mostly a slip is told in one line with numbers; what is plainly fine is not.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <filesystem>
#include <nlohmann/json.hpp>

#include <cmath>
#include <numbers>

#include "core/base/error.hpp"
#include "decomposer/packing/build_scene.hpp"
#include "decomposer/packing/case_warnings.hpp"
#include "tests/support/margins.hpp"

namespace scree {
namespace {

// Balls of 12 mm in a box of 80 mm: nothing to doubt.
const std::string kCase = R"(
gravity = [0, 0, -9.81]
[time]
duration = 2
stop_at_rest = false
[output]
every = 0.1
[contact]
margin = 0.0001
[shapes.ball]
sphere = { radius = 0.006 }
[materials.stone]
density = 2700
[[pairs]]
between = ["stone", "stone"]
stiffness = 1e4
restitution = 0.5
friction = 0.5
[[populations]]
shape = "ball"
material = "stone"
count = 20
region = { box = [[0, 0, 0], [0.08, 0.08, 0.08]] }
[[walls]]
name = "crate"
shape = { box_inside = [[0, 0, 0], [0.08, 0.08, 0.08]] }
material = "stone"
)";

std::vector<std::string> doubts(const std::vector<std::pair<std::string, std::string>>& changes) {
  std::string text = kCase;
  for (const auto& [from, to] : changes) {
    EXPECT_NE(text.find(from), std::string::npos) << from;
    for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size())) text.replace(at, from.size(), to);
  }
  return build_scene(test::touching_outside(parse_case(text, "case.toml", ""))).report.case_warnings;
}

/// One doubt, with these words.
void expect_doubt(const std::vector<std::pair<std::string, std::string>>& changes, const std::vector<std::string>& says) {
  const std::vector<std::string> found = doubts(changes);
  ASSERT_EQ(found.size(), 1u) << changes[0].second << (found.empty() ? "" : ": " + found[0] + (found.size() > 1 ? " | " + found[1] : ""));
  for (const std::string& part : says) EXPECT_NE(found[0].find(part), std::string::npos) << "'" << part << "' not in: " << found[0];
}

TEST(Doubts, there_is_none_of_a_case_that_is_plainly_fine) {
  EXPECT_EQ(doubts({}), std::vector<std::string>{});
  EXPECT_EQ(doubts({{"friction = 0.5", "friction = 0"}}), std::vector<std::string>{});
  EXPECT_EQ(doubts({{"duration = 2", "duration = 0"}}), std::vector<std::string>{});
}

TEST(Doubts, a_density_in_grams_per_cubic_centimetre) {
  expect_doubt({{"2700", "2.7"}, {"stiffness = 1e4", "stiffness = 10"}}, {"materials.stone.density = 2.7 kg/m^3", "\"2.7 g/cm^3\""});
  expect_doubt({{"2700", "2.7e6"}, {"stiffness = 1e4", "stiffness = 1e7"}}, {"2.7e+06 kg/m^3", "more than any metal"});
}

TEST(Doubts, a_box_of_80_metres_around_balls_of_12_millimetres) {
  expect_doubt({{"0.08", "80"}, {"margin = 0.0001", "impact_speed = 1\nmargin = 0.0001"}},
               {"walls[0] (wall 'crate') is 80 m long", "12 mm across", "6667 times less"});
}

TEST(Doubts, a_wall_that_is_tiny_beside_the_bodies) {
  expect_doubt(
      {{"[[walls]]\nname",
        "[[walls]]\nname = \"tray\"\nmaterial = \"stone\"\nshape = { plate = { corner = [-1, 0, 0], side_a = [0.0001, 0, 0], side_b = "
        "[0, 0.0001, 0] } }\n[[walls]]\nname"}},
      {"wall 'tray'", "100 um long", "120 times as much"});
}

TEST(Doubts, a_region_and_a_container_that_reach_beyond_the_domain) {
  const std::string domain = "[domain]\nmin = [0, 0, 0]\nmax = [0.06, 0.08, 0.08]\n[contact]";
  const std::vector<std::string> found = doubts({{"[contact]", domain}});
  ASSERT_EQ(found.size(), 2u);
  EXPECT_NE(found[0].find("populations[0].region reaches 20 mm beyond domain.max x: bodies are placed in the part"), std::string::npos)
      << found[0];
  EXPECT_NE(found[1].find("walls[0] (wall 'crate') reaches 20 mm beyond domain.max x"), std::string::npos) << found[1];
  EXPECT_EQ(doubts({{"[contact]", "[domain]\nmin = [0, 0, 0]\nmax = [0.08, 0.08, 0.08]\n[contact]"}}), std::vector<std::string>{});
  // where bodies may leave, the container may reach farther; through a periodic side nothing leaves
  const std::string removes = domain.substr(0, domain.size() - 9) + "outside = \"remove\"\n[contact]";
  expect_doubt({{"[contact]", removes}}, {"populations[0].region reaches 20 mm"});
  const std::string periodic = domain.substr(0, domain.size() - 9) + "periodic = [\"x\"]\n[contact]";
  EXPECT_EQ(doubts({{"[contact]", periodic},
                    {"box_inside = [[0, 0, 0], [0.08, 0.08, 0.08]]", "plane = { point = [0, 0, 0], normal = [0, 0, 1] }"}}),
            std::vector<std::string>{});
}

TEST(Doubts, a_step_that_the_solver_refuses) {
  expect_doubt({{"duration = 2", "duration = 2\nstep = 0.1"}},
               {"time.step = 100 ms is", "times the time that a contact of the lightest body", "give at most"});
  EXPECT_EQ(doubts({{"duration = 2", "duration = 2\nstep = 1e-5"}}), std::vector<std::string>{});
}

TEST(Doubts, friction_that_is_left_out) {
  expect_doubt({{"friction = 0.5\n", ""}}, {"no friction is given", "stone on stone", "write friction = 0"});
}

TEST(Doubts, friction_in_degrees) { expect_doubt({{"friction = 0.5", "friction = 30"}}, {"friction = 30", "coefficient", "0.577"}); }

TEST(Doubts, a_region_that_reaches_through_a_closed_wall) {
  const std::pair<std::string, std::string> drum{
      "shape = { box_inside = [[0, 0, 0], [0.08, 0.08, 0.08]] }",
      "shape = { drum = { start = [0.04, 0.04, -0.01], end = [0.04, 0.04, 0.09], radius = 0.03 } }"};
  const auto is_named = [](const std::vector<std::string>& found) {
    return std::any_of(found.begin(), found.end(), [](const std::string& text) {
      return text.find("closed wall 'crate'") != std::string::npos && text.find("inside") != std::string::npos &&
             text.find("outside") != std::string::npos;
    });
  };
  EXPECT_TRUE(is_named(doubts({drum})));
  EXPECT_FALSE(is_named(doubts(
      {drum, {"count = 20", "count = 2"}, {"box = [[0, 0, 0], [0.08, 0.08, 0.08]]", "box = [[0.03, 0.03, 0], [0.05, 0.05, 0.08]]"}})));
}

TEST(Doubts, bonds_within_a_material_of_which_no_body_has_pieces) {
  std::string text = kCase;
  text += "[[bonds]]\nwithin = \"stone\"\nyoung = 1e7\n";
  const std::vector<std::string> notices = build_scene(test::touching_outside(parse_case(text, "case.toml", ""))).report.notices;
  EXPECT_TRUE(std::any_of(notices.begin(), notices.end(), [](const std::string& notice) {
    return notice.find("bonds[0].within = \"stone\"") != std::string::npos && notice.find("hold nothing") != std::string::npos;
  }));
}

TEST(Doubts, two_walls_of_one_name) {
  const std::string lid =
      "name = \"crate\"\nshape = { plane = { point = [0, 0, 0.2], normal = [0, 0, -1] } }\nmaterial = \"stone\"\n[[walls]]\nname = "
      "\"crate\"";
  expect_doubt({{"name = \"crate\"", lid}}, {"walls[1].name = \"crate\"", "is the name of", "walls[0]"});
}

TEST(Doubts, a_temperature_of_liquid_gases) {
  const std::pair<std::string, std::string> heat{"[contact]", "[heat]\ntemperature = 20\n[contact]"},
      stone{"density = 2700", "density = 2700\nyoung = 5e10\npoisson = 0.25\nheat_capacity = 800\nconductivity = 2"};
  const auto is_named = [](const std::vector<std::string>& found) {
    return std::any_of(found.begin(), found.end(),
                       [](const std::string& text) { return text.find("was \"20 degC\" meant?") != std::string::npos; });
  };
  EXPECT_TRUE(is_named(doubts({heat, stone})));
  EXPECT_FALSE(is_named(doubts({heat, stone, {"temperature = 20", "temperature = 293"}})));
}

TEST(Doubts, gravity_in_millimetres) {
  expect_doubt({{"-9.81", "-9810"}, {"stiffness = 1e4", "stiffness = 1e7"}}, {"gravity of 9810 m/s^2", "\"9810 mm/s^2\""});
}

TEST(Doubts, a_run_shorter_than_a_contact) {
  // pi sqrt(2.44 g / (2 x 1e4)) = 1.1 ms
  expect_doubt({{"duration = 2", "duration = \"0.1 ms\""}, {"[output]\nevery = 0.1\n", ""}},
               {"time.duration = 100 us", "single contact", "1.098 ms"});
}

TEST(Doubts, a_run_of_more_steps_than_anyone_waits_for) {
  expect_doubt({{"duration = 2", "duration = 1e5"}, {"every = 0.1", "every = 1e4"}}, {"2.7e+09 steps of 36.6 us", "2.443 g"});
}

TEST(Doubts, a_stiffness_that_does_not_carry_a_body) {
  // 2.44 g x 9.81 / 150 N/m = 160 um of 200 um
  expect_doubt({{"stiffness = 1e4", "stiffness = 150"}, {"margin = 0.0001", "impact_speed = 0.01\nmargin = 0.0001"}},
               {"pairs[0]", "2.443 g", "159.8 um", "0.80 of the margins"});
}

TEST(Doubts, a_modulus_without_its_giga) {
  expect_doubt({{"stiffness = 1e4\n", ""},
                {"density = 2700", "density = 2700\nyoung = 70"},
                {"margin = 0.0001", "law = \"hertz-mindlin\"\nimpact_speed = 0.01"},
                {"-9.81", "-1e-9"}},
               {"materials.stone.young = 70 Pa", "\"70 GPa\""});
}

TEST(Doubts, output_less_often_than_the_run_is_long_and_far_too_often) {
  expect_doubt({{"every = 0.1", "every = 10"}}, {"output.every = 10 s is longer than the run of 2 s"});
  expect_doubt({{"every = 0.1", "every = 1e-6"}}, {"output.every = 1 us", "2e+06 frames"});
}

TEST(Doubts, a_wall_that_starts_after_the_end) {
  expect_doubt({{"name = \"crate\"", "name = \"crate\"\nmotion = { translate = { velocity = [0, 0, 1] }, start = 5 }"}},
               {"wall 'crate' starts to move at 5 s", "ends at 2 s"});
}

TEST(Doubts, rest_that_nothing_leads_to) {
  expect_doubt(
      {{"stop_at_rest = false", "stop_at_rest = true"}, {"restitution = 0.5", "restitution = 1"}, {"friction = 0.5", "friction = 0"}},
      {"nothing comes to rest"});
}

TEST(Doubts, bodies_that_nothing_holds) {
  expect_doubt({{"[[walls]]\nname = \"crate\"\nshape = { box_inside = [[0, 0, 0], [0.08, 0.08, 0.08]] }\nmaterial = \"stone\"\n", ""}},
               {"nothing holds the bodies", "19.62 m until the end"});
}

TEST(Doubts, a_liquid_as_light_as_a_gas) {
  const auto in_fluid = [](const std::string& density) {
    return std::vector<std::pair<std::string, std::string>>{
        {"[contact]", "[fluid]\ndensity = " + density + "\nviscosity = \"1 mPa s\"\n[contact]"}};
  };
  expect_doubt(in_fluid("1"), {"fluid.density = 1 kg/m^3", "\"1 g/cm^3\""});
  EXPECT_EQ(doubts(in_fluid("1000")), std::vector<std::string>{});
}

TEST(Doubts, an_impact_faster_than_sound) {
  expect_doubt({{"count = 20", "count = 20\nvelocity = [500, 0, 0]"},
                {"stiffness = 1e4", "stiffness = 1e9"},
                {"duration = 2", "duration = 0.01"},
                {"every = 0.1", "every = 0.001"}},
               {"fastest impact to expect is 1", "km/s"});
}

TEST(Doubts, a_bridge_that_fills_the_room_and_a_neck_as_wide_as_its_balls) {
  const auto wet = [](const std::string& volume) {
    return std::vector<std::pair<std::string, std::string>>{
        {"friction = 0.5", "friction = 0.5\nsurface_tension = 0.072\nbridge_volume = " + volume}};
  };
  // R = 2 R* = 12 mm, of a ball on a wall
  expect_doubt(wet("2e-7"), {"pairs[0]", "bridge_volume is 0.12 R^3", "12 mm", "0.1 R^3"});
  EXPECT_EQ(doubts(wet("1e-8")), std::vector<std::string>{});
  const auto sticky = [](const std::string& work) {
    return std::vector<std::pair<std::string, std::string>>{
        {"margin = 0.0001", "margin = 0.002\nlaw = \"hertz-mindlin\""},
        {"density = 2700", "density = 2700\nyoung = 1e7"},
        {"stiffness = 1e4", "adhesion_model = \"jkr\"\nadhesion_hysteresis = true\nadhesion = " + work}};
  };
  expect_doubt(sticky("500"), {"pairs[0]", "R* = 6 mm", "% of R*", "JKR"});
  EXPECT_EQ(doubts(sticky("5")), std::vector<std::string>{});
}

TEST(Doubts, a_rest_that_a_servo_or_a_free_wall_never_lets_come) {
  const std::string lid =
      "[[walls]]\nname = \"lid\"\nmaterial = \"stone\"\nshape = { plane = { point = [0, 0, 0.09], normal = [0, 0, -1] } }\n"
      "motion = { servo = { direction = [0, 0, -1], force = 1, max_speed = 0.1 }STOP }\n[[walls]]\nname = \"crate\"";
  const auto with = [&](const std::string& stop) {
    std::string text = lid;
    return text.replace(text.find("STOP"), 4, stop);
  };
  expect_doubt({{"stop_at_rest = false", "stop_at_rest = true"}, {"[[walls]]\nname = \"crate\"", with("")}},
               {"time.stop_at_rest: case.toml:", "walls[0]: wall 'lid' (servo) may move until the end (2 s)", "give its motion a stop"});
  EXPECT_EQ(doubts({{"stop_at_rest = false", "stop_at_rest = true"}, {"[[walls]]\nname = \"crate\"", with(", stop = 1")}}),
            std::vector<std::string>{});
}

TEST(Doubts, an_attraction_whose_range_is_not_small_beside_the_bodies) {
  const auto pair = [](const char* range) { return std::string("friction = 0.5\npull_off = 1e-3\nadhesion_range = ") + range; };
  expect_doubt({{"friction = 0.5", pair("0.008")}},
               {"adhesion_range = 8 mm is 1.3 of the radius of the smallest body (12 mm across)", "600 um or less"});
  EXPECT_EQ(doubts({{"friction = 0.5", pair("0.0005")}}), std::vector<std::string>{});
}

// The crate of the case as another wall.
std::vector<std::pair<std::string, std::string>> with_wall(const std::string& shape, const std::string& more = "") {
  return {{"shape = { box_inside = [[0, 0, 0], [0.08, 0.08, 0.08]] }", "shape = " + shape + more}};
}

TEST(Doubts, gravity_that_points_up_or_away_from_every_wall) {
  const auto floor = with_wall("{ plane = { point = [0, 0, 0], normal = [0, 0, 1] } }");
  EXPECT_EQ(doubts(floor), std::vector<std::string>{});
  auto up = floor;
  up.push_back({"[0, 0, -9.81]", "[0, 0, 9.81]"});
  expect_doubt(up, {"gravity = [0, 0, 9.81] points away from every wall", "19.62 m", "is its direction right?"});
  auto aside = with_wall("{ box = { corners = [[-0.01, -0.01, -0.01], [0.09, 0.09, 0.09]], open = [\"+y\"] } }");
  EXPECT_EQ(doubts(aside), std::vector<std::string>{});
  aside.push_back({"[0, 0, -9.81]", "[0, 9.81, 0]"});
  expect_doubt(aside, {"gravity = [0, 9.81, 0] points away from every wall"});
}

TEST(Doubts, an_outlet_that_is_smaller_than_the_bodies) {
  const auto hopper = [](const std::string& outlet) {
    return with_wall("{ hopper = { outlet = " + outlet + ", bin = 0.2, half_angle = \"60 deg\", bin_height = 0.1 } }",
                     "\nposition = [0.04, 0.04, -0.06]");
  };
  EXPECT_EQ(doubts(hopper("0.03")), std::vector<std::string>{});
  expect_doubt(hopper("0.011"), {"walls[0]", "wall 'crate' has an opening", "11 mm wide", "12 mm", "none passes"});
  const auto outlet = [](const std::string& top) {
    return std::vector<std::pair<std::string, std::string>>{
        {"[[walls]]", "[[outlets]]\nname = \"out\"\nregion = { box = [[0, 0, 0], [0.08, 0.08, " + top + "]] }\n[[walls]]"}};
  };
  EXPECT_EQ(doubts(outlet("0.012")), std::vector<std::string>{});
  expect_doubt(outlet("0.004"), {"the outlet 'out' is 4 mm thick", "12 mm"});
}

TEST(Doubts, a_wall_with_a_hole_where_a_triangle_is_missing) {
  const auto folder = std::filesystem::temp_directory_path() / ("scree_doubts_hole_" + std::to_string(::getpid()));
  std::filesystem::create_directory(folder);
  // a tray of 100 mm in squares of 10 mm
  TriangleMesh tray;
  for (int i = 0; i <= 10; ++i)
    for (int j = 0; j <= 10; ++j) tray.vertices.push_back({-0.01 + 0.01 * i, -0.01 + 0.01 * j, -0.001});
  for (std::int32_t i = 0; i < 10; ++i) {
    for (std::int32_t j = 0; j < 10; ++j) {
      const std::int32_t k = 11 * i + j;
      tray.triangles.push_back({k, k + 11, k + 12});
      tray.triangles.push_back({k, k + 12, k + 1});
    }
  }
  const auto of_tray = [&](const std::string& name) {
    const std::string file = (folder / (name + ".shape.h5")).string();
    write_shape_file(file, {make_surface("tray", tray)}, {});
    return with_wall("{ file = \"" + file + "\" }");
  };
  EXPECT_EQ(doubts(of_tray("whole")), std::vector<std::string>{});
  tray.triangles.erase(tray.triangles.begin() + 90);
  expect_doubt(of_tray("torn"),
               {"walls[0]", "wall 'crate' has a hole", "10 mm wide with 3 edges", "the smallest body is 12 mm", "scree-mesher repair"});
  std::filesystem::remove_all(folder);
}

TEST(Doubts, revolutions_a_minute_that_are_taken_for_radians_a_second) {
  const auto drum = [](const std::string& rate) {
    return std::vector<std::pair<std::string, std::string>>{{"shape = { box_inside = [[0, 0, 0], [0.08, 0.08, 0.08]] }",
                                                             "shape = { cylinder_inside = { start = [0.04, -0.01, 0.04], end = [0.04, "
                                                             "0.09, 0.04], radius = 0.06 } }\nmotion = { rotate = { axis = [0, "
                                                             "1, 0], centre = [0.04, 0, 0.04], rate = " +
                                                                 rate + " } }"},
                                                            {"[contact]", "[contact]\nimpact_speed = 1"}};
  };
  EXPECT_EQ(doubts(drum("\"30 rpm\"")), std::vector<std::string>{});
  // 30^2 x 0.06 / 9.81 = 5.5, and 0.06 at 30 rpm
  expect_doubt(drum("30"),
               {"wall 'crate' turns at 30 rad/s (286.5 rpm)", "Froude number of 5.5", "was \"30 rpm\" (3.142 rad/s, 0.06) meant?"});
}

TEST(Doubts, a_margin_above_a_fifth_of_a_radius) {
  const auto folder = std::filesystem::temp_directory_path() / ("scree_doubts_margin_" + std::to_string(::getpid()));
  std::filesystem::create_directory(folder);
  const std::string file = (folder / "cube.shape.h5").string();
  write_shape_file(file, {make_solid("cube", box_mesh({0.01, 0.01, 0.01}))}, {});
  const auto cubes = [&](const std::string& margin) {
    return std::vector<std::pair<std::string, std::string>>{{"sphere = { radius = 0.006 }", "file = \"" + file + "\""},
                                                            {"margin = 0.0001", "margin = " + margin}};
  };
  // the ball of the same volume has a radius of 6.2 mm
  EXPECT_EQ(doubts(cubes("0.001")), std::vector<std::string>{});
  expect_doubt(cubes("0.0015"), {"contact.margin is 0.24 of the radius", "6.204 mm", "rounded by 1.5 mm"});
  std::filesystem::remove_all(folder);
}

// docs/reference/contact-law.md section 3.7: two equal contacts that share nothing are 2^(1/4) as stiff as one.
TEST(Facets, two_that_balls_lie_on_are_one_contact_or_two) {
  EXPECT_EQ(stiffness_of_two_facets(0), 0);
  EXPECT_NEAR(stiffness_of_two_facets(kFacetAngle), std::pow(2, 0.25) - 1, 1e-12);
  EXPECT_NEAR(stiffness_of_two_facets(3.04 * std::numbers::pi / 180), 0.02, 5e-4);
}

std::vector<Facets> facets_in(const std::string& wall) {
  std::string text = kCase;
  const std::string box = "{ box_inside = [[0, 0, 0], [0.08, 0.08, 0.08]] }";
  text.replace(text.find(box), box.size(), wall);
  return build_scene(test::touching_outside(parse_case(text, "case.toml", ""))).report.facets;
}

TEST(Facets, of_a_tube_around_balls_are_reported_and_those_of_a_tube_beside_them_are_not) {
  const auto tube = [](double x, double radius, int segments) {
    return fmt::format("{{ cylinder = {{ start = [{0}, 0.04, -0.05], end = [{0}, 0.04, 0.15], radius = {1}, segments = {2} }} }}", x,
                       radius, segments);
  };
  const std::vector<Facets> around = facets_in(tube(0.04, 0.07, 64));
  ASSERT_EQ(around.size(), 1U);
  EXPECT_EQ(around[0].wall, "crate");
  EXPECT_EQ(around[0].edges, 64);
  EXPECT_NEAR(around[0].angle, 2 * std::numbers::pi / 64, 1e-6);
  EXPECT_NEAR(around[0].stiffer, 0.188, 1e-3);
  EXPECT_LT(facets_in(tube(0.04, 0.07, 256)).at(0).stiffer, 2e-3);
  EXPECT_TRUE(facets_in(tube(0.2, 0.07, 64)).empty());
}

}  // namespace
}  // namespace scree
