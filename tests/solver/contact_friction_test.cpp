// docs/reference/contact-law.md section 5, test 8: sliding without ripple, no creep, torsion, and rest on a bumpy bed.
#include <gtest/gtest.h>

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
