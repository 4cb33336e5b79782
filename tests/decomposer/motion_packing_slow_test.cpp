// Balls grown to random close packing: 20 to 30 runs of the solver each.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/base/error.hpp"
#include "decomposer/packing/build_scene.hpp"
#include "tests/support/margins.hpp"

namespace scree {
namespace {

constexpr double kSide = 0.1;  // [m] of a periodic box: 1200 balls of 1 cm

PackedScene grow_balls(const std::string& solid_fraction) {
  const std::string text = R"(
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
[contact]
margin = "5 um"
[domain]
min = [0, 0, 0]
max = [0.1, 0.1, 0.1]
periodic = ["x", "y", "z"]
[[populations]]
shape = "ball"
material = "glass"
solid_fraction = )" + solid_fraction +
                           R"(
method = "compact"
region = { box = [[0, 0, 0], [0.1, 0.1, 0.1]] }
)";
  return build_scene(test::touching_outside(parse_case(text, "case.toml", "")), {{SCREE_SOLVER}});
}

// Random close packing of equal balls: 0.64 (Scott and Kilgour (1969), J. Phys. D 2, 863: 0.6366; O'Hern et al. (2003), Phys. Rev. E 68,
// 011306: 0.639).

TEST(MotionPackingSlow, balls_are_grown_to_random_close_packing_without_overlap) {
  const BodyTable b = grow_balls("0.63").scene.bodies;
  EXPECT_NEAR(static_cast<double>(b.size()) * (std::numbers::pi / 6e6) / (kSide * kSide * kSide), 0.63, 0.01);
  for (std::size_t i = 0; i < b.size(); ++i) {
    ASSERT_EQ(b.scale[i], 1);
    for (std::size_t j = 0; j < i; ++j) {
      Vec3 d = b.position[i] - b.position[j];
      for (int k = 0; k < 3; ++k) d[k] -= kSide * std::round(d[k] / kSide);
      ASSERT_GT(length(d), 0.01) << i << " and " << j;
    }
  }
}

TEST(MotionPackingSlow, more_than_random_close_packing_ends_with_what_was_reached) {
  try {
    grow_balls("0.66");
  } catch (const InputError& e) {
    const std::string says = e.what();
    const auto at = says.find("jammed at a solid fraction of 0.");
    ASSERT_NE(at, std::string::npos) << says;
    const double reached = std::stod(says.substr(at + 30));
    EXPECT_GT(reached, 0.62);
    EXPECT_LT(reached, 0.65);
    return;
  }
  FAIL() << "balls were packed to 0.66";
}

}  // namespace
}  // namespace scree
