// Walls made from numbers: closed where they say so, open where they say so, facing inwards, of the right size.
#include "decomposer/case/wall_forms.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>
#include <numeric>

#include "core/base/error.hpp"
#include "core/geometry/features.hpp"
#include "core/geometry/mass_properties.hpp"
#include "decomposer/case/case_file.hpp"

namespace scree {
namespace {

constexpr double kPi = std::numbers::pi;
// Sums of a few hundred products of coordinates.
constexpr double kRounding = 1e-12;

/// Area of a regular polygon with its corners on a circle.
double polygon_area(double radius, int segments) { return 0.5 * segments * radius * radius * std::sin(2 * kPi / segments); }

/// Length of all edges that have a triangle on one side only; fails when an edge is used twice in the same direction.
double open_length(const TriangleMesh& mesh) {
  std::map<std::pair<std::int32_t, std::int32_t>, int> uses;
  for (const Triangle& t : mesh.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_EQ(++uses[std::make_pair(t[k], t[(k + 1) % 3])], 1) << "two triangles look to different sides";
    }
  }
  double sum = 0;
  for (const auto& [edge, count] : uses) {
    if (uses.contains({edge.second, edge.first})) continue;
    sum += length(mesh.vertices[static_cast<std::size_t>(edge.first)] - mesh.vertices[static_cast<std::size_t>(edge.second)]);
  }
  return sum;
}

void expect_closed_with_volume(const WallForm& form, double volume) {
  EXPECT_EQ(open_length(form.inside), 0);
  EXPECT_NEAR(mass_properties(form.inside).volume, volume, kRounding * volume);
}

/// The signed volume of a closed surface that faces inwards is that of its inside, with the other sign.
void expect_faces_inside(const WallForm& form) {
  const double inside = mass_properties(form.inside).volume;
  EXPECT_NEAR(mass_properties(form.surface).volume, -inside, kRounding * inside);
}

TEST(WallForms, a_cylinder_along_any_axis_is_closed_faces_inwards_and_holds_a_polygon_times_its_height) {
  const Vec3 start{0.3, -0.2, 0.5}, end{0.9, 0.4, 1.1};
  const WallForm form = cone_form(start, end, 0.25, 0.25, false, false, 48);
  expect_closed_with_volume(form, polygon_area(0.25, 48) * length(end - start));
  EXPECT_EQ(open_length(form.surface), 0);
  expect_faces_inside(form);
}

TEST(WallForms, an_open_end_is_one_rim_and_a_tube_has_two) {
  const double rim = 2 * 20 * 0.1 * std::sin(kPi / 20);
  EXPECT_NEAR(open_length(cone_form({}, {0, 0, 1}, 0.1, 0.1, true, false, 20).surface), rim, kRounding);
  EXPECT_NEAR(open_length(cone_form({}, {0, 0, 1}, 0.1, 0.1, false, true, 20).surface), rim, kRounding);
  EXPECT_NEAR(open_length(cone_form({}, {0, 0, 1}, 0.1, 0.1, true, true, 20).surface), 2 * rim, kRounding);
}

TEST(WallForms, frustums_and_cones_hold_what_the_formula_of_the_prismatoid_says) {
  const double ratio = polygon_area(1, 32);
  expect_closed_with_volume(cone_form({}, {0, 0, 0.6}, 0.3, 0.1, false, false, 32), ratio * 0.6 / 3 * (0.09 + 0.03 + 0.01));
  for (const bool tip_is_end : {false, true}) {
    const WallForm cone = cone_form({1, 0, 0}, {1, 0, 0.6}, tip_is_end ? 0.3 : 0, tip_is_end ? 0 : 0.3, false, false, 32);
    expect_closed_with_volume(cone, ratio * 0.6 / 3 * 0.09);
    expect_faces_inside(cone);
  }
}

TEST(WallForms, a_box_leaves_out_the_sides_that_are_open) {
  const Vec3 lower{-1, 2, 0}, upper{1, 5, 7};
  const WallForm closed = box_form(lower, upper, {});
  expect_closed_with_volume(closed, 2 * 3 * 7);
  expect_faces_inside(closed);
  const WallForm bin = box_form(lower, upper, {false, false, false, false, false, true});
  EXPECT_NEAR(open_length(bin.surface), 2 * (2 + 3), kRounding);
  EXPECT_NEAR(surface_area(bin.surface), 2 * 3 + 2 * 7 * (2 + 3), kRounding);
  expect_closed_with_volume(bin, 2 * 3 * 7);
}

TEST(WallForms, a_hopper_is_a_bin_on_a_funnel_on_a_stub) {
  Hopper h;
  h.outlet[0] = h.outlet[1] = 0.04;
  h.bin[0] = h.bin[1] = 0.2;
  h.funnel_height = 0.1;
  h.bin_height = 0.3;
  h.stub = 0.02;
  const WallForm round = hopper_form(h, 40);
  const double unit = polygon_area(1, 40);
  expect_closed_with_volume(round, unit * (0.1 * 0.1 * 0.3 + 0.1 / 3 * (0.01 + 0.002 + 0.0004) + 0.02 * 0.02 * 0.02));
  const double outline = 2 * 40 * std::sin(kPi / 40);
  EXPECT_NEAR(open_length(round.surface), outline * (0.1 + 0.02), kRounding);

  // a wedge: as long as its bin in y, volume by its cross-section
  h.round = false;
  h.outlet[1] = h.bin[1] = 0.3;
  h.stub = 0;
  expect_closed_with_volume(hopper_form(h, 40), 0.3 * (0.2 * 0.3 + 0.5 * (0.2 + 0.04) * 0.1));
  // a flat floor with a slot
  h.funnel_height = 0;
  expect_closed_with_volume(hopper_form(h, 40), 0.3 * 0.2 * 0.3);
}

TEST(WallForms, a_drum_loses_the_cross_section_of_its_lifters) {
  const double radius = 0.5, height = 0.1, width = 0.08, top = 0.04;
  const Lifters lifters{8, height, width, top};
  const int segments = 1024;  // the circle to 6e-6
  const WallForm form = drum_form({}, {0, 0.3, 0}, radius, lifters, false, false, segments);
  // the trapezoid stands on the arc: its chord lies below it by the height of a circular segment
  const double half = std::asin(0.5 * width / radius);
  const double trapezoid = 0.5 * (width + top) * (radius * std::cos(half) - (radius - height));
  const double arc_segment = radius * radius * (half - 0.5 * std::sin(2 * half));
  const double volume = 0.3 * (kPi * radius * radius - 8 * (trapezoid + arc_segment));
  EXPECT_EQ(open_length(form.inside), 0);
  EXPECT_EQ(open_length(form.surface), 0);
  EXPECT_NEAR(mass_properties(form.inside).volume, volume, 1e-5 * volume);
  expect_faces_inside(form);
}

TEST(WallForms, the_corners_of_a_lifter_are_the_only_edges_of_a_drum_that_carry_contacts) {
  const WallForm drum = drum_form({}, {0, 0.3, 0}, 0.5, {6, 0.1, 0.08, 0.04}, false, false, 64);
  const FeatureTable features = find_features(drum.surface);
  // two long edges on each lifter; its ends meet the lids in concave corners
  EXPECT_EQ(features.edges.size(), 12u);
}

TEST(WallForms, a_ring_has_the_area_between_two_polygons) {
  EXPECT_NEAR(surface_area(disc_form({1, 1, 1}, normalised(Vec3{1, 1, 0}), 0.4, 0.1, 24).surface),
              polygon_area(0.4, 24) - polygon_area(0.1, 24), kRounding);
  EXPECT_NEAR(surface_area(disc_form({}, {0, 0, 1}, 0.4, 0, 24).surface), polygon_area(0.4, 24), kRounding);
  EXPECT_NEAR(surface_area(plate_form({}, {2, 0, 0}, {1, 3, 0}).surface), 6, kRounding);
}

TEST(WallForms, any_simple_outline_is_filled_with_triangles_of_its_own_area) {
  // a comb: no point sees all of it
  std::vector<std::array<double, 2>> comb{{0, 0}, {10, 0}};
  for (int tooth = 4; tooth >= 0; --tooth) {
    for (const auto& [x, y] : {std::pair{1.5, 5.0}, {0.5, 5.0}, {0.5, 1.0}, {0.0, 1.0}}) comb.push_back({2.0 * tooth + x, y});
  }
  double area = 0, covered = 0;
  for (std::size_t i = 0; i < comb.size(); ++i) {
    const auto &p = comb[i], &q = comb[(i + 1) % comb.size()];
    area += 0.5 * (p[0] * q[1] - p[1] * q[0]);
  }
  const std::vector<Triangle> triangles = triangulate_polygon(comb);
  EXPECT_EQ(triangles.size(), comb.size() - 2);
  for (const Triangle& t : triangles) {
    const auto at = [&](std::size_t k) { return comb[static_cast<std::size_t>(t[k])]; };
    const double doubled = (at(1)[0] - at(0)[0]) * (at(2)[1] - at(0)[1]) - (at(1)[1] - at(0)[1]) * (at(2)[0] - at(0)[0]);
    EXPECT_GT(doubled, 0);
    covered += 0.5 * doubled;
  }
  EXPECT_NEAR(covered, area, kRounding * area);
}

// ---- what a case may say ----

Case parse_wall(const std::string& shape, const std::string& more = "") {
  return parse_case("[time]\nduration = 0\n[materials.steel]\ndensity = 7800\n[[walls]]\nname = \"it\"\nmaterial = \"steel\"\nshape = { " +
                        shape + " }\n" + more,
                    "case.toml", "");
}

void expect_refusal(const std::string& shape, const std::string& says, const std::string& more = "") {
  try {
    parse_wall(shape, more);
    ADD_FAILURE() << shape << " was not refused";
  } catch (const UsageError& e) {
    EXPECT_NE(std::string(e.what()).find(says), std::string::npos) << "'" << says << "' not in: " << e.what();
  }
}

TEST(WallForms, a_case_names_forms_with_units) {
  const Case c = parse_wall("hopper = { outlet = \"4 cm\", bin = \"20 cm\", half_angle = \"45 deg\", bin_height = 0.3, segments = 40 }",
                            "position = [0, 0, 1]\n");
  ASSERT_TRUE(c.walls[0].form);
  EXPECT_EQ(c.walls[0].wall.position, (Vec3{0, 0, 1}));
  // 45 degrees: as high as the radii differ
  EXPECT_NEAR(bounding_box(c.walls[0].form->surface).upper.z, 0.08 + 0.3, kRounding);
  EXPECT_NEAR(
      bounding_box(
          parse_wall("hopper = { outlet = [0.1, 0.2], bin = [0.3, 0.2], half_angle = \"90 deg\", bin_height = 1 }").walls[0].form->surface)
          .upper.z,
      1, kRounding);
}

TEST(WallForms, forms_that_cannot_be_are_refused) {
  expect_refusal("cone = { start = [0, 0, 0], end = [0, 0, 1], radius_start = 0, radius_end = 0 }", "must be > 0");
  expect_refusal("cylinder = { start = [0, 0, 1], end = [0, 0, 1], radius = 1 }", "is the same as start");
  expect_refusal("cylinder = { start = [0, 0, 0], end = [0, 0, 1], radius = 1, segments = 2 }", "at least 3");
  expect_refusal("cylinder = { start = [0, 0, 0], end = [0, 0, 1], radius = 1, open = [\"top\"] }", "defined are: start, end");
  expect_refusal("box = { corners = [[0, 0, 0], [1, 1, 1]], open = [\"-x\", \"+x\", \"-y\", \"+y\", \"-z\", \"+z\"] }", "leaves no side");
  expect_refusal("hopper = { outlet = 0.2, bin = 0.1, half_angle = 0.5, bin_height = 1 }", "wider than the outlet");
  expect_refusal("hopper = { outlet = 0.1, bin = [0.2, 0.2], half_angle = 0.5, bin_height = 1 }", "both be diameters");
  expect_refusal("hopper = { outlet = 0.1, bin = 0.2, half_angle = \"91 deg\", bin_height = 1 }", "at most 90 deg");
  expect_refusal("hopper = { outlet = 0.1, bin = 0.2, bin_height = 1 }", "half_angle, funnel_height");
  expect_refusal("plate = { corner = [0, 0, 0], side_a = [1, 0, 0], side_b = [2, 0, 0] }", "parallel");
  expect_refusal("disc = { centre = [0, 0, 0], normal = [0, 0, 1], radius = 1, hole = 1 }", "less than that of the disc");
  const std::string drum = "drum = { start = [0, 0, 0], end = [0, 0, 1], radius = 1, lifters = { ";
  expect_refusal(drum + "count = 4, height = 1, width = 0.1 } }", "less than the radius");
  expect_refusal(drum + "count = 40, height = 0.5, width = 0.1 } }", "leave no room");
  expect_refusal("box_inside = [[0, 0, 0], [1, 1, 1]]", "walls that are meshes", "position = [0, 0, 1]\n");
}

}  // namespace
}  // namespace scree
