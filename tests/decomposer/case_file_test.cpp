// The case language: what a case says is what the scene gets, and what is wrong is told with its line.
#include "decomposer/case/case_file.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "core/base/error.hpp"

namespace scree {
namespace {

/// The smallest case that holds one of most things. Lines matter: messages name them.
const std::string kCase = R"(title = "test"
seed = 7
[time]
duration = "0.5 s"
[shapes.rock]
file = "rock.shape.h5"
[materials.rock]
density = 2700
[materials.steel]
density = "7.8 g/cm^3"
[[pairs]]
between = ["rock", "rock"]
stiffness = "1 MN/m"
restitution = 0.5
friction = 0.4
[[pairs]]
between = ["steel", "rock"]
stiffness = 2e6
restitution = 0.4
[contact]
margin = "0.3 mm"
[[populations]]
shape = "rock"
material = "rock"
count = 10
size = { distribution = "lognormal", median = "12 mm", sigma = 0.2, min = "8 mm", max = "20 mm" }
region = { box = [[-0.1, -0.1, "5 cm"], [0.1, 0.1, 0.5]] }
[[walls]]
shape = { box_inside = [[-0.12, -0.12, 0], [0.12, 0.12, 0.6]] }
material = "steel"
)";

Case parse(const std::string& text) { return parse_case(text, "case.toml", "cases"); }

std::string replaced(const std::string& from, const std::string& to) {
  std::string text = kCase;
  const auto at = text.find(from);
  if (at == std::string::npos) throw std::logic_error("the case does not hold '" + from + "'");
  return text.replace(at, from.size(), to);
}

/// What parsing says; fails the test when it says nothing or is not the user's mistake (exit 2).
std::string refusal(const std::string& text) {
  try {
    parse(text);
  } catch (const Error& e) {
    EXPECT_EQ(static_cast<int>(e.code()), 2) << e.what();
    return e.what();
  }
  ADD_FAILURE() << "nothing was refused in:\n" << text;
  return "";
}

void expect_refusal(const std::string& text, const std::vector<std::string>& says) {
  const std::string message = refusal(text);
  for (const std::string& part : says) EXPECT_NE(message.find(part), std::string::npos) << "'" << part << "' not in: " << message;
}

TEST(CaseFile, a_case_is_read_in_si) {
  const Case c = parse(kCase);
  EXPECT_EQ(c.settings.title, "test");
  EXPECT_EQ(c.settings.seed, 7u);
  EXPECT_EQ(c.settings.gravity, (Vec3{0, 0, -9.81}));
  EXPECT_DOUBLE_EQ(c.settings.duration, 0.5);
  EXPECT_DOUBLE_EQ(c.settings.margin, 3e-4);
  EXPECT_TRUE(c.margin_given);
  ASSERT_EQ(c.materials.size(), 2u);
  EXPECT_DOUBLE_EQ(c.materials[1].density, 7800);
  ASSERT_EQ(c.pairs.size(), 2u);
  EXPECT_DOUBLE_EQ(c.pairs[0].pair.stiffness, 1e6);
  EXPECT_EQ(c.pairs[1].pair.a, 0);  // a <= b, in whatever order they were given
  EXPECT_EQ(c.pairs[1].pair.b, 1);
  ASSERT_EQ(c.populations.size(), 1u);
  EXPECT_DOUBLE_EQ(c.populations[0].value, 10);
  EXPECT_DOUBLE_EQ(c.populations[0].size->first, 0.012);
  EXPECT_EQ(c.populations[0].region.shape->lower, (Vec3{-0.1, -0.1, 0.05}));
  EXPECT_EQ(c.shapes[0].file, "cases/rock.shape.h5");  // relative to the case
  EXPECT_EQ(c.walls[0].wall.kind, WallKind::box_inside);
  EXPECT_EQ(c.walls[0].wall.material, 1);
}

TEST(CaseFile, the_example_of_the_house_is_understood_but_for_what_is_not_built) {
  // the example of the design papers, with what analytic spheres and drums add
  const Case c = parse(R"(
title = "boulders into a box"
seed  = 7
gravity = [0, 0, -9.81]
[time]
duration = "0.5 s"
steps_per_contact = 30
[domain]
min = [-0.2, -0.2, 0.0]
max = [ 0.2,  0.2, 0.6]
periodic = ["x"]
outside = "stop"
[shapes.toutatis]
file = "toutatis.shape.h5"
[shapes.bead]
sphere = { radius = "5 mm" }
[materials.rock]
density = 2700
[materials.steel]
density = 7800
[[pairs]]
between = ["rock", "rock"]
stiffness = 1e6
restitution = 0.5
friction = 0.4
rolling_friction = 0.0
[[pairs]]
between = ["rock", "steel"]
stiffness = 1e6
restitution = 0.4
friction = 0.3
[contact]
law    = "linear"
gather = "potential"
margin = "0.3 mm"
[motion]
integrator = "spiral"
[[bodies]]
shape = "toutatis"
material = "rock"
position = [0, 0, 0.3]
orientation = [1, 0, 0, 0]
velocity = [0, 0, -1]
angular_velocity = [0, 0, 0]
scale = 1.0
fixed = false
lock_rotation = false
[[populations]]
shapes = { toutatis = 0.7, bead = 0.3 }
material = "rock"
count = 500
size = { distribution = "lognormal", median = "12 mm", sigma = 0.2, min = "8 mm", max = "20 mm" }
region = { box = [[-0.1, -0.1, 0.05], [0.1, 0.1, 0.5]] }
method = "random"
velocity = [0, 0, 0]
[[walls]]
shape = { box_inside = [[-0.12, -0.12, 0], [0.12, 0.12, 0.6]] }
material = "steel"
[[walls]]
shape = { file = "paddle.shape.h5" }
material = "steel"
motion = { rotate = { axis = [0, 0, 2], centre = [0, 0, 0.1], rate = "30 rpm" }, start = "0.1 s" }
[[walls]]
shape = { plane = { point = [0, 0, 0], normal = [0, 0, 1] } }
material = "steel"
motion = { oscillate = { direction = [1, 0, 0], amplitude = "1 mm", frequency = "50 Hz" } }
[[walls]]
shape = { cylinder_inside = { start = [0, 0, 0], end = [0, 0, 1], radius = "1 m" } }
material = "steel"
motion = { translate = { velocity = [0, 3, 4] }, stop = 2 }
[[walls]]
shape = { sphere_inside = { centre = [0, 0, 0], radius = 2 } }
material = "steel"
motion = { table = { time = [0, 1], position = [[0, 0, 0], [0, 0, 1]] } }
[output]
every = "10 ms"
contacts = true
checkpoint = "0.1 s"
)");
  ASSERT_EQ(c.walls.size(), 5u);
  const Rotate rotate = std::get<Rotate>(c.walls[1].wall.motion.kind);
  EXPECT_EQ(rotate.axis, (Vec3{0, 0, 1}));
  EXPECT_NEAR(rotate.rate, std::numbers::pi, 1e-15);  // 30 rpm is half a turn a second
  EXPECT_DOUBLE_EQ(c.walls[1].wall.motion.start, 0.1);
  const Translate translate = std::get<Translate>(c.walls[3].wall.motion.kind);
  EXPECT_DOUBLE_EQ(translate.rate, 5);
  EXPECT_DOUBLE_EQ(translate.axis.y, 0.6);
  EXPECT_EQ(std::get<FollowTable>(c.walls[4].wall.motion.kind).position[1], (Vec3{0, 0, 1}));
  EXPECT_DOUBLE_EQ(c.shapes[0].sphere_radius, 0.005);
  ASSERT_EQ(c.populations[0].shares.size(), 2u);
  EXPECT_DOUBLE_EQ(c.populations[0].shares[1].second, 0.7);
  EXPECT_DOUBLE_EQ(c.settings.checkpoint_every, 0.1);
}

TEST(CaseFile, checkpoints_go_by_the_clock_unless_the_case_says_otherwise) {
  EXPECT_TRUE(parse(kCase).settings.checkpoint_by_clock);
  const Case none = parse(kCase + "\n[output]\ncheckpoint = 0\n");
  EXPECT_FALSE(none.settings.checkpoint_by_clock);
  EXPECT_EQ(none.settings.checkpoint_every, 0);
}

TEST(CaseFile, an_unknown_key_is_refused_with_its_line_and_the_nearest_name) {
  expect_refusal(replaced("friction = 0.4", "frictoin = 0.4"),
                 {"case.toml:15: pairs[0].frictoin", "unknown key", "did you mean 'friction'"});
  expect_refusal(replaced("[contact]", "[contatc]"), {"case.toml:20: contatc", "did you mean 'contact'"});
  expect_refusal(replaced("duration = \"0.5 s\"", "duration = 1\ncolour = 3"), {"case.toml:5: time.colour", "expected one of: duration"});
  expect_refusal(replaced("min = \"8 mm\", ", "min = \"8 mm\", mean = 1, "), {"case.toml:26", "mean", "not part of a lognormal"});
}

TEST(CaseFile, a_wrong_unit_is_refused_with_what_was_found_and_what_to_write) {
  expect_refusal(replaced("friction = 0.4", "friction = \"0.5 m\""),
                 {"case.toml:15: pairs[0].friction = \"0.5 m\": a length, but friction has no unit; write 0.5"});
  expect_refusal(replaced("\"0.3 mm\"", "\"0.3 kg\""), {"case.toml:21: contact.margin = \"0.3 kg\"", "a mass", "a length"});
  expect_refusal(replaced("density = 2700", "density = -2.7e+3 kg/m^3  # dry"),
                 {"case.toml:8:", "a number with a unit is written in quotes: \"-2.7e+3 kg/m^3\""});
  expect_refusal(replaced("friction = 0.4", "friction = 0,4"), {"case.toml:15:", "decimals have a point, not a comma"});
  expect_refusal(replaced("density = 2700", "density = \"2700 kg\""), {"case.toml:8: materials.rock.density", "a density"});
  expect_refusal(replaced("\"5 cm\"", "\"5 cn\""), {"case.toml:27", "region.box"});
}

TEST(CaseFile, a_wrong_type_is_refused) {
  expect_refusal(replaced("friction = 0.4", "friction = true"), {"case.toml:15: pairs[0].friction = true", "true or false found"});
  expect_refusal(replaced("count = 10", "count = 10.5"), {"case.toml:25: populations[0].count = 10.5", "a whole number"});
  expect_refusal(replaced("shape = \"rock\"", "shape = 3"), {"case.toml:23", "a text"});
  expect_refusal(replaced("[[walls]]", "[walls]"), {"[[walls]]"});
  expect_refusal(replaced("seed = 7", "seed = -7"), {"case.toml:2: seed = -7", "at least 0"});
  expect_refusal(replaced("[[-0.1, -0.1, \"5 cm\"], [0.1, 0.1, 0.5]]", "[[-0.1, -0.1], [0.1, 0.1]]"), {"case.toml:27", "three numbers"});
}

TEST(CaseFile, a_value_out_of_range_is_refused) {
  expect_refusal(replaced("restitution = 0.5", "restitution = 1.5"), {"case.toml:14: pairs[0].restitution = 1.5", "at most 1"});
  expect_refusal(replaced("restitution = 0.5", "restitution = -0.1"), {"at least 0"});
  EXPECT_EQ(parse(replaced("restitution = 0.5", "restitution = 0")).pairs[0].pair.restitution, 0);
  expect_refusal(replaced("friction = 0.4", "friction = -0.1"), {">= 0"});
  expect_refusal(replaced("density = 2700", "density = 0"), {"> 0"});
  expect_refusal(replaced("density = 2700", "density = nan"), {"density"});
  expect_refusal(replaced("stiffness = 2e6", "stiffness = inf"), {"finite"});
  expect_refusal(replaced("[0.1, 0.1, 0.5]", "[0.1, -0.1, 0.5]"), {"first corner must be below"});
  expect_refusal(replaced("max = \"20 mm\"", "max = \"2 mm\""), {"must not be above max"});
  expect_refusal(replaced("friction = 0.4", "friction = 0.4\nfriction_sliding = 0.5"), {"case.toml:16", "from 0 to friction"});
}

TEST(CaseFile, a_missing_key_is_named) {
  expect_refusal(replaced("restitution = 0.5\n", ""), {"case.toml:11: pairs[0].restitution: is missing"});
  expect_refusal(replaced("count = 10\n", ""), {"case.toml:22: populations[0]", "count, mass, solid_fraction"});
  expect_refusal(replaced("count = 10", "count = 10\nmass = \"1 kg\""), {"both 'count' and 'mass'"});
  expect_refusal("title = 'x'", {"time: is missing"});
  expect_refusal(replaced("distribution = \"lognormal\", ", ""), {"size.distribution: is missing; expected one of: fixed, uniform"});
}

TEST(CaseFile, a_material_pair_that_can_occur_and_is_missing_is_named_with_what_uses_it) {
  const std::string pair = "[[pairs]]\nbetween = [\"steel\", \"rock\"]\nstiffness = 2e6\nrestitution = 0.4\n";
  expect_refusal(replaced(pair, ""), {"\"rock\" and \"steel\" can touch", "populations[0]", "walls[0]", "between = [\"rock\", \"steel\"]"});
  const std::string self = "[[pairs]]\nbetween = [\"rock\", \"rock\"]\nstiffness = \"1 MN/m\"\nrestitution = 0.5\nfriction = 0.4\n";
  expect_refusal(replaced(self, ""), {"\"rock\" and \"rock\" can touch", "populations[0]"});
  // all that are missing at once
  std::string none = replaced(self, "");
  none.replace(none.find(pair), pair.size(), "");
  expect_refusal(none, {"2 pairs of materials have no [[pairs]]", "\"rock\" and \"rock\" can touch", "\"rock\" and \"steel\" can touch",
                        "between = [\"rock\", \"rock\"], between = [\"rock\", \"steel\"]"});
}

TEST(CaseFile, a_material_pair_that_cannot_occur_may_be_missing_and_is_dropped) {
  // steel is only a wall: walls never meet each other
  EXPECT_EQ(parse(kCase + "[[pairs]]\nbetween = [\"steel\", \"steel\"]\nstiffness = 1\nrestitution = 1\n").pairs.size(), 2u);
  // one rock alone has nobody of its kind to meet
  const std::string self = "[[pairs]]\nbetween = [\"rock\", \"rock\"]\nstiffness = \"1 MN/m\"\nrestitution = 0.5\nfriction = 0.4\n";
  std::string one = replaced(self, "");
  one.replace(one.find("count = 10"), 10, "count = 1");
  EXPECT_EQ(parse(one).pairs.size(), 1u);
}

TEST(CaseFile, a_fixed_body_needs_a_pair_with_movers_only) {
  const std::string fixed = "[[bodies]]\nshape = \"rock\"\nmaterial = \"steel\"\nposition = [0, 0, 1]\nfixed = true\n";
  EXPECT_NO_THROW(parse(kCase + fixed));
  const std::string moving = "[[bodies]]\nshape = \"rock\"\nmaterial = \"steel\"\nposition = [0, 0, 1]\n";
  expect_refusal(kCase + moving, {"\"steel\" and \"steel\" can touch", "bodies[0]", "walls[0]"});  // the steel body may meet the steel wall
}

TEST(CaseFile, names_that_do_not_exist_are_refused_with_the_nearest) {
  expect_refusal(replaced("material = \"steel\"", "material = \"steele\""),
                 {"case.toml:30", "no material 'steele'", "did you mean 'steel'"});
  expect_refusal(replaced("shape = \"rock\"", "shape = \"boulder\""), {"case.toml:23", "no shape 'boulder'", "defined are: rock"});
  expect_refusal(replaced("between = [\"rock\", \"rock\"]", "between = [\"rock\", \"rok\"]"), {"case.toml:12", "did you mean 'rock'"});
  expect_refusal(kCase + "[[pairs]]\nbetween = [\"rock\", \"steel\"]\nstiffness = 1\nrestitution = 1\n", {"given twice", "case.toml:16"});
}

TEST(CaseFile, what_is_not_built_yet_is_refused_with_what_is) {
  expect_refusal(replaced("[contact]", "[contact]\nlaw = \"liniar\""), {"did you mean 'linear'"});
  expect_refusal(kCase + "[distance]\nmethod = \"penalty\"\n", {"no longer part", "Remove it"});
  expect_refusal(kCase + "[domain]\nmin = [0, 0, 0]\nmax = [1, 1, 1]\nperiodic = [\"w\"]\n", {"periodic", "expected \"x\""});
  expect_refusal(kCase + "[domain]\nperiodic = [\"x\"]\n", {"periodic", "needs min and max"});
}

TEST(CaseFile, populations_say_how_they_are_mixed_sized_and_turned) {
  const std::string size = "size = { distribution = \"lognormal\", median = \"12 mm\", sigma = 0.2, min = \"8 mm\", max = \"20 mm\" }";
  const auto population = [&](const std::string& text) { return parse(replaced(size, text)).populations[0]; };
  EXPECT_EQ(population("method = \"settle\"").method, PackingMethod::settle);
  EXPECT_TRUE(population("size = { distribution = \"uniform\", by = \"mass\", min = 1, max = 2 }").size->by_mass);
  const BodyOrientation aligned = population("orientation = { align = [0, 0, 2], axis = \"shortest\", scatter = \"90 deg\" }").orientation;
  EXPECT_EQ(aligned.kind, BodyOrientation::Kind::aligned);
  EXPECT_EQ(aligned.direction, (Vec3{0, 0, 1}));
  EXPECT_DOUBLE_EQ(aligned.scatter, std::numbers::pi / 2);
  EXPECT_EQ(population("orientation = [0, 1, 0, 0]").orientation.given, (Quat{0, 1, 0, 0}));
  EXPECT_EQ(population("orientation = \"random\"").orientation.kind, BodyOrientation::Kind::random);

  expect_refusal(replaced(size, "jitter = 0.5"), {"jitter", "lattice"});
  expect_refusal(replaced(size, "method = \"lattice\"\njitter = 1.5"), {"from 0 to 1"});
  expect_refusal(replaced(size, "method = \"latice\""), {"did you mean 'lattice'"});
  expect_refusal(replaced(size, "shares_by = \"mass\""), {"is for a mixture"});
  expect_refusal(replaced("count = 10", "fill = true"), {"method = \"settle\""});
  expect_refusal(replaced("shape = \"rock\"\nmaterial", "shapes = { rock = 0.7 }\nmaterial"), {"add up to 0.7", "expected 1"});
  EXPECT_DOUBLE_EQ(parse(replaced("shape = \"rock\"\nmaterial", "shapes = { rock = 3 }\nmaterial")).populations[0].shares[0].second, 1);
  const auto sieve = [&](const std::string& diameters, const std::string& passing) {
    return replaced(size, "size = { distribution = \"sieve\", diameter = [" + diameters + "], passing = [" + passing + "] }");
  };
  EXPECT_EQ(parse(sieve("\"1 mm\", \"2 mm\", \"4 mm\"", "0, 0.3, 1")).populations[0].size->sieve.size(), 3u);
  expect_refusal(sieve("0.001, 0.002", "0, 0.9"), {"goes from 0 to 0.9", "1 at the coarsest"});
  expect_refusal(sieve("0.002, 0.001", "0, 1"), {"ascend"});
  expect_refusal(sieve("0.001, 0.002, 0.003", "0, 0.5, 0.4"), {"must not descend"});
  expect_refusal(sieve("0.001, 0.002", "0, 0.5, 1"), {"3 values for 2 diameters"});
  expect_refusal(replaced("duration = \"0.5 s\"", "duration = 1\nstop_at_rest = true").insert(0, "gravity = [0, 0, 0]\n"),
                 {"needs gravity"});
  const std::string empty = "duration = 1\nstop_when_empty = true", domain = "\n[domain]\nmin = [0, 0, 0]\nmax = [1, 1, 1]\n";
  expect_refusal(replaced("duration = \"0.5 s\"", empty), {"stop_when_empty", "no body can leave", "outside = \"remove\""});
  expect_refusal(replaced("duration = \"0.5 s\"", empty + domain), {"no body can leave"});
  EXPECT_TRUE(parse(replaced("duration = \"0.5 s\"", empty + domain + "outside = \"remove\"\n")).settings.stop_when_empty);
}

TEST(CaseFile, a_fluid_is_what_it_says_and_nothing_without_viscosity) {
  EXPECT_FALSE(parse(kCase).settings.fluid);
  const auto with = [](const std::string& keys) { return replaced("[shapes.rock]", "[fluid]\n" + keys + "\n[shapes.rock]"); };
  const Fluid water = parse(with("density = \"1 g/cm^3\"\nviscosity = \"1 mPa s\"\nvelocity = [0, 0, \"2 cm/s\"]")).settings.fluid.value();
  EXPECT_DOUBLE_EQ(water.density, 1000);
  EXPECT_DOUBLE_EQ(water.viscosity, 1e-3);
  EXPECT_DOUBLE_EQ(water.velocity.z, 0.02);
  EXPECT_EQ(water.drag, Drag::haider_levenspiel);
  EXPECT_EQ(parse(with("density = 1\nviscosity = 1\ndrag = \"stokes\"")).settings.fluid.value().drag, Drag::stokes);
  expect_refusal(with("density = 1000"), {"case.toml:5", "fluid.viscosity", "missing"});
  expect_refusal(with("density = 1000\nviscosity = \"1 mPa\""), {"case.toml:7", "a dynamic viscosity [Pa s]", "1 mPa s"});
  expect_refusal(with("density = -1\nviscosity = 1"), {"case.toml:6", "fluid.density"});
  expect_refusal(with("density = 1000\nviscosity = 0"), {"fluid.viscosity"});
  expect_refusal(with("density = 1000\nviscosity = 1\ndrag = \"stoke\""), {"did you mean 'stokes'"});
  expect_refusal(with("density = 1000\nviskosity = 1"), {"did you mean 'viscosity'"});
}

TEST(CaseFile, numbers_that_overflow_when_squared_are_refused_as_such) {
  expect_refusal(replaced("\"5 cm\"", "1e308"), {"case.toml:27", "too large"});
}

TEST(CaseFile, contact_laws_ask_for_what_they_need) {
  expect_refusal(replaced("[contact]", "[contact]\nlaw = \"hertz-mindlin\""), {"stiffness", "not used", "young"});
  expect_refusal(replaced("[contact]", "[contact]\nlaw = \"hunt-crossley\""), {"restitution", "restitution_speed"});
  expect_refusal(replaced("friction = 0.4", "friction = 0.4\nrestitution_speed = 1"), {"restitution_speed", "hunt-crossley"});
  expect_refusal(replaced("friction = 0.4", "friction = 0.4\nrolling_model = \"elastic\""), {"rolling_model"});
  const Case c = parse(replaced("friction = 0.4",
                                "friction = 0.4\nrolling_friction = 0.1\ntorsional_friction = 0.2\nrolling_model = "
                                "\"constant\"\ntangential_ratio = 0.8\ntangential_damping = 0\ncontact_radius = \"3 mm\""));
  EXPECT_DOUBLE_EQ(c.pairs[0].pair.rolling_friction, 0.1);
  EXPECT_DOUBLE_EQ(c.pairs[0].pair.torsional_friction, 0.2);
  EXPECT_EQ(c.pairs[0].pair.rolling_model, RollingModel::constant);
  EXPECT_DOUBLE_EQ(c.pairs[0].pair.tangential_ratio, 0.8);
  EXPECT_DOUBLE_EQ(c.pairs[0].pair.tangential_damping, 0);
  EXPECT_DOUBLE_EQ(c.pairs[0].pair.contact_radius, 0.003);
}

TEST(CaseFile, broken_toml_is_refused_with_line_and_column) {
  expect_refusal(replaced("density = 2700", "density = = 2700"), {"case.toml:8:"});
  expect_refusal(replaced("density = 2700", "density = 2700\ndensity = 3"), {"case.toml:9:"});
}

TEST(CaseFile, a_name_is_one_line_of_at_most_a_thousand_bytes) {
  const std::string longest(1000, 'a'), longer = longest + "a";
  EXPECT_EQ(parse(replaced("title = \"test\"", "title = \"" + longest + "\"")).settings.title, longest);
  EXPECT_EQ(parse(replaced("title = \"test\"", "title = \"\u00e4 \u4f60\"")).settings.title, "\xc3\xa4 \xe4\xbd\xa0");
  expect_refusal(replaced("title = \"test\"", "title = \"" + longer + "\""), {"case.toml:1: title", "has 1001 bytes", "at most 1000"});
  for (const auto& [text, what] : {std::pair{"a\\nb", "a line break (U+000A)"},
                                   {"a\\u0000b", "a control character (U+0000)"},
                                   {"a\\u001b[31m", "a control character (U+001B)"},
                                   {"a\\u007f", "a control character (U+007F)"},
                                   {"a\\u0085", "a line break (U+0085)"},
                                   {"a\\u2028", "a line break (U+2028)"}}) {
    const std::string name = text;
    expect_refusal(replaced("title = \"test\"", "title = \"" + name + "\""), {"case.toml:1: title", what, "as its character 2"});
    expect_refusal(replaced("[materials.steel]", "[materials.\"" + name + "\"]"), {"case.toml:", "materials", what});
    expect_refusal(replaced("[shapes.rock]", "[shapes.\"" + name + "\"]"), {"case.toml:", "shapes", what});
    expect_refusal(replaced("between = [\"steel\"", "between = [\"" + name + "\""), {"between", what});
  }
  expect_refusal(replaced("[materials.steel]", "[materials." + longer + "]"), {"materials", "has 1001 bytes"});
  expect_refusal(replaced("file = \"rock.shape.h5\"", "file = \"a\\u0000.shape.h5\""), {"shapes.rock.file", "U+0000"});
}

TEST(CaseFile, a_key_of_many_parts_is_refused_before_it_is_a_tree) {
  std::string key = "a";
  for (int part = 1; part < 50000; ++part) key += ".a";
  for (const std::string& text :
       {key + " = 1\n", "[" + key + "]\nx = 1\n", "title = { " + key + " = 1 }\n", "title = [{ \"a.b\"." + key + " = 1 }]\n"})
    expect_refusal(text + kCase, {"case.toml:1:", "more than 16 parts"});
  // dots of texts, comments and numbers are none of keys
  EXPECT_EQ(parse("# " + key + "\n" + replaced("\"test\"", "\"\"\"a.b.c.d.e.f.g.h.i.j.k.l.m.n.o.p.q.r.s.t\"\"\"")).settings.title,
            "a.b.c.d.e.f.g.h.i.j.k.l.m.n.o.p.q.r.s.t");
}

TEST(CaseFile, a_size_may_be_one_quantity) {
  const std::string size = "size = { distribution = \"lognormal\", median = \"12 mm\", sigma = 0.2, min = \"8 mm\", max = \"20 mm\" }";
  EXPECT_DOUBLE_EQ(parse(replaced(size, "size = \"12 mm\"")).populations[0].size->quantile(0.3), 0.012);
  EXPECT_FALSE(parse(replaced(size, "")).populations[0].size.has_value());
  expect_refusal(replaced(size, "size = \"12 kg\""), {"case.toml:26: populations[0].size", "a length"});
  expect_refusal(replaced("\"lognormal\"", "\"lognormel\""), {"case.toml:26", "did you mean 'lognormal'"});
  expect_refusal(replaced(", max = \"20 mm\"", ""), {"size.max", "is missing"});
}

}  // namespace
}  // namespace scree
