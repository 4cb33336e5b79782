// What bodies are coloured by, against the numbers that the made-up run is made of.
#include "post/run/body_colours.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/base/error.hpp"
#include "tests/post/sample_run.hpp"

namespace scree {
namespace {

scree::Run sample(const char* name) {
  return open_run(test::write_sample_run(std::filesystem::path(SCREE_TEST_FOLDER) / name / "sample.run"));
}

TEST(BodyColours, are_those_of_the_frame) {
  const auto run = sample("colours");
  const Frame frame = load_frame(run, 2);  // t = 0.2 s
  const auto value = [&](const char* name, std::size_t i) { return body_colours(run, RunBodies(run), frame, name).value[i]; };
  EXPECT_DOUBLE_EQ(value("velocity", 4), std::sqrt(0.01 + 1.0 / 9));
  EXPECT_DOUBLE_EQ(value("velocity-x", 4), 0.1);
  EXPECT_DOUBLE_EQ(value("velocity-z", 4), -1.0 / 3);
  EXPECT_DOUBLE_EQ(value("spin", 7), 7);
  EXPECT_DOUBLE_EQ(value("x", 1), 0.07 + 0.2 * 0.1);
  EXPECT_DOUBLE_EQ(value("start-x", 1), 0.07);
  EXPECT_DOUBLE_EQ(value("start-z", 11), 0.12);
  // body 5 is a ball of 1.5 cm, 1.1 times as large
  EXPECT_NEAR(value("size", 5), 0.033, 1e-15);
  const double mass = 2500 * std::numbers::pi / 6 * 0.033 * 0.033 * 0.033;
  EXPECT_NEAR(value("mass", 5), mass, 1e-12 * mass);
  EXPECT_NEAR(value("energy", 5), 0.5 * mass * (0.01 + 1.0 / 9), 1e-12 * mass);
  // a chain: body i presses on body i + 1 with 1 + i newtons
  EXPECT_DOUBLE_EQ(value("neighbours", 0), 1);
  EXPECT_DOUBLE_EQ(value("neighbours", 3), 2);
  EXPECT_DOUBLE_EQ(value("force", 0), 1);
  EXPECT_DOUBLE_EQ(value("force", 3), 3 + 4);
  EXPECT_DOUBLE_EQ(value("force", 11), 11);
}

TEST(BodyColours, of_kinds_name_what_the_scene_has) {
  const auto run = sample("kinds");
  const Frame frame = load_frame(run, 0);
  const BodyColours shapes = body_colours(run, RunBodies(run), frame, "shape");
  EXPECT_TRUE(shapes.are_kinds);
  EXPECT_EQ(shapes.kinds, (std::map<int, std::string>{{0, "box"}, {1, "wedge"}, {2, "ball"}}));
  EXPECT_EQ(shapes.value[4], 1);
  EXPECT_EQ(body_colours(run, RunBodies(run), frame, "material").kinds, (std::map<int, std::string>{{0, "rock"}}));
  EXPECT_EQ(body_colours(run, RunBodies(run), frame, "population").kinds, (std::map<int, std::string>{{0, "[[bodies]]"}}));
  EXPECT_FALSE(body_colours(run, RunBodies(run), frame, "id").are_kinds);
}

TEST(BodyColours, name_what_comes_in_through_inlets_and_know_where) {
  auto run = sample("inlets");
  Inlet feed, chute;
  feed.name = "feed";
  chute.name = "chute";
  run.scene.inlets = {feed, chute};
  std::ofstream(run.folder + "/inserted.csv") << "step,time,id,mass,diameter,x,y,z,shape,inlet\n# units: -,s,-,kg,m,m,m,m,-,-\n"
                                                 "1,0.1,100,1,0.03,1,2,3,ball,chute\n";
  Frame frame = load_frame(run, 0);
  frame.bodies.id.back() = 100;
  const RunBodies bodies(run);
  const BodyColours colours = body_colours(run, bodies, frame, "population");
  EXPECT_EQ(colours.kinds, (std::map<int, std::string>{{0, "[[bodies]]"}, {2, "inlet chute"}}));
  EXPECT_EQ(colours.value.front(), 0);
  EXPECT_EQ(colours.value.back(), 2);
  EXPECT_EQ(body_colours(run, bodies, frame, "start-y").value.back(), 2);
}

TEST(BodyColours, that_are_not_there_are_refused) {
  auto run = sample("refused");
  const Frame frame = load_frame(run, 0);
  EXPECT_THROW(body_colours(run, RunBodies(run), frame, "speeed"), UsageError);
  run.scene.settings.output_contacts = false;
  EXPECT_THROW(body_colours(run, RunBodies(run), frame, "force"), UsageError);
}

}  // namespace
}  // namespace scree
