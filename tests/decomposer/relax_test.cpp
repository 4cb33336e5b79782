// Gentle starts: what margins there are, and what becomes of bodies that start inside them (contact.relax).
#include <gtest/gtest.h>
#include <unistd.h>
#include <nlohmann/json.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>

#include "core/base/error.hpp"
#include "core/base/units.hpp"
#include "decomposer/packing/build_scene.hpp"
#include "tests/support/margins.hpp"

namespace scree {
namespace {

namespace fs = std::filesystem;

class Relaxing : public ::testing::Test {
 protected:
  Relaxing() : folder_(fs::temp_directory_path() / ("scree_relax_" + std::to_string(getpid()))) {
    fs::create_directories(folder_);
    write_shape_file((folder_ / "cube.shape.h5").string(), {make_solid("cube", box_mesh({0.1, 0.1, 0.1}))}, {{"tool", "test"}});
  }
  ~Relaxing() override { fs::remove_all(folder_); }

  PackedScene pack(const std::string& text) const {
    return build_scene(test::touching_outside(parse_case(text, "case.toml", folder_.string())));
  }
  std::string failure(const std::string& text) const {
    try {
      pack(text);
    } catch (const Error& e) {
      return e.what();
    }
    ADD_FAILURE() << "nothing was refused";
    return "";
  }
  fs::path folder_;
};

std::string head(const std::string& contact, double stiffness = 1e6) {
  const bool is_hertz = contact.find("hertz") != std::string::npos;
  return fmt::format(
      "gravity = [0, 0, -9.81]\n[time]\nduration = 1\n[shapes.cube]\nfile = \"cube.shape.h5\"\n[shapes.ball]\nsphere = {{ radius = 0.05 "
      "}}\n"
      "[materials.m]\ndensity = 2500\nyoung = 1e9\n[[pairs]]\nbetween = [\"m\", \"m\"]\n{}restitution = 1\n[contact]\n{}\n",
      is_hertz ? "" : fmt::format("stiffness = {}\n", stiffness), contact);
}
std::string body(const std::string& shape, double x, double y, double z, const std::string& more = "") {
  return fmt::format("[[bodies]]\nshape = \"{}\"\nmaterial = \"m\"\nposition = [{}, {}, {}]\n{}\n", shape, x, y, z, more);
}
std::string ball(double x, double y, double z, const std::string& more = "") { return body("ball", x, y, z, more); }
const std::string kFloor = "[[walls]]\nshape = { plane = { point = [0, 0, 0], normal = [0, 0, 1] } }\nmaterial = \"m\"\n";
std::string box(double width, double height) {
  return fmt::format("[[walls]]\nshape = {{ box_inside = [[0, 0, 0], [{}, {}, {}]] }}\nmaterial = \"m\"\n", width, width, height);
}
/// What was reported of the start.
std::string told(const PackedScene& packed) {
  std::string text;
  for (const std::string& notice : packed.report.notices) {
    if (notice.find("separated") != std::string::npos || notice.find("starts") != std::string::npos) text += notice + "\n";
  }
  return text;
}

/// Smallest gap between balls of one radius, across periodic sides of the length `period` too.
double smallest_gap(const std::vector<Vec3>& x, double radius, double period = 0) {
  double least = 1e300;
  for (std::size_t i = 0; i < x.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      Vec3 d = x[i] - x[j];
      if (period > 0) d.x -= period * std::round(d.x / period);
      least = std::min(least, length(d) - 2 * radius);
    }
  }
  return least;
}

TEST_F(Relaxing, spheres_among_themselves_and_analytic_walls_have_no_margin_in_any_law) {
  for (const std::string law : {"linear", "hunt-crossley", "hertz-mindlin"}) {
    const PackedScene packed = pack(head("law = \"" + law + "\"") + ball(0, 0, 0.0502) + kFloor);
    EXPECT_EQ(packed.scene.settings.margin, 0) << law;
    EXPECT_EQ(packed.scene.bodies.position[0], (Vec3{0, 0, 0.0502})) << law;
  }
  const std::string plate =
      "[[walls]]\nshape = { plate = { corner = [-1, -1, -1], side_a = [2, 0, 0], side_b = [0, 2, 0] } }\nmaterial = \"m\"\n";
  EXPECT_GT(pack(head("") + ball(0, 0, 0.1) + plate).scene.settings.margin, 0);
  EXPECT_GT(pack(head("") + ball(0, 0, 0.1) + body("cube", 1, 0, 0.1)).scene.settings.margin, 0);
  EXPECT_GT(pack(head("barrier = 1") + ball(0, 0, 0.1) + kFloor).scene.settings.margin, 0) << "a barrier needs margins";
  EXPECT_EQ(pack(head("margin = \"1 mm\"") + ball(0, 0, 0.1) + kFloor).scene.settings.margin, 0.001) << "what is given is kept";
}

TEST_F(Relaxing, spheres_that_would_be_pressed_flat_are_refused_with_a_stiffness) {
  EXPECT_NE(failure(head("", 1e3) + ball(0, 0, 5) + kFloor).find("a stiffness of"), std::string::npos);
  EXPECT_NO_THROW(pack(head("margin = 0", 1e3) + ball(0, 0, 5) + kFloor));
}

TEST_F(Relaxing, what_starts_pressed_is_parted_by_default_and_told_once_with_the_distance) {
  const PackedScene packed = pack(head("margin = \"1 mm\"") + ball(0, 0, 0.0502) + ball(1, 0, 0.0511) + kFloor);
  EXPECT_NEAR(packed.scene.bodies.position[0].z, 0.052, 1e-10);
  EXPECT_NEAR(packed.scene.bodies.position[1].z, 0.052, 1e-10);
  const std::string notes = told(packed);
  EXPECT_EQ(std::count(notes.begin(), notes.end(), '\n'), 1) << notes;
  EXPECT_NE(told(packed).find("2 bodies separated in 1 sweeps, by up to 1.8 mm"), std::string::npos) << told(packed);
  // k d^2 / 2, and the speed of 1.31 kg
  EXPECT_NE(told(packed).find("stores 1.62 J, a speed of 1.573 m/s"), std::string::npos) << told(packed);
  // what is not pressed stays bit for bit, and nothing is told
  const PackedScene apart = pack(head("margin = \"1 mm\"") + ball(0, 0, 0.0521) + kFloor);
  EXPECT_EQ(apart.scene.bodies.position[0], (Vec3{0, 0, 0.0521}));
  EXPECT_EQ(told(apart), "");
}

TEST_F(Relaxing, what_would_have_to_go_further_than_two_margins_is_refused_with_energy_and_speed) {
  const std::string margin = "margin = \"1 mm\"\n";
  // the outer two of three in a row go 1.9 mm each; of four they would go 2.85 mm
  const std::string three = ball(0, 0, 0) + ball(0.1001, 0, 0) + ball(0.2002, 0, 0);
  EXPECT_GE(smallest_gap(pack(head(margin) + three).scene.bodies.position, 0.05), 0.002 * (1 - 1e-12));
  const std::string four = three + ball(0.3003, 0, 0);
  const std::string message = failure(head(margin) + four);
  EXPECT_NE(message.find("starts 1.9 mm within the margins"), std::string::npos) << message;
  EXPECT_NE(message.find("stores 1.81 J, a speed of"), std::string::npos) << message;
  EXPECT_NE(message.find("contact.relax = true"), std::string::npos) << message;
  EXPECT_GE(smallest_gap(pack(head(margin + "relax = true") + four).scene.bodies.position, 0.05), 0.002 * (1 - 1e-12));
  // an overlap by 1 mm of spheres without margins
  const std::string overlap = failure(head("") + ball(0, 0, 0.049) + kFloor);
  EXPECT_NE(overlap.find("overlaps"), std::string::npos) << overlap;
  EXPECT_NE(overlap.find("stores 0.5 J, a speed of 874 mm/s"), std::string::npos) << overlap;
}

TEST_F(Relaxing, relax_false_starts_what_is_pressed_as_it_is_given) {
  const PackedScene packed = pack(head("margin = \"1 mm\"\nrelax = false") + ball(0, 0, 0.0502) + kFloor);
  EXPECT_EQ(packed.scene.bodies.position[0], (Vec3{0, 0, 0.0502}));
  EXPECT_NE(told(packed).find("starts in contact with wall"), std::string::npos) << told(packed);
  EXPECT_NE(failure(head("relax = false") + ball(0, 0, 0.049) + kFloor).find("overlaps"), std::string::npos);
}

TEST_F(Relaxing, spheres_that_touch_as_far_as_numbers_go_are_not_refused) {
  EXPECT_NO_THROW(pack(head("") + ball(0, 0, 0.05) + ball(0.1, 0, 0.05) + ball(0.05, 0.1 * std::sqrt(0.75), 0.05) + kFloor));
}

TEST_F(Relaxing, other_values_of_relax_are_refused_with_what_there_is) {
  EXPECT_NE(failure(head("relax = \"deep\"") + ball(0, 0, 1)).find("shallow"), std::string::npos);
  EXPECT_NE(failure(head("relax = 1") + ball(0, 0, 1)).find("shallow"), std::string::npos);
  EXPECT_NO_THROW(pack(head("relax = \"shallow\"") + ball(0, 0, 1)));
}

// Places are rounded by their coordinates, not by the gap asked for: a pair is parted at every height or at none.
TEST_F(Relaxing, a_pair_is_parted_wherever_it_lies) {
  for (const double z : {0.1, 1.0, 3.3, 17.0, 28.7, 28.8, 28.9, 29.0, 29.1, 333.3, 1e4, 1.7e5, 1e6}) {
    const std::string pair = ball(0, 0, z) + ball(0, 0, z + 0.09);
    EXPECT_NO_THROW(pack(head("margin = 0\nrelax = true") + pair)) << z;
    EXPECT_NO_THROW(pack(head("margin = \"1 um\"\nrelax = true") + pair + body("cube", 1, 0, z) + body("cube", 1.05, 0.01, z + 0.08))) << z;
  }
}

TEST_F(Relaxing, bodies_are_parted_over_a_periodic_seam_and_stay_in_the_domain) {
  const std::string domain = "[domain]\nmin = [0, 0, 0]\nmax = [1, 1, 1]\nperiodic = [\"x\"]\n";
  const PackedScene packed = pack(head("margin = \"1 mm\"\nrelax = true") + domain + ball(0.001, 0.5, 0.5) + ball(0.95, 0.5, 0.5) +
                                  ball(0.9999, 0.53, 0.5) + ball(0.08, 0.5, 0.5));
  for (const Vec3& p : packed.scene.bodies.position) {
    EXPECT_GE(p.x, 0);
    EXPECT_LE(p.x, 1);
  }
  EXPECT_GE(smallest_gap(packed.scene.bodies.position, 0.05, 1), 0.002 * (1 - 1e-12));
}

TEST_F(Relaxing, what_is_pressed_into_a_corner_or_lies_outside_a_container_is_brought_in) {
  const std::string contact = head("margin = \"1 mm\"\nrelax = true");
  for (const std::string shape : {"ball", "cube"}) {
    const PackedScene corner = pack(contact + body(shape, 0.04, 0.03, 0.02) + box(1, 1));
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(corner.scene.bodies.position[0][k], 0.052, 1e-10) << shape;
    const std::string drum =
        "[[walls]]\nshape = { cylinder_inside = { start = [0, 0, 0], end = [0, 0, 1], radius = 0.5 } }\nmaterial = \"m\"\n";
    EXPECT_NO_THROW(pack(contact + body(shape, 0.6, 0.1, 1.2) + drum)) << shape;
    const std::string globe = "[[walls]]\nshape = { sphere_inside = { centre = [0, 0, 0], radius = 0.5 } }\nmaterial = \"m\"\n";
    EXPECT_NO_THROW(pack(contact + body(shape, 0.4, 0.4, 0.3) + globe)) << shape;
    const std::string plate =
        "[[walls]]\nshape = { plate = { corner = [-1, -1, 0], side_a = [2, 0, 0], side_b = [0, 2, 0] } }\nmaterial = \"m\"\n";
    EXPECT_NO_THROW(pack(contact + body(shape, 0.3, 0.2, 0.0513) + body(shape, -0.3, 0.2, -0.02) + plate)) << shape;
  }
}

TEST_F(Relaxing, a_ball_that_touches_several_faces_of_a_mesh_box_is_parted_from_all_of_them) {
  const std::string mesh_box = "[[walls]]\nshape = { box = { corners = [[0, 0, 0], [1, 1, 1]], open = [\"+z\"] } }\nmaterial = \"m\"\n";
  for (const double at : {0.05, 0.0499999999, 0.0495}) {
    for (const bool is_corner : {false, true}) {
      const std::string given = ball(at, is_corner ? 0.95 + (0.05 - at) : 0.5, at);
      const PackedScene packed = build_scene(parse_case(head("") + given + mesh_box, "case.toml", folder_.string()));
      const Vec3 x = packed.scene.bodies.position[0];
      EXPECT_NEAR(x.x, 0.05, 1e-9) << given;
      EXPECT_NEAR(x.y, is_corner ? 0.95 : 0.5, 1e-9) << given;
      EXPECT_NEAR(x.z, 0.05, 1e-9) << given;
    }
  }
}

/// A bed of balls that rest on each other in staggered layers of n x n, each a hair too close to six others.
std::string bed(int n, int layers, double radius) {
  std::string text;
  const double pitch = 2 * radius * 0.999, rise = pitch * std::sqrt(0.5);
  for (int k = 0; k < layers; ++k) {
    for (int j = 0; j < n; ++j) {
      for (int i = 0; i < n; ++i)
        text += ball(radius + pitch * (i + 0.5 * (k % 2)), radius + pitch * (j + 0.5 * (k % 2)), radius + rise * k);
    }
  }
  return text + box(pitch * (n - 0.5) + 2.2 * radius, 1e3);
}

TEST_F(Relaxing, a_bed_of_balls_that_rest_on_each_other_is_relaxed) {
  const PackedScene packed = pack(head("margin = \"0.2 mm\"\nrelax = true") + bed(8, 12, 0.05));
  EXPECT_GE(smallest_gap(packed.scene.bodies.position, 0.05), 0.0004 * (1 - 1e-12));
  EXPECT_EQ(told(packed).find("starts in contact"), std::string::npos);
  // the same case gives the same bits
  EXPECT_EQ(pack(head("margin = \"0.2 mm\"\nrelax = true") + bed(8, 12, 0.05)).scene.bodies.position, packed.scene.bodies.position);
}

// A block 10 cm wide that a ball of 10 cm falls on: v = 3 m/s, m = 1.309 kg, k = 1e7 N/m; the ball has no margin beside the block's.
TEST_F(Relaxing, fixed_meshes_that_balls_alone_meet_have_the_margin_that_the_blow_needs) {
  const auto packed = [&](const std::string& contact) {
    return build_scene(parse_case(head("impact_speed = 3\n" + contact, 1e7) + body("cube", 0, 0, 0, "fixed = true") + ball(0, 0, 0.5),
                                  "case.toml", folder_.string()));
  };
  const double depth = 3 * std::sqrt(2500 * std::numbers::pi / 6 * 1e-3 / 1e7), radius = 0.1 * std::cbrt(3 / (4 * std::numbers::pi));
  const PackedScene derived = packed("");
  EXPECT_NEAR(derived.scene.settings.margin_ratio, depth / 0.4 / radius, 1e-6);
  EXPECT_NEAR(derived.report.overlap_share, 0.4, 1e-9);
  const PackedScene given = packed("margin = 0.004");
  EXPECT_NEAR(given.scene.settings.margin_ratio, 0.004 / radius, 1e-12);
  EXPECT_NEAR(given.report.overlap_share, depth / 0.004, 1e-9);
  EXPECT_EQ(packed("margin_ratio = 0.1").scene.settings.margin_ratio, 0.1);
}

// Cards, drawn in touch: with margins of 2 % of their radius, more than half of their thickness, each would be thicker than it is drawn.
TEST_F(Relaxing, cards_in_a_stack_start_as_they_are_drawn_or_the_message_names_the_margin) {
  constexpr double kThick = 2e-4;
  write_shape_file((folder_ / "card.shape.h5").string(), {make_solid("card", box_mesh({0.063, 0.088, kThick}))}, {{"tool", "test"}});
  const auto packed = [&](const std::string& contact, double stiffness = 1e5) {
    std::string text = head(contact, stiffness) + kFloor + "[shapes.card]\nfile = \"card.shape.h5\"\n";
    for (int i = 0; i < 10; ++i) text += body("card", 0, 0, (i + 0.5) * kThick);
    return build_scene(parse_case(text, "case.toml", folder_.string()));
  };
  const double radius = std::cbrt(3 * 0.063 * 0.088 * kThick / (4 * std::numbers::pi));
  const double half = 0.063 * 0.088 * kThick / (2 * (0.063 * 0.088 + (0.063 + 0.088) * kThick));  // volume over area

  const auto about_card = [](const PackedScene& scene) {
    for (const std::string& notice : scene.report.notices)
      if (notice.find("'card'") != std::string::npos) return notice;
    return std::string("none");
  };

  const PackedScene as_drawn = packed("impact_speed = 0.1");
  EXPECT_NEAR(as_drawn.scene.settings.margin_ratio, 0.8 * half / radius, 1e-12);
  for (int i = 0; i < 10; ++i)
    EXPECT_NEAR(as_drawn.scene.bodies.position[static_cast<std::size_t>(i)].z, (i + 0.5) * kThick, 1e-8) << "moved further than rounding";
  EXPECT_LT(as_drawn.report.roundings.at(0).mean, 0.05 * as_drawn.report.roundings.at(0).margin);
  EXPECT_NE(about_card(as_drawn).find("'card' is thinner than two margins of 2 % of its radius: contact.margin_ratio = 0.01"),
            std::string::npos)
      << about_card(as_drawn);

  // a margin that is given, or that a fast impact asks for: the messages name a margin and a stiffness, which help
  const auto refused = [&](const std::string& contact) {
    try {
      packed(contact);
    } catch (const InputError& e) {
      return std::string(e.what());
    }
    return std::string("not refused");
  };
  const std::string given = refused("margin_ratio = 0.02");
  const std::size_t at = given.find("contact.margin_ratio = ");
  ASSERT_NE(at, std::string::npos) << given;
  EXPECT_EQ(packed("margin_ratio = " + given.substr(at + 23, 5)).scene.bodies.size(), 10u);
  EXPECT_NE(refused("impact_speed = 2").find("contact.margin_ratio = "), std::string::npos);
  const PackedScene fast = packed("impact_speed = 2\nrelax = true");
  const std::string cure = about_card(fast), key = "pairs.stiffness = \"";
  ASSERT_NE(cure.find(key), std::string::npos) << cure;
  const double stiffness = parse_quantity(cure.substr(cure.find(key) + key.size(), cure.find("\" would") - cure.find(key) - key.size()),
                                          Dimension::stiffness, "cure");
  const PackedScene stiff = packed("impact_speed = 2", stiffness);
  EXPECT_NEAR(stiff.scene.bodies.position[9].z, 9.5 * kThick, 1e-8);
  EXPECT_LT(stiff.report.roundings.at(0).mean, 0.05 * stiff.report.roundings.at(0).margin);
}

// A specimen between platens: it touches both and is pressed by neither. There is no room to part them, and none is needed.
TEST_F(Relaxing, what_fits_exactly_between_two_walls_starts_as_it_is) {
  const auto lid = [](double z) {
    return fmt::format("[[walls]]\nshape = {{ plane = {{ point = [0, 0, {}], normal = [0, 0, -1] }} }}\nmaterial = \"m\"\n", z);
  };
  const auto stack = [](const std::string& shape, int count) {
    std::string bodies;
    for (int i = 0; i < count; ++i) bodies += body(shape, 0, 0, 0.05 + 0.1 * i);
    return bodies;
  };
  for (const char* relax : {"", "relax = true"}) {
    for (const auto& [shape, count] : {std::pair("ball", 1), {"cube", 3}}) {
      const std::string text = head("impact_speed = 0.1\n" + std::string(relax)) + stack(shape, count) + kFloor;
      const PackedScene packed = build_scene(parse_case(text + lid(0.1 * count), "case.toml", folder_.string()));
      for (int i = 0; i < count; ++i)
        EXPECT_EQ(packed.scene.bodies.position[static_cast<std::size_t>(i)], (Vec3{0, 0, 0.05 + 0.1 * i})) << shape << " " << relax;
      try {  // a little less room is refused
        build_scene(parse_case(text + lid(0.1 * count - 1e-5), "case.toml", folder_.string()));
        ADD_FAILURE() << shape << " " << count;
      } catch (const InputError& e) {
        EXPECT_NE(std::string(e.what()).find("This remains after"), std::string::npos) << e.what();
      }
    }
  }
}

}  // namespace
}  // namespace scree
