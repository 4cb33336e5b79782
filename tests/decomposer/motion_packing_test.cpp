// Packings that the solver makes: poured beds and grown ones.
#include <gtest/gtest.h>

#include <cstdlib>
#include <numbers>

#include "core/base/error.hpp"
#include "decomposer/packing/build_scene.hpp"
#include "tests/support/margins.hpp"

namespace scree {
namespace {

const std::string kHead = R"(
seed = 4
[time]
duration = 1
[shapes.ball]
sphere = { radius = "5 mm" }
[materials.glass]
density = 2500
[[pairs]]
between = ["glass", "glass"]
stiffness = 2e4
restitution = 0.3
friction = 0.4
[contact]
margin = "100 um"
)";
constexpr double kGapOfMargins = 2e-4;

PackedScene pack(const std::string& text, const ChildSolver& solver = {{SCREE_SOLVER}}) {
  return build_scene(test::touching_outside(parse_case(text, "case.toml", "")), solver);
}

std::string failure(const std::string& text, ExitCode code = ExitCode::bad_data, const ChildSolver& solver = {{SCREE_SOLVER}}) {
  try {
    pack(text, solver);
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), code) << e.what();
    return e.what();
  }
  ADD_FAILURE() << "nothing was refused";
  return "";
}

const std::string kPoured = R"(
[[populations]]
shape = "ball"
material = "glass"
count = 40
method = "settle"
region = { box = [[0, 0, 0], [0.04, 0.04, 0.05]] }
[[walls]]
shape = { box_inside = [[0, 0, 0], [0.04, 0.04, 0.06]] }
material = "glass"
)";

TEST(MotionPacking, a_population_of_which_nothing_settles_in_its_region_is_refused) {
  std::string text = kHead + kPoured;
  text.replace(text.find("[[0, 0, 0], [0.04, 0.04, 0.05]]"), 31, "[[0, 0, 0.03], [0.04, 0.04, 0.06]]");
  text.replace(text.find("count = 40"), 10, "count = 4");
  EXPECT_NE(failure(text).find("none of its bodies lies in its region after settling"), std::string::npos);
}

// A count that is asked for is met or refused: what rests below its region is never left out without a word.
TEST(MotionPacking, a_population_that_would_be_smaller_than_requested_is_refused_with_the_cure) {
  std::string text = kHead + kPoured;
  text.replace(text.find("[[0, 0, 0], [0.04, 0.04, 0.05]]"), 31, "[[0, 0, 0.009], [0.04, 0.04, 0.06]]");
  const std::string message = failure(text);
  EXPECT_NE(message.find("case.toml:"), std::string::npos) << message;
  EXPECT_NE(message.find(" of 40 bodies came to rest outside their region and would be missing"), std::string::npos) << message;
  EXPECT_NE(message.find("the region from (0 m, 0 m, 9 mm) to (40 mm, 40 mm, 60 mm)"), std::string::npos) << message;
  EXPECT_NE(message.find("inside_wall"), std::string::npos) << message;
  text.replace(text.find("count = 40"), 10, "fill = true");
  const PackedScene packed = pack(text);
  bool is_told = false;
  for (const std::string& notice : packed.report.notices)
    is_told = is_told || notice.find(fmt::format("outside their region and were removed, {} are left", packed.scene.bodies.size())) !=
                             std::string::npos;
  EXPECT_TRUE(is_told);
}

// Without margins what rests on a side of its region reaches a little out of it.
TEST(MotionPacking, balls_without_margins_that_press_on_the_sides_of_their_region_stay) {
  std::string text = kHead + kPoured;
  text.replace(text.find("margin = \"100 um\""), 17, "margin = 0");
  text.replace(text.find("stiffness = 2e4"), 15, "stiffness = 2e5");
  EXPECT_EQ(pack(text).scene.bodies.size(), 40u);
}

TEST(MotionPacking, a_poured_bed_lies_on_the_floor_and_on_itself) {
  // 40 balls in four layers: far more than random addition gets into this box
  const PackedScene packed = pack(kHead + kPoured);
  const BodyTable& b = packed.scene.bodies;
  ASSERT_EQ(b.size(), 40u);
  double on_floor = 0;
  for (std::size_t i = 0; i < b.size(); ++i) {
    EXPECT_EQ(b.id[i], static_cast<std::int64_t>(i) + 1);  // after the wall, without gaps
    EXPECT_EQ(b.velocity[i], (Vec3{}));
    EXPECT_EQ(b.fixed[i], 0);
    // nothing hangs in the air: something below is closer than the margins
    bool held = b.position[i].z < 0.005 + kGapOfMargins;
    on_floor += held ? 1 : 0;
    for (std::size_t j = 0; j < b.size(); ++j) {
      if (i == j) continue;
      const double distance = length(b.position[i] - b.position[j]);
      EXPECT_GT(distance, 0.01);  // no overlap
      held = held || (distance < 0.01 + kGapOfMargins && b.position[j].z < b.position[i].z);
    }
    EXPECT_TRUE(held) << "body " << i << " at " << b.position[i].z;
  }
  EXPECT_GT(on_floor, 8);
  EXPECT_NEAR(packed.report.solid_fraction[0], 40 * std::numbers::pi / 6e6 / 8e-5, 1e-12);
}

TEST(MotionPacking, the_same_seed_pours_the_same_bed_on_any_number_of_ranks_and_threads) {
  // as in a container: root, and more ranks than cores
  for (const char* variable : {"OMPI_ALLOW_RUN_AS_ROOT", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "OMPI_MCA_rmaps_base_oversubscribe",
                               "PRTE_ALLOW_RUN_AS_ROOT", "PRTE_ALLOW_RUN_AS_ROOT_CONFIRM"}) {
    setenv(variable, "1", 0);
  }
  setenv("PRTE_MCA_rmaps_default_mapping_policy", ":oversubscribe", 0);  // Open MPI 5
  setenv("OMP_NUM_THREADS", "2", 1);
  const Scene one = pack(kHead + kPoured).scene;
  setenv("OMP_NUM_THREADS", "1", 1);
  const Scene two = pack(kHead + kPoured, {{SCREE_MPIEXEC, "-n", "2", SCREE_SOLVER}}).scene;
  ASSERT_EQ(one.bodies.size(), two.bodies.size());
  EXPECT_EQ(one.bodies.position, two.bodies.position);
  EXPECT_EQ(one.bodies.orientation, two.bodies.orientation);
}

TEST(MotionPacking, a_region_is_filled_and_trimmed_and_more_than_fits_is_refused) {
  std::string text = kHead + kPoured;
  text.replace(text.find("count = 40"), 10, "fill = true");
  // a lid at the region's top would hide what trimming does: the box is higher
  const PackedScene packed = pack(text);
  double top = 0;
  for (const Vec3& p : packed.scene.bodies.position) {
    EXPECT_LE(p.z, 0.045);
    top = std::max(top, p.z);
  }
  EXPECT_GT(top, 0.03);
  // balls beside walls four diameters apart: looser than a wide bed, but far beyond random addition
  EXPECT_GT(packed.report.solid_fraction[0], 0.4);
  text.replace(text.find("fill = true"), 11, "count = 100");
  const std::string says = failure(text);
  EXPECT_NE(says.find("the region is full: "), std::string::npos) << says;
  EXPECT_NE(says.find(" of 100 bodies were poured"), std::string::npos) << says;
}

const std::string kGrown = R"(
[domain]
min = [0, 0, 0]
max = [0.045, 0.045, 0.045]
periodic = ["x", "y", "z"]
[[populations]]
shape = "ball"
material = "glass"
solid_fraction = 0.55
method = "compact"
region = { box = [[0, 0, 0], [0.045, 0.045, 0.045]] }
)";

TEST(MotionPacking, a_grown_packing_has_its_fraction_and_no_overlap) {
  const PackedScene packed = pack(kHead + kGrown);
  const BodyTable& b = packed.scene.bodies;
  const double ball = std::numbers::pi / 6e6;
  EXPECT_NEAR(static_cast<double>(b.size()) * ball / std::pow(0.045, 3), 0.55, 0.5 * ball / std::pow(0.045, 3));
  for (std::size_t i = 0; i < b.size(); ++i) {
    EXPECT_EQ(b.scale[i], 1);
    for (std::size_t j = 0; j < i; ++j) {
      Vec3 d = b.position[i] - b.position[j];
      for (int k = 0; k < 3; ++k) d[k] -= 0.045 * std::round(d[k] / 0.045);
      EXPECT_GT(length(d), 0.01);
    }
  }
}

TEST(MotionPacking, a_packing_that_jams_says_what_it_reached) {
  std::string text = kHead + kGrown;
  text.replace(text.find("0.55"), 4, "0.72");
  const std::string says = failure(text);
  const auto at = says.find("jammed at a solid fraction of 0.");
  ASSERT_NE(at, std::string::npos) << says;
  const double reached = std::stod(says.substr(at + 30));
  EXPECT_GT(reached, 0.5);
  EXPECT_LT(reached, 0.68);  // a few dozen balls in a periodic box, crystals apart, jam near 0.6
}

TEST(MotionPacking, what_cannot_be_poured_is_refused) {
  EXPECT_NE(failure("gravity = [0, 0, 0]\n" + kHead + kPoured, ExitCode::usage).find("needs gravity"), std::string::npos);
  EXPECT_NE(failure(kHead + kPoured, ExitCode::system, {{"no-such-solver"}}).find("give its command with --solver"), std::string::npos);
  // no floor: the solver says who left, in its own words
  std::string open = kHead + kPoured.substr(0, kPoured.find("[[walls]]")) + "[domain]\nmin = [0, 0, 0]\nmax = [1, 1, 1]\n";
  EXPECT_NE(failure(open).find("left the domain"), std::string::npos);
  EXPECT_NE(failure(kHead + kPoured.substr(0, kPoured.find("[[walls]]")), ExitCode::usage).find("needs a wall or a fixed body below"),
            std::string::npos);
}

}  // namespace
}  // namespace scree
