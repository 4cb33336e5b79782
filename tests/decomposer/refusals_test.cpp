// What pack must not take without a word: amounts that give no body, walls that stand elsewhere when the run begins, and what the
// solver would refuse before its first step.
#include <gtest/gtest.h>

#include "core/base/error.hpp"
#include "decomposer/build_scene.hpp"

namespace scree {
namespace {

const std::string kHead = R"(
seed = 3
[time]
duration = 1
[shapes.ball]
sphere = { radius = 0.5 }
[shapes.pea]
sphere = { radius = 0.4 }
[materials.stone]
density = 2500
[[pairs]]
between = ["stone", "stone"]
stiffness = 1e7
restitution = 0.5
)";
const std::string kMargin = "[contact]\nmargin = \"2 mm\"\n";

PackedScene pack(const std::string& text) { return build_scene(parse_case(text, "case.toml", "")); }

std::string failure(const std::string& text, ExitCode code) {
  try {
    pack(text);
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), code) << e.what();
    return e.what();
  }
  ADD_FAILURE() << "nothing was refused";
  return "";
}

void expect_says(const std::string& message, const std::vector<std::string>& parts) {
  for (const std::string& part : parts) EXPECT_NE(message.find(part), std::string::npos) << "'" << part << "' not in: " << message;
}

std::string population(const std::string& amount, const std::string& shapes = "shape = \"ball\"\nsize = \"50 mm\"") {
  return "[[populations]]\n" + shapes + "\nmaterial = \"stone\"\n" + amount + "\nregion = { box = [[0, 0, 0], [1, 1, 1]] }\n";
}

// A ball of 50 mm and 2500 kg/m^3 weighs 163.6 g and takes 6.54e-5 of the region.
TEST(Refusals, an_amount_of_less_than_half_a_body_is_refused_with_the_size_of_one) {
  const std::string head = kHead + kMargin;
  expect_says(failure(head + population("mass = \"80 g\""), ExitCode::bad_data), {"populations[0]", "mass = 80 g", "half of one 'ball' of diameter 50 mm", "163.6 g"});
  EXPECT_EQ(pack(head + population("mass = \"83 g\"")).scene.bodies.size(), 1u);
  expect_says(failure(head + population("solid_fraction = 3e-5"), ExitCode::bad_data), {"solid_fraction = 3e-05", "half of one 'ball'", "6.54e-05 m^3"});
  EXPECT_EQ(pack(head + population("solid_fraction = 4e-5")).scene.bodies.size(), 1u);
  expect_says(failure(head + population("count = 0"), ExitCode::usage), {"populations[0].count = 0", "at least 1"});
}

TEST(Refusals, a_share_that_gives_not_one_body_is_refused_with_the_number_of_bodies) {
  const std::string mixture = "shapes = { ball = 0.98, pea = 0.02 }\nsize = \"50 mm\"";
  expect_says(failure(kHead + kMargin + population("count = 20", mixture), ExitCode::bad_data), {"populations[0]", "share 0.02 of 'pea'", "not one of 20 bodies"});
  EXPECT_EQ(pack(kHead + kMargin + population("count = 50", mixture)).scene.bodies.size(), 50u);
}

}  // namespace
}  // namespace scree
