// Walls made from numbers: closed where they say so, open where they say so, facing inwards, of the right size.
#include "decomposer/case/wall_forms.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <span>
#include <tuple>

#include "core/base/error.hpp"
#include "core/geometry/features.hpp"
#include "core/geometry/mass_properties.hpp"
#include "decomposer/case/case_file.hpp"
#include "decomposer/case/machine_forms.hpp"

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

TEST(WallForms, a_trough_is_half_a_tube_under_a_box_and_open_above) {
  for (const Vec3& direction : {Vec3{1, 0, 0}, {0, -1, 0}, {0.6, 0.8, 0}}) {
    const Vec3 start{0.3, -0.2, 0.5};
    const WallForm form = trough_form(start, start + 2.0 * direction, 0.25, 0.4, false, false, 48);
    expect_closed_with_volume(form, 2 * (0.5 * polygon_area(0.25, 48) + 0.5 * 0.4));
    EXPECT_NEAR(open_length(form.surface), 2 * (2 + 0.5), 1e-12) << "its rim";
    EXPECT_NEAR(bounding_box(form.surface).upper.z, 0.5 + 0.4, 1e-12);
    EXPECT_NEAR(bounding_box(form.surface).lower.z, 0.5 - 0.25, 1e-12);
    // open, it has one rim around
    const WallForm gutter = trough_form(start, start + 2.0 * direction, 0.25, 0.4, true, true, 48);
    EXPECT_NEAR(open_length(gutter.surface), 2 * (2 + 0.4 + 0.4 + 24 * 2 * 0.25 * std::sin(kPi / 48)), 1e-12);
  }
}

TEST(WallForms, a_screw_fills_its_shaft_and_a_part_of_the_ring_around_it) {
  const Vec3 start{0.1, 0.2, 0.3}, end{0.1, 1.0, 0.9};  // a length of 1
  for (const auto& [starts, pitch, left] : {std::tuple(1, 0.4, false), {1, 0.4, true}, {2, 0.6, false}, {3, 3.0, true}}) {
    SCOPED_TRACE(fmt::format("{} flights, pitch {}", starts, pitch));
    const Screw screw{0.05, 0.2, pitch, 0.1, starts, left};
    ASSERT_STREQ(fault_of(screw), "");
    EXPECT_NEAR(area_of(screw), kPi * (0.0025 + 0.0375 * starts * 0.1 / pitch), 1e-15);
    double error[2];
    for (int k = 0; k < 2; ++k) {
      const TriangleMesh mesh = screw_form(start, end, screw, k == 0 ? 60 : 120).surface;  // steps that double
      EXPECT_EQ(open_length(mesh), 0);
      error[k] = 1 - mass_properties(mesh).volume / area_of(screw);
    }
    EXPECT_LT(std::abs(error[1]), 1e-2);
    EXPECT_NEAR(error[0] / error[1], 4, 0.5) << "second order";
    // nothing is beyond its rim or its ends, and the middle of a flight points up in the middle of the shaft
    const TriangleMesh mesh = screw_form(start, end, screw, 96).surface;
    const Vec3 axis = end - start, up = across(axis).first, side = across(axis).second;
    double least = 1;
    for (const Vec3& p : mesh.vertices) {
      const Vec3 d = p - start;
      const double along = dot(d, axis), out = length(d - along * axis);
      EXPECT_TRUE(along > -1e-12 && along < 1 + 1e-12 && out < 0.2 + 1e-12);
      if (std::abs(out - 0.2) > 1e-9) continue;
      // of points on the rim, the angle in the frame that goes round with the flights
      const double angle = std::atan2(dot(d, side), dot(d, up)) - (left ? -1 : 1) * 2 * kPi * (along - 0.5) / pitch;
      const double of_start = std::remainder(angle, 2 * kPi / starts);
      EXPECT_LT(std::abs(of_start), kPi * 0.1 / pitch + 1e-9);
      least = std::min(least, std::abs(of_start));
    }
    EXPECT_LT(least, 0.1);
  }
}

TEST(WallForms, paddles_are_boxes_within_their_circle) {
  Paddles paddles{0.05, 0.3, 5, 0.1, 0.02};
  const WallForm form = paddles_form({0, 0, 1}, {2, 0, 1}, paddles, 24);
  EXPECT_EQ(open_length(form.surface), 0);
  const double h = 0.5 * (0.1 + 0.02) * std::sin(kPi / 4);
  EXPECT_NEAR(reach_across(paddles), h, 1e-15);
  EXPECT_NEAR(mass_properties(form.surface).volume, 2 * polygon_area(0.05, 24) + 5 * std::sqrt(0.09 - h * h) * 0.1 * 0.02, 1e-14);
  double farthest = 0;
  for (const Vec3& p : form.surface.vertices) farthest = std::max(farthest, std::hypot(p.y, p.z - 1));
  EXPECT_NEAR(farthest, 0.3, 1e-14);
  // the first points up, the second a quarter turn on, counter-clockwise seen against the axis; a positive angle as a right-handed screw
  const auto blade = [&](std::size_t i) { return std::span(form.surface.vertices).subspan(form.surface.vertices.size() - 8 * (5 - i), 8); };
  for (const Vec3& p : blade(0)) EXPECT_GT(p.z, 1 - 1e-14);
  for (const Vec3& p : blade(1)) EXPECT_LT(p.y, 1e-14);
  Vec3 moment;
  for (const Vec3& p : blade(0)) moment += (p.x - 0.2) * Vec3{0, p.y, 0};
  EXPECT_LT(moment.y, 0) << "turning on from up is towards -y: the blade's forward edge lies there";
  paddles.angle = -paddles.angle;
  EXPECT_NEAR(mass_properties(paddles_form({0, 0, 1}, {2, 0, 1}, paddles, 24).surface).volume, mass_properties(form.surface).volume, 1e-14);
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
  expect_refusal(drum + "count = 3, height = 0.02, width = 0.5 } }", "stand outside the drum");
  // inside the circle, and outside of the facets
  expect_refusal(drum + "count = 6, height = 0.01, width = 0.02, top_width = 0.27 } }", "stand outside the drum");
  expect_refusal(drum + "count = 1, height = 0.02, width = 0.01, top_width = 0.2 }, segments = 8 }", "stand outside the drum");
  const std::string shaft = "start = [0, 0, 0], end = [1, 0, 0], radius = 0.2, shaft = ";
  expect_refusal("screw = { " + shaft + "0.2, pitch = 1, thickness = 0.1 }", "less than the radius of the flights");
  expect_refusal("screw = { " + shaft + "0.1, pitch = 0, thickness = 0.1 }", "must not be 0");
  expect_refusal("screw = { " + shaft + "0.1, pitch = -0.3, thickness = 0.1, starts = 3 }", "leave no room");
  expect_refusal("screw = { " + shaft + "0.1, pitch = 1e-3, thickness = 1e-4, segments = 1000 }", "triangles of this screw");
  expect_refusal("paddles = { " + shaft + "0.3, count = 3, width = 0.1, thickness = 0.01 }", "less than the radius");
  expect_refusal("paddles = { " + shaft + "0.1, count = 3, width = 0.6, thickness = 0.01 }", "more than the circle");
  expect_refusal("paddles = { " + shaft + "0.1, count = 20000, width = 0.1, thickness = 0.01 }", "at most 10000");
  expect_refusal("trough = { start = [0, 0, 0], end = [1, 0, 0.1], radius = 1, height = 1 }", "0.1 m higher than start");
  expect_refusal("trough = { start = [0, 0, 0], end = [1, 0, 0], radius = 1, height = 1, open = [\"top\"] }", "defined are: start, end");
  expect_refusal("box_inside = [[0, 0, 0], [1, 1, 1]]", "walls that are meshes", "position = [0, 0, 1]\n");
}

}  // namespace
}  // namespace scree
