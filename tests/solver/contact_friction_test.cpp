// docs/reference/contact-law.md section 5, test 8: sliding without ripple, no creep, torsion, and rest on a bumpy bed.
#include <gtest/gtest.h>

#include "solver/contact/pair_friction.hpp"
#include "tests/solver/contact_cases.hpp"

namespace scree {
namespace {

using test::TwoBodies;

constexpr double kStiff = 1e5;

/// A block of 1 kg, 1 x 1 x 0.4 m, at rest on a fixed floor; meshes refined independently.
struct BlockOnFloor {
  TwoBodies pair;
  double dt;
  BlockOnFloor(int refine_block, int refine_floor, double steps_per_contact, double turn)
      : pair(test::grid_box(refine_block, {1, 1, .4}), test::grid_box(refine_floor, {4, 4, 1}), kStiff, test::kMargin, .3, .5),
        dt(std::numbers::pi / std::sqrt(kStiff) / steps_per_contact) {
    pair.set_mass(0, 1);
    pair.fix(1);
    pair.place(1, {});
    pair.place(0, {-.4, .1, .5 + .2 + test::kMargin - .0001}, quaternion_of({0, 0, 1}, turn));
    pair.gravity = {0, 0, -9.81};
    pair.force(0);
  }
  void run(double time) {
    for (double t = 0; t < time; t += dt) pair.step(dt);
  }
};

TEST(ContactFriction, a_sliding_block_feels_mu_n_without_ripple_however_block_and_floor_are_meshed) {
  for (const int block : {1, 8}) {
    for (const int floor : {1, 5}) {
      BlockOnFloor scene(block, floor, 30, .2);
      scene.run(2);
      TwoBodies& pair = scene.pair;
      pair.v[0].x = 1;
      const double start = pair.body[0].x.x;
      double low = 2, high = 0;
      for (int n = 0; n < 1500; ++n) {
        pair.step(scene.dt);
        if (n <= 100 || pair.v[0].x < .05) continue;
        const Vec3 f = pair.force_on_a();
        const double ratio = std::hypot(f.x, f.y) / (.5 * f.z);
        low = std::min(low, ratio);
        high = std::max(high, ratio);
      }
      EXPECT_NEAR(low, 1, 1e-5) << block << " on " << floor;
      EXPECT_NEAR(high, 1, 1e-5) << block << " on " << floor;
      EXPECT_NEAR(pair.body[0].x.x - start, 1 / (2 * .5 * 9.81), 1e-3 * .102) << block << " on " << floor;  // v^2 / 2 mu g
      RecordProperty("ratio_" + std::to_string(block) + "_" + std::to_string(floor), std::to_string(high - low));
      std::printf("block %d on floor %d: F_t / mu N - 1 from %.1e to %.1e, slides %.5f m\n", block, floor, low - 1, high - 1,
                  pair.body[0].x.x - start);
    }
  }
}

// Which of two bodies is A changes rounding only, with friction as without. Springs that went with A and were turned by half of the
// relative spin gave 6e-9, by the step.
TEST(ContactFriction, does_not_know_which_body_comes_first) {
  const auto impact = [](bool swapped, std::int64_t& touched) {
    const TriangleMesh one = test::scaled(test::rock(1, 1), .5), two = test::scaled(test::rock(2, 1), .5);
    TwoBodies pair(swapped ? two : one, swapped ? one : two, kStiff, test::kMargin, .7, .5);
    const int a = swapped ? 1 : 0, b = 1 - a;
    for (const int i : {0, 1}) pair.set_mass(i, i == a ? 1 : 2);
    pair.body[a].x = {.1, .05, 1.3};
    pair.body[a].q = normalised(Quat{.9, .2, .3, -.1});
    pair.v[a] = {.4, -.2, -2};
    pair.v[b] = {};
    pair.L[a] = {.2, -.3, .1};
    pair.L[b] = {-.2, .3, .4};
    pair.force(0);
    const double dt = std::numbers::pi / std::sqrt(kStiff) / 30;
    touched = 0;
    for (double t = 0; t < .6; t += dt) {
      pair.step(dt);
      touched += pair.features.empty() ? 0 : 1;
    }
    return std::array{pair.body[a].x, pair.v[a], pair.v[b], pair.L[a], pair.L[b]};
  };
  std::int64_t touched = 0;
  const auto straight = impact(false, touched), swapped = impact(true, touched);
  EXPECT_GT(touched, 10);
  for (std::size_t k = 0; k < straight.size(); ++k) EXPECT_LE(length(straight[k] - swapped[k]), 1e-11) << k;
}

TEST(ContactFriction, a_block_on_a_slope_below_the_friction_angle_does_not_creep) {
  BlockOnFloor scene(1, 1, 20, .4);
  scene.pair.gravity = {.35 * 9.81, 0, -9.81};  // 70 % of the friction angle
  scene.run(5);
  const double start = scene.pair.body[0].x.x;
  scene.run(15);
  std::printf("creep in 15 s: %.1e m\n", scene.pair.body[0].x.x - start);
  EXPECT_LE(std::abs(scene.pair.body[0].x.x - start), 1e-9);
  EXPECT_GE(start, -.4);
}

// Closed forms: g (sin - mu cos) down a slope of 0.5, below the angle of static friction, and -mu g on the level, with the mu of sliding.
TEST(ContactFriction, sliding_friction_below_static_friction_is_the_same_at_every_step) {
  const double sine = std::sqrt(.2), cosine = 2 * sine;
  for (const double steps_per_contact : {8., 12., 30., 120., 480.}) {
    for (const bool slope : {true, false}) {
      BlockOnFloor scene(1, 1, steps_per_contact, 0);
      scene.pair.friction_sliding = .25;
      scene.run(1);
      if (slope) scene.pair.gravity = {9.81 * sine, 0, -9.81 * cosine};
      scene.pair.v[0].x += slope ? .1 : 1;
      scene.run(.1);
      const double from = scene.pair.v[0].x;
      const int steps = static_cast<int>(.1 / scene.dt);
      for (int n = 0; n < steps; ++n) scene.pair.step(scene.dt);
      const double expected = slope ? 9.81 * (sine - .25 * cosine) : -.25 * 9.81;
      const double measured = (scene.pair.v[0].x - from) / (steps * scene.dt);
      EXPECT_NEAR(measured, expected, .01 * std::abs(expected)) << steps_per_contact << (slope ? " slope" : " level");
    }
  }
}

// A rising load does not give the static limit back to what slides.
TEST(ContactFriction, a_spring_keeps_the_sliding_limit_until_it_sticks_again) {
  const PairFeatures none;
  PairLaw law;
  law.friction = .6;
  law.friction_sliding = .3;
  const PairMotion motion{};
  ContactFeature f{};
  f.key = 7;
  f.n = {0, 0, 1};
  f.overlap = 1e-3;
  f.weight = 1;
  std::vector<FrictionSpring> springs, next;
  double elastic = 0;
  const auto friction = [&](const Vec3& vt, double push) {
    const MeanTurn turned(springs, {}, 1e-3);
    next.clear();
    const Vec3 force =
        PairFriction(none, nullptr, law, motion, 1e-3, springs, turned, next).force(f, vt, 0, push, 1e4, 0, elastic, nullptr);
    springs = next;
    return force.x;
  };
  EXPECT_DOUBLE_EQ(friction({.05, 0, 0}, 1), -.5);  // holds
  EXPECT_FALSE(springs[0].stiffness < 0);
  EXPECT_DOUBLE_EQ(friction({.05, 0, 0}, 1), -.3);  // slides
  EXPECT_TRUE(springs[0].stiffness < 0);
  EXPECT_DOUBLE_EQ(friction({.05, 0, 0}, 1.2), -.36);  // under a larger load
  EXPECT_DOUBLE_EQ(friction({.005, 0, 0}, 2), -.41);   // not at its limit, but it has not turned round
  EXPECT_TRUE(springs[0].stiffness < 0);
  EXPECT_DOUBLE_EQ(friction({.05, 0, 0}, 2), -.6);
  EXPECT_NEAR(friction({-.01, 0, 0}, 2), -.5, 1e-12);  // back: it sticks
  EXPECT_FALSE(springs[0].stiffness < 0);
  EXPECT_DOUBLE_EQ(friction({.06, 0, 0}, 2), -1.1);  // and holds up to the static limit
  EXPECT_DOUBLE_EQ(springs[0].normal.z, 1);
}

TEST(ContactFriction, a_spring_goes_with_its_normal_at_its_length_and_amplifies_no_rounding) {
  std::mt19937 g(3);
  std::normal_distribution<double> number;
  const auto random = [&] { return Vec3{number(g), number(g), number(g)}; };
  for (int n = 0; n < 1000; ++n) {
    const auto unit = [&] {
      const Vec3 v = random();
      return (1 / length(v)) * v;
    };
    const Vec3 from = unit(), to = unit(), s = cross(from, random());
    const Vec3 t = transported(s, from, to);
    EXPECT_NEAR(length(t), length(s), 1e-9 * length(s));
    EXPECT_LE(std::abs(dot(t, to)), 1e-9 * length(s));
    EXPECT_LE(length(transported(t, to, from) - s), 1e-9 * length(s)) << "there and back";
  }
  // a spring along the new normal, but for rounding: it was stretched to its length, and so pointed anywhere
  const Vec3 t = transported({1, 0, 1e-17}, {0, 0, 1}, {1, 0, 0});
  EXPECT_LE(length(t - Vec3{0, 0, -1}), 1e-15);
  EXPECT_EQ(transported({1, 0, 0}, {0, 0, 1}, {0, 0, -1}), Vec3{});
  EXPECT_EQ(transported({1, 2, 3}, {}, {0, 0, 1}), (Vec3{1, 2, 0})) << "of an older checkpoint";
}

/// Features and springs with the normals (sin a, 0, cos a).
ContactFeature feature(std::int64_t key, double angle) {
  ContactFeature f{};
  f.key = key;
  f.n = {std::sin(angle), 0, std::cos(angle)};
  f.overlap = f.weight = 1;
  return f;
}
FrictionSpring spring(std::int64_t key, double angle) { return {key, {0, 1, 0}, 1, {std::sin(angle), 0, std::cos(angle)}}; }

std::vector<std::array<std::int64_t, 2>> handed_over(const std::vector<ContactFeature>& features,
                                                     const std::vector<FrictionSpring>& springs) {
  std::vector<std::array<std::int64_t, 2>> pairs;
  for (const HandedOver& h : find_handed_over(features, nullptr, springs, MeanTurn({}, {}, 1))) pairs.push_back({h.spring->key, h.feature});
  return pairs;
}

TEST(ContactFriction, a_spring_is_handed_over_to_the_feature_of_its_corner_whose_normal_is_nearest) {
  using Pairs = std::vector<std::array<std::int64_t, 2>>;
  const auto corner = [](std::int64_t i, std::int64_t foot) { return make_key(kCornerOfB, i, foot); };
  // equal keys first, then the nearest normals, then the next
  EXPECT_EQ(handed_over({feature(corner(4, 1), 0), feature(corner(4, 5), .3), feature(corner(4, 6), .1)},
                        {spring(corner(4, 1), .1), spring(corner(4, 2), .12), spring(corner(4, 3), 0)}),
            (Pairs{{corner(4, 2), corner(4, 6)}, {corner(4, 3), corner(4, 5)}}));
  EXPECT_EQ(handed_over({feature(corner(4, 5), .1)}, {spring(corner(3, 1), .1), spring(corner(5, 1), .1)}), Pairs{}) << "another corner";
  EXPECT_EQ(handed_over({feature(corner(4, 5), 0)}, {spring(corner(4, 1), 1.1)}), Pairs{}) << "too far round";
  EXPECT_EQ(handed_over({feature(make_key(kEdgeEdge, 4, 5), 0)}, {spring(make_key(kEdgeEdge, 4, 1), 0)}), Pairs{});
  EXPECT_EQ(handed_over({feature(corner(4, 5), 0), feature(corner(4, 6), 0)}, {spring(corner(4, 7), 0)}),
            (Pairs{{corner(4, 7), corner(4, 5)}}))
      << "the first of equals";
  // a ball on a mesh: from a region to an edge to a corner; one spring each
  const std::int64_t edge = 1 << 28 | 17, vertex = 2 << 28 | 3, old_edge = std::int64_t{1} << 58 | 17;
  EXPECT_EQ(handed_over({feature(edge, .1)}, {spring(12, 0)}), (Pairs{{12, edge}}));
  EXPECT_EQ(handed_over({feature(vertex, .1)}, {spring(edge, 0)}), (Pairs{{edge, vertex}}));
  EXPECT_EQ(handed_over({feature(edge, .1)}, {spring(old_edge, 0)}), (Pairs{{old_edge, edge}})) << "of an older checkpoint";
  // of an older checkpoint, without a normal
  FrictionSpring old = spring(corner(4, 0), 0);
  old.normal = {};
  EXPECT_EQ(handed_over({feature(corner(4, 5), 1.5)}, {old}), (Pairs{{corner(4, 0), corner(4, 5)}}));
}

// Four corners at r carry a quarter of the weight each: torque mu m g r until the spin ends at t = w I / (mu m g r).
TEST(ContactFriction, a_spinning_flat_body_stops_when_its_corners_say_so) {
  BlockOnFloor scene(4, 3, 30, .1);
  scene.run(2);
  TwoBodies& pair = scene.pair;
  const double inertia = 1.0 / 6, torque = .5 * 9.81 * std::sqrt(.5), spin = 10, end = spin * inertia / torque;
  pair.L[0] = {0, 0, spin * inertia};
  scene.run(.5 * end);
  EXPECT_NEAR(pair.spin(0).z, .5 * spin, .005 * spin);
  scene.run(end);
  EXPECT_LE(std::abs(pair.spin(0).z), 1e-3 * spin);
  scene.run(5);
  EXPECT_LE(pair.kinetic_energy(0), 1e-20);
}

TEST(ContactFriction, rocks_on_a_bumpy_bed_are_at_rest_after_40_s) {
  for (const int level : {1, 2}) {
    for (unsigned seed = 0; seed < 6; ++seed) {
      const double energy = test::energy_of_a_rock_on_a_bed(seed, level, 39, 40, 15);
      std::printf("rock %u L%d on the bed: KE %.1e J\n", seed, level, energy);
      EXPECT_GE(energy, 0) << "fell off";
      EXPECT_LE(energy, 1e-15);
    }
  }
}

}  // namespace
}  // namespace scree
