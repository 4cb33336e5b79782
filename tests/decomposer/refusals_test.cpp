// What pack must not take without a word: amounts that give no body, walls that stand elsewhere when the run begins, and what the
// solver would refuse before its first step.
#include <gtest/gtest.h>
#include <unistd.h>
#include <nlohmann/json.hpp>

#include <filesystem>

#include "core/base/error.hpp"
#include "core/storage/shape_file.hpp"
#include "decomposer/packing/build_scene.hpp"
#include "tests/support/margins.hpp"

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

PackedScene pack(const std::string& text) { return build_scene(test::touching_outside(parse_case(text, "case.toml", ""))); }

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
  expect_says(failure(head + population("mass = \"80 g\""), ExitCode::bad_data),
              {"populations[0]", "mass = 80 g", "half of one 'ball' of diameter 50 mm", "163.6 g"});
  EXPECT_EQ(pack(head + population("mass = \"83 g\"")).scene.bodies.size(), 1u);
  expect_says(failure(head + population("solid_fraction = 3e-5"), ExitCode::bad_data),
              {"solid_fraction = 3e-05", "half of one 'ball'", "6.54e-05 m^3"});
  EXPECT_EQ(pack(head + population("solid_fraction = 4e-5")).scene.bodies.size(), 1u);
  expect_says(failure(head + population("count = 0"), ExitCode::usage), {"populations[0].count = 0", "at least 1"});
}

TEST(Refusals, a_share_that_gives_not_one_body_is_refused_with_the_number_of_bodies) {
  const std::string mixture = "shapes = { ball = 0.98, pea = 0.02 }\nsize = \"50 mm\"";
  expect_says(failure(kHead + kMargin + population("count = 20", mixture), ExitCode::bad_data),
              {"populations[0]", "share 0.02 of 'pea'", "not one of 20 bodies"});
  EXPECT_EQ(pack(kHead + kMargin + population("count = 50", mixture)).scene.bodies.size(), 50u);
}

double least_height(const PackedScene& packed) {
  double least = 1e300;
  for (std::size_t i = 0; i < packed.scene.bodies.size(); ++i) least = std::min(least, packed.scene.bodies.position[i].z);
  return least;
}

TEST(Refusals, bodies_keep_clear_of_walls_where_their_motion_has_them_at_the_start) {
  const std::string plane = "[[walls]]\nmaterial = \"stone\"\nshape = { plane = { point = [0, 0, 0], normal = [0, 0, 1] } }\n";
  const std::string plate =
      "[[walls]]\nmaterial = \"stone\"\nshape = { plate = { corner = [-1, -1, 0], side_a = [3, 0, 0], side_b = [0, 3, 0] } }\n";
  const std::string layer =
      "[[populations]]\nshape = \"ball\"\nsize = \"50 mm\"\nmaterial = \"stone\"\ncount = 200\nregion = { box = [[0, 0, -0.1], [1, 1, "
      "0.5]] }\n";
  struct Motion {
    const char* text;
    double z;  ///< of the wall at 0 s
  };
  for (const Motion& m :
       {Motion{"motion = { table = { time = [0, 1], position = [[0, 0, 0.2], [0, 0, 0.3]] } }\n", 0.2},
        Motion{"motion = { table = { time = [0, 1], position = [[0, 0, 0], [0, 0, 1]] }, start = -0.1 }\n", 0.1},
        Motion{"motion = { translate = { velocity = [0, 0, 0.5] }, start = -0.3, stop = -0.1 }\n", 0.1},
        Motion{"motion = { oscillate = { direction = [0, 0, 1], amplitude = 0.1, frequency = 1 }, start = -0.25 }\n", 0.1},
        // from the top of its way: the displacement counts from where the wall stands
        Motion{"motion = { oscillate = { direction = [0, 0, 1], amplitude = 0.1, frequency = 1, phase = \"90 deg\" } }\n", 0.0}}) {
    const PackedScene over_plane = pack(kHead + kMargin + layer + plane + m.text);
    EXPECT_GE(least_height(over_plane), m.z + 0.025 + 0.004 - 1e-12) << m.text;
    EXPECT_LT(least_height(over_plane), m.z + 0.05) << m.text;
    EXPECT_EQ(over_plane.scene.walls[0].point, (Vec3{})) << "the scene keeps the wall and its motion as given";
    // a plate has two sides: none may be within the reach of either
    const PackedScene at_plate = pack(kHead + kMargin + layer + plate + m.text);
    for (const Vec3& x : at_plate.scene.bodies.position) EXPECT_GE(std::abs(x.z - m.z), 0.025 + 0.004 - 1e-12) << m.text;
  }
  // a given body at the drawn place of a wall that stands elsewhere is in nobody's way, and one at its true place is
  const std::string body = "[[bodies]]\nshape = \"ball\"\nscale = 0.05\nmaterial = \"stone\"\nposition = [0, 0, ";
  const std::string raised = plate + "motion = { table = { time = [0, 1], position = [[0, 0, 0.2], [0, 0, 0.3]] } }\n";
  EXPECT_EQ(pack(kHead + kMargin + body + "0]\n" + raised).scene.bodies.size(), 1u);
  expect_says(failure(kHead + kMargin + body + "0.2]\n" + raised, ExitCode::bad_data), {"bodies[0]", "overlaps"});
}

TEST(Refusals, a_box_that_is_turned_at_the_start_is_refused_by_name) {
  const std::string box =
      "[[walls]]\nname = \"tumbler\"\nmaterial = \"stone\"\nshape = { box_inside = [[0, 0, 0], [1, 1, 1]] }\n"
      "motion = { rotate = { axis = [0, 0, 1], centre = [0.5, 0.5, 0.5], rate = 1 }, start = ";
  expect_says(failure(kHead + kMargin + population("count = 5") + box + "-1 }\n", ExitCode::usage), {"'tumbler'", "-1 s", "turned"});
  EXPECT_EQ(pack(kHead + kMargin + population("count = 5") + box + "0 }\n").scene.bodies.size(), 5u);
}

TEST(Refusals, a_period_and_walls_that_the_solver_would_refuse_are_refused) {
  const auto domain = [](double length) {
    return kHead + kMargin + fmt::format("[domain]\nmin = [0, 0, 0]\nmax = [{}, 1, 1]\nperiodic = [\"x\"]\n", length);
  };
  const std::string ball = "[[bodies]]\nshape = \"ball\"\nscale = 0.1\nmaterial = \"stone\"\nposition = [0.05, 0.5, 0.5]\n";
  // 4 (1.01 x 0.05 + 0.002) = 0.21
  EXPECT_EQ(pack(domain(0.2101) + ball).scene.bodies.size(), 1u);
  expect_says(failure(domain(0.2099) + ball, ExitCode::usage), {"periodic axis x", "0.21"});
  const auto plane = [](const std::string& normal) {
    return "[[walls]]\nname = \"slope\"\nmaterial = \"stone\"\nshape = { plane = { point = [0, 0, 0], normal = " + normal + " } }\n";
  };
  EXPECT_EQ(pack(domain(1) + ball + plane("[0, 1, 2]")).scene.bodies.size(), 1u);
  expect_says(failure(domain(1) + ball + plane("[1, 0, 2]"), ExitCode::usage), {"'slope'", "periodic axis x"});
  expect_says(
      failure(
          domain(1) + ball +
              "[[walls]]\nname = \"bowl\"\nmaterial = \"stone\"\nshape = { sphere_inside = { centre = [0.5, 0.5, 0.5], radius = 2 } }\n",
          ExitCode::usage),
      {"'bowl'", "periodic axis x"});
  expect_says(failure(domain(1) + ball +
                          "[[walls]]\nname = \"mill\"\nmaterial = \"stone\"\nshape = { cylinder_inside = { start = [0, 0, 0.5], end = [0, "
                          "1, 0.5], radius = 2 } }\n",
                      ExitCode::usage),
              {"'mill'", "periodic axis x"});
}

TEST(Refusals, a_mesh_that_does_not_fit_a_periodic_axis_is_refused_or_named) {
  const std::string head = kHead + kMargin +
                           "[domain]\nmin = [0, 0, 0]\nmax = [1, 1, 1]\nperiodic = [\"x\"]\n"
                           "[[bodies]]\nshape = \"ball\"\nscale = 0.1\nmaterial = \"stone\"\nposition = [0.5, 0.5, 0.5]\n";
  const auto plate = [](double from, double length) {
    return fmt::format(
        "[[walls]]\nname = \"belt\"\nmaterial = \"stone\"\nshape = {{ plate = {{ corner = [{}, 0, 0.2], side_a = [{}, 0, 0], side_b = [0, "
        "1, 0] }} }}\n",
        from, length);
  };
  EXPECT_EQ(pack(head + plate(-0.1, 1.2)).report.notices.size(), 1u) << "the pea is not used";
  const PackedScene gap = pack(head + plate(0, 1));
  ASSERT_EQ(gap.report.notices.size(), 2u);
  expect_says(gap.report.notices[1], {"'belt'", "periodic axis x", "0.054 m"});
  expect_says(failure(head + plate(0.5, 1), ExitCode::usage), {"'belt'", "periodic axis x", "beyond one end"});
  expect_says(failure(head + plate(-0.1, 1.2) + "motion = { translate = { velocity = [0.5, 0, 0] } }\n", ExitCode::usage),
              {"'belt'", "periodic axis x", "-0.1 to 1.6 m"});
}

TEST(Refusals, walls_and_laws_that_need_a_margin_or_a_speed_are_refused_without) {
  const std::string ball = "[[bodies]]\nshape = \"ball\"\nmaterial = \"stone\"\nposition = [0, 0, 1]\n";
  const std::string plate =
      "[[walls]]\nname = \"tray\"\nmaterial = \"stone\"\nshape = { plate = { corner = [-1, -1, 0], side_a = [3, 0, 0], side_b = [0, 3, 0] "
      "} }\n";
  expect_says(failure(kHead + "[contact]\nmargin = 0\n" + ball + plate, ExitCode::usage), {"contact.margin = 0", "'tray'"});
  expect_says(failure(kHead + "[contact]\nmargin = 0\nbarrier = 1\n" + ball, ExitCode::usage),
              {"contact.barrier", "margin", "surface = \"outside\""});
  const std::string hertz =
      "gravity = [0, 0, 0]\n[time]\nduration = 1\n[shapes.ball]\nsphere = { radius = 0.5 }\n[materials.stone]\ndensity = 2500\nyoung = \"1 "
      "GPa\"\n"
      "[[pairs]]\nbetween = [\"stone\", \"stone\"]\nrestitution = 0.5\n[contact]\nlaw = \"hertz-mindlin\"\n";
  const std::string two = ball + "[[bodies]]\nshape = \"ball\"\nmaterial = \"stone\"\nposition = [0, 0, 3]\n";
  expect_says(failure(hertz + two, ExitCode::usage), {"contact.impact_speed is missing"});
  EXPECT_EQ(pack(hertz + "impact_speed = 1\n" + two).scene.bodies.size(), 2u);
}

// The solver ends a run at .97 of the margins; of two margins of 2 mm that leaves 0.12 mm.
TEST(Refusals, given_bodies_that_touch_deeper_than_a_run_may_are_refused) {
  const auto two = [](double gap, const std::string& walls) {
    return kHead + "[contact]\nmargin = \"2 mm\"\nrelax = false\n" +
           "[[bodies]]\nshape = \"ball\"\nmaterial = \"stone\"\nposition = [0, 0, 0.5]\n" +
           "[[bodies]]\nshape = \"ball\"\nmaterial = \"stone\"\nposition = [0, 0, " + fmt::format("{}", 1.5 + gap) + "]\n" + walls;
  };
  EXPECT_EQ(pack(two(0.000125, "")).scene.bodies.size(), 2u);
  expect_says(failure(two(0.000115, ""), ExitCode::bad_data), {"bodies[1]", "bodies[0]", "0.97 of the margins"});
  const auto floor = [](double z) {
    return fmt::format("[[walls]]\nmaterial = \"stone\"\nshape = {{ plane = {{ point = [0, 0, {}], normal = [0, 0, 1] }} }}\n", z);
  };
  EXPECT_EQ(pack(two(1, floor(-0.000125))).scene.bodies.size(), 2u);
  expect_says(failure(two(1, floor(-0.000115)), ExitCode::bad_data), {"bodies[0]", "walls[0]", "0.97 of the margins"});
}

// Attraction of a pair: what does not go together, and what a run could not hold.
std::string sticky(const std::string& keys, const std::string& more = "", const std::string& head = kHead) {
  return head + keys + "\n" + more + "[[bodies]]\nshape = \"ball\"\nmaterial = \"stone\"\nposition = [0, 0, 2]\n" +
         "[[bodies]]\nshape = \"pea\"\nmaterial = \"stone\"\nposition = [0, 0, 4]\n";
}

TEST(Refusals, attraction_that_is_not_told_in_full_is_refused_with_the_key_that_lacks) {
  const auto says = [](const std::string& keys, const std::vector<std::string>& parts) {
    expect_says(failure(sticky(keys), ExitCode::usage), parts);
  };
  says("pull_off = 1", {"pairs[0].pull_off = 1", "needs adhesion_range", "separation_energy"});
  says("adhesion = 0.05\nadhesion_model = \"jkr\"", {"pairs[0].adhesion", "needs adhesion_range"});
  says("adhesion = 0.05\nadhesion_range = 1e-4", {"pairs[0].adhesion", "adhesion_model", "jkr", "dmt"});
  says("pull_off = 1\nadhesion = 0.05\nadhesion_model = \"jkr\"\nadhesion_range = 1e-4", {"pairs[0].pull_off", "keep one"});
  says("adhesion_range = 1e-4", {"pairs[0].adhesion_range", "pull_off or adhesion"});
  says("separation_energy = 1e-4", {"pairs[0].separation_energy", "pull_off or adhesion"});
  says("pull_off = 1\nadhesion_range = 1e-4\nseparation_energy = 1", {"pairs[0].separation_energy", "keep one"});
  says("pull_off = 1\nadhesion_range = 0", {"pairs[0].adhesion_range = 0", "expected a value > 0"});
  says("pull_off = 1\nadhesion_range = \"1 s\"", {"a time", "expected a length"});
  says("pull_off = -1\nadhesion_range = 1e-4", {"pairs[0].pull_off = -1", "expected a value > 0"});
  says("adhesion = \"1 N\"\nadhesion_model = \"jkr\"\nadhesion_range = 1e-4", {"a force", "an energy per area"});
  says("pull_off = 1\nadhesion_model = \"jkr\"\nadhesion_range = 1e-4", {"pairs[0].adhesion_model", "goes with adhesion"});
  says("adhesion = 0.05\nadhesion_model = \"jkr\"\nseparation_energy = 1", {"pairs[0].separation_energy", "contact_radius"});
  // F_c^2 / (2 k) = 5e-8 J
  says("pull_off = 1\nseparation_energy = 4e-8", {"pairs[0].separation_energy", "is not above 50 nJ"});
  EXPECT_NO_THROW(pack(sticky("pull_off = 1\nseparation_energy = 6e-8")));
  EXPECT_NO_THROW(pack(sticky("adhesion = 0.05\nadhesion_model = \"dmt\"\nadhesion_range = 1e-4")));
}

TEST(Refusals, necks_and_bridges_that_are_not_told_in_full_or_do_not_go_together_are_refused) {
  const auto says = [](const std::string& keys, const std::vector<std::string>& parts, const std::string& more = "") {
    expect_says(failure(sticky(keys, more), ExitCode::usage), parts);
  };
  const std::string water = "surface_tension = \"72 mN/m\"\nbridge_volume = \"1 mm^3\"\n";
  EXPECT_NO_THROW(pack(sticky(water)));
  says("surface_tension = \"72 mN/m\"", {"pairs[0].surface_tension", "needs bridge_volume"});
  says("bridge_volume = \"1 mm^3\"", {"pairs[0].bridge_volume", "goes with surface_tension"});
  says("contact_angle = \"20 deg\"", {"pairs[0].contact_angle", "goes with surface_tension"});
  says("bridge_rupture = \"lian\"", {"pairs[0].bridge_rupture", "goes with surface_tension"});
  says(water + "contact_angle = \"95 deg\"", {"pairs[0].contact_angle", "95 degrees found", "less than 90"});
  says(water + "contact_angle = -0.1", {"pairs[0].contact_angle = -0.1", "a value >= 0"});
  says(water + "pull_off = 1\nadhesion_range = 1e-4", {"pairs[0].surface_tension", "keep one"});
  says(water + "adhesion_range = 1e-4", {"pairs[0].adhesion_range", "remove it"});
  says("surface_tension = \"72 mN\"\nbridge_volume = 1e-9", {"a force", "a surface tension"});
  says("surface_tension = 0.072\nbridge_volume = \"1 mm^2\"", {"an area", "a volume"});
  says(water + "bridge_rupture = \"never\"", {"pairs[0].bridge_rupture", "willett", "lian"});
  says(water, {"surface_tension", "gather = \"potential\""}, "[contact]\ngather = \"pairs\"\nmargin = 0.01\n");
  says("adhesion_hysteresis = true", {"pairs[0].adhesion_hysteresis", "goes with adhesion"});
  const std::string work = "adhesion = 0.05\nadhesion_hysteresis = true\n";
  says(work + "adhesion_model = \"dmt\"", {"pairs[0].adhesion_hysteresis", "adhesion_model = \"jkr\""});
  says(work + "adhesion_model = \"jkr\"", {"pairs[0].adhesion_hysteresis", "hertz-mindlin", "adhesion_range"});
}

TEST(Refusals, plastic_contacts_that_do_not_go_together_with_others_are_refused) {
  const auto says = [](const std::string& keys, const std::vector<std::string>& parts, const std::string& more = "") {
    expect_says(failure(sticky(keys, more), ExitCode::usage), parts);
  };
  EXPECT_NO_THROW(pack(sticky("plasticity = 0.5\nadhesive_ratio = 0.2")));
  says("plasticity = 1", {"pairs[0].plasticity", "1 found, expected less"});
  says("plasticity = 1.2", {"pairs[0].plasticity = 1.2"});
  says("plasticity = \"soft\"", {"pairs[0].plasticity"});
  says("adhesive_ratio = 0.2", {"pairs[0].adhesive_ratio", "goes with plasticity"});
  says("plasticity = 0.5\nadhesive_ratio = -1", {"pairs[0].adhesive_ratio = -1", "a value >= 0"});
  says("plasticity = 0.5\npull_off = 1\nadhesion_range = 1e-4", {"pairs[0].plasticity", "adhesive_ratio"});
  says("plasticity = 0.5", {"pairs[0].plasticity", "gather = \"potential\""}, "[contact]\ngather = \"pairs\"\nmargin = 0.01\n");
  says("plasticity = 0.5", {"pairs[0].plasticity", "contact.barrier"}, "[contact]\nbarrier = 1\nmargin = 0.01\n");
  says("plasticity = 0.5", {"pairs[0].plasticity", "on_overlap"}, "[contact]\non_overlap = \"continue\"\nmargin = 0.01\n");
}

TEST(Refusals, necks_are_those_of_balls) {
  const std::string materials =
      "[materials.stone]\ndensity = 2000\nyoung = 1e7\n[[pairs]]\nbetween = [\"stone\", \"stone\"]\nrestitution = 0.5\nadhesion = "
      "0.05\nadhesion_model = \"jkr\"\nadhesion_hysteresis = true\n";
  const auto scene = [&](const std::string& shape, const std::string& keys = "") {
    return "[time]\nduration = 1\n[contact]\nlaw = \"hertz-mindlin\"\nmargin = 0.001\nimpact_speed = 0.1\n" + shape + materials + keys +
           "[[bodies]]\nshape = \"grain\"\nmaterial = \"stone\"\nposition = [0, 0, 2]\n[[bodies]]\nshape = \"grain\"\nmaterial = "
           "\"stone\"\nposition = [0, 0, 4]\n";
  };
  const std::string ball = "[shapes.grain]\nsphere = { radius = 0.5 }\n";
  EXPECT_NO_THROW(pack(scene(ball)));
  expect_says(failure(scene(ball, "adhesion_range = 1e-4\n"), ExitCode::usage), {"pairs[0].adhesion_range", "the neck tears"});
  const std::string file = (std::filesystem::temp_directory_path() / fmt::format("scree_necks_{}.shape.h5", getpid())).string();
  write_shape_file(file, {make_solid("grain", box_mesh({1, 1, 1}))}, {{"tool", "scree-mesher"}});
  const std::string error = failure(scene(fmt::format("[shapes.grain]\nfile = \"{}\"\n", file)), ExitCode::usage);
  std::filesystem::remove(file);
  expect_says(error, {"body 0", "'grain'", "'stone'", "JKR", "adhesion_range"});
}

TEST(Refusals, attraction_by_area_is_told_as_work_over_a_range) {
  const std::string area = "[contact]\ngather = \"area\"\nmargin = 0.001\n";
  const auto says = [&](const std::string& keys, const std::vector<std::string>& parts) {
    std::string head = kHead;
    const std::string stiff = "stiffness = 1e7\n";
    const auto at = head.find("stiffness");
    ASSERT_NE(at, std::string::npos);
    head.replace(at, head.find('\n', at) - at, "layer_modulus = 1e7");
    expect_says(failure(sticky(keys, area, head), ExitCode::usage), parts);
  };
  says("pull_off = 1\nadhesion_range = 1e-4", {"pairs[0].pull_off", "gather = \"area\"", "adhesion"});
  says("adhesion = 0.05", {"pairs[0].adhesion", "needs adhesion_range"});
  says("adhesion = 0.05\nadhesion_model = \"jkr\"\nadhesion_range = 1e-4", {"pairs[0].adhesion_model", "gather = \"area\"", "remove it"});
  says("adhesion = 0.05\nseparation_energy = 1", {"pairs[0].separation_energy", "adhesion_range"});
  // 2 w / s = 10 MPa, as much as the layer bears at all
  says("adhesion = 500\nadhesion_range = 1e-4", {"10 MPa", "layer_modulus", "10 MPa"});
}

TEST(Refusals, friction_as_an_angle_is_answered_with_its_tangent) {
  std::string text = kHead + kMargin + "[[bodies]]\nshape = \"ball\"\nmaterial = \"stone\"\nposition = [0, 0, 3]\n";
  text.replace(text.find("restitution = 0.5"), 17, "restitution = 0.5\nfriction = \"22 deg\"");
  expect_says(failure(text, ExitCode::usage), {"friction = \"22 deg\"", "tangent", "write 0.404026"});
  text.replace(text.find("22 deg"), 6, "90 deg");
  expect_says(failure(text, ExitCode::usage), {"friction = \"90 deg\"", "tangent", "below 90"});
}

TEST(Refusals, balls_have_no_elastic_layer_where_they_touch_at_their_drawn_surface) {
  std::string head = kHead;
  const auto at = head.find("stiffness");
  ASSERT_NE(at, std::string::npos);
  head.replace(at, head.find('\n', at) - at, "layer_modulus = 1e7");
  const std::string body = "[[bodies]]\nshape = \"ball\"\nmaterial = \"stone\"\nposition = [0, 0, 3]\n";
  const auto says = [&](const std::string& keys, const std::string& part) {
    try {
      build_scene(parse_case(head + "[contact]\ngather = \"area\"\n" + keys + body, "case.toml", ""));
    } catch (const UsageError& e) {
      return expect_says(e.what(), {"gather = \"area\"", "elastic layer", part});
    }
    ADD_FAILURE() << keys;
  };
  says("margin = 0.001\n", "contact.surface = \"outside\"");
  says("margin = 0.001\nsurface = \"drawn\"\n", "contact.surface = \"outside\"");
  says("margin = 0\n", "contact.margin = 0");
  EXPECT_NO_THROW(
      build_scene(parse_case(head + "[contact]\ngather = \"area\"\nmargin = 0.001\nsurface = \"outside\"\n" + body, "case.toml", "")));
}

TEST(Refusals, attraction_goes_with_one_potential_and_without_cells) {
  const std::string keys = "pull_off = 1\nadhesion_range = 1e-4";
  expect_says(failure(sticky(keys, "[contact]\ngather = \"pairs\"\nmargin = 0.01\n"), ExitCode::usage),
              {"pull_off", "gather = \"potential\""});
  const std::string wall =
      "[[walls]]\nshape = { plate = { corner = [-1, -1, 0], side_a = [2, 0, 0], side_b = [0, 2, 0] } }\nmaterial = \"stone\"\ncell_size = "
      "0.5\n";
  expect_says(failure(sticky(keys, "[contact]\nmargin = 0.01\n" + wall), ExitCode::usage),
              {"walls[0].cell_size", "does not go with the attraction"});
}

TEST(Refusals, attraction_through_a_body_or_its_margins_is_refused) {
  // the pea is 0.8 m thick
  expect_says(failure(sticky("pull_off = 1\nadhesion_range = 0.81"), ExitCode::usage),
              {"810 mm", "body 1 ('pea')", "800 mm", "adhesion_range"});
  EXPECT_NO_THROW(pack(sticky("pull_off = 1\nadhesion_range = 0.79")));
  // F_c / k = 5 mm, margins of 4 mm
  expect_says(failure(sticky("pull_off = 50e3\nadhesion_range = 1e-2", kMargin), ExitCode::usage),
              {"'stone' and 'stone'", "50 kN", "5 mm deep", "margins of 4 mm", "raise the stiffness"});
  EXPECT_NO_THROW(pack(sticky("pull_off = 30e3\nadhesion_range = 1e-2", kMargin)));
}

TEST(Refusals, motions_of_a_wall_that_conflict_are_refused_with_their_line) {
  const std::string body = "[[bodies]]\nshape = \"ball\"\nscale = 0.05\nmaterial = \"stone\"\nposition = [0, 0, 3]\n";
  const std::string plate =
      "[[walls]]\nmaterial = \"stone\"\nshape = { plate = { corner = [-1, -1, 0], side_a = [3, 0, 0], side_b = [0, 3, 0] } }\nmotion = ";
  const auto with = [&](const std::string& motion) { return kHead + kMargin + body + plate + motion + "\n"; };
  const std::string turn = "{ rotate = { axis = [0, 0, 1], rate = 1 } }", along = "{ translate = { velocity = [0, 0, -1] } }";
  EXPECT_EQ(pack(with("[" + turn + ", " + along + "]")).scene.walls[0].motion.parts().size(), 2u);
  EXPECT_EQ(pack(with("[" + along + "]")).scene.walls[0].motion.parts().size(), 1u);
  // the same axis later, another axis, and translations one after the other are no conflict
  EXPECT_NO_THROW(pack(with("[" + turn + ", { rotate = { axis = [0, 1, 0], rate = 2 } }]")));
  EXPECT_NO_THROW(
      pack(with("[{ translate = { velocity = [0, 0, -1] }, stop = 0.5 }, { translate = { velocity = [1, 0, 0] }, start = 0.5 }]")));
  expect_says(failure(with("[" + turn + ", { rotate = { axis = [0, 0, -2], centre = [0, 0, 5], rate = 2 } }]"), ExitCode::usage),
              {"case.toml:", "motion[1].rotate", "conflicts", "same axis", "start"});
  expect_says(failure(with("[" + along + ", " + turn + ", { translate = { velocity = [1, 0, 0] } }]"), ExitCode::usage),
              {"case.toml:", "motion[2].translate", "conflicts"});
  expect_says(failure(with("[" + turn + ", { motor = { axis = [0, 0, 1], torque = 3, inertia = 1 } }]"), ExitCode::usage),
              {"case.toml:", "motion[1].motor", "answers to force", "alone"});
  expect_says(failure(with("[{ rotate = { axis = [0, 0, 1], rate = 1 }, translate = { velocity = [1, 0, 0] } }]"), ExitCode::usage),
              {"case.toml:", "motion[0]", "one of them"});
  expect_says(failure(with("[]"), ExitCode::usage), {"case.toml:", "motion", "empty list"});
}

}  // namespace
}  // namespace scree
