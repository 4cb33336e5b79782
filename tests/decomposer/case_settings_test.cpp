// Keys set on the command line: the case that results is the case with those lines changed by hand.
#include "decomposer/case/case_settings.hpp"

#include <gtest/gtest.h>

#include "core/base/error.hpp"
#include "decomposer/case/case_file.hpp"

namespace scree {
namespace {

const std::string kCase = R"(title = "test"
[time]
duration = "0.5 s"
[shapes.ball]
sphere = { radius = "1 cm" }
[materials.rock]
density = 2700
[[pairs]]
between = ["rock", "rock"]
stiffness = 1e6
restitution = 0.5
friction = 0.4
[[bodies]]
shape = "ball"
material = "rock"
position = [0, 0, 0.5]
[[bodies]]
shape = "ball"
material = "rock"
position = [1, 0, 0.5]
)";

Case parse(const std::vector<std::string>& changes) { return parse_case(kCase, "case.toml", "", changes); }

std::string refusal(const std::string& change) {
  try {
    parse({change});
  } catch (const UsageError& e) {
    return e.what();
  }
  return "accepted";
}

TEST(CaseSettings, numbers_texts_and_vectors_replace_what_the_case_says) {
  const Case c = parse({"pairs.0.friction=0.7", "time.duration=\"2 ms\"", "bodies.1.position=[3, \"4 m\", 5]", "title=dry run"});
  EXPECT_EQ(c.pairs[0].pair.friction, 0.7);
  EXPECT_EQ(c.settings.duration, 2e-3);
  EXPECT_EQ(c.bodies[1].position.y, 4.0);
  EXPECT_EQ(c.bodies[0].position.x, 0.0);
  EXPECT_EQ(c.settings.title, "dry run");
}

TEST(CaseSettings, a_quantity_needs_no_quotes_and_a_star_means_all) {
  const Case c = parse({"time.duration=2 ms", "bodies.*.velocity=[0, 0, \"1 m/s\"]", "bodies.*.position.2=7"});
  EXPECT_EQ(c.settings.duration, 2e-3);
  for (const CaseBody& body : c.bodies) {
    EXPECT_EQ(body.velocity.z, 1.0);
    EXPECT_EQ(body.position.z, 7.0);
  }
}

TEST(CaseSettings, a_table_and_a_key_that_are_not_there_are_added) { EXPECT_EQ(parse({"contact.margin=3 mm"}).settings.margin, 3e-3); }

TEST(CaseSettings, the_last_of_two_settings_holds) {
  EXPECT_EQ(parse({"pairs.0.friction=0.7", "pairs.0.friction=0.2"}).pairs[0].pair.friction, 0.2);
}

TEST(CaseSettings, the_text_that_is_kept_gives_the_same_case_again) {
  const std::vector<std::string> changes{"pairs.0.friction=0.1", "time.duration=0.3", "contact.margin=3 mm"};
  const Case first = parse(changes);
  const Case again = parse_case(first.text, "case.toml", "");
  EXPECT_EQ(again.pairs[0].pair.friction, 0.1);  // 0.1 and 0.3 have no exact double: all digits are kept
  EXPECT_EQ(again.settings.duration, 0.3);
  EXPECT_EQ(again.settings.margin, first.settings.margin);
  EXPECT_NE(first.text.find("#   --set contact.margin=3 mm"), std::string::npos) << first.text;
  EXPECT_EQ(parse({}).text, kCase);
}

TEST(CaseSettings, a_number_is_named_as_it_was_given) {
  const std::string text = refusal("pairs.0.restitution=1.1");
  EXPECT_NE(text.find("restitution = 1.1:"), std::string::npos) << text;  // not 1.1000000000000001
}

TEST(CaseSettings, what_cannot_be_set_is_refused_with_what_there_is) {
  EXPECT_NE(refusal("pairs.3.friction=0.4").find("the case has 1 of them"), std::string::npos);
  EXPECT_NE(refusal("pairs.friction=0.4").find("a number from 0, or *"), std::string::npos);
  EXPECT_NE(refusal("title.first=0.4").find("neither a table nor a list"), std::string::npos);
  EXPECT_NE(refusal("pairs.0.frction=0.4").find("did you mean 'friction'"), std::string::npos);
  EXPECT_NE(refusal("pairs.0.friction=-1").find("expected a value >= 0"), std::string::npos);
  for (const char* wrong : {"", "=", "=3", "friction", "pairs..friction=2", ".=1"}) {
    EXPECT_NE(refusal(wrong).find("expected KEY=VALUE"), std::string::npos) << wrong << ": " << refusal(wrong);
  }
}

}  // namespace
}  // namespace scree
