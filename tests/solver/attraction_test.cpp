// Attraction in the pair potential (solver/laws/attraction.hpp): gradient, energy, and the force that parts two bodies on every mesh.
// Closed forms: one feature parts at F_c, n equal ones at F_c n^(1/8); the work from touch is F_c s / 2.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "solver/contact/chosen_law.hpp"
#include "tests/solver/two_bodies.hpp"

namespace scree {
namespace {

using test::TwoBodies, test::kMargin, test::kStiffness, test::place_at_random;

constexpr double kPullOff = 3, kRange = 0.004;  // [N, m]

/// Of energy against force and torque, over the poses of rocks at a largest overlap; beyond touch where it is below 0.
struct GradientCheck {
  double worst = 0;
  int tested = 0, faded = 0, beyond = 0;
};

GradientCheck check_gradients(double pressed, bool bridge = false) {
  GradientCheck check;
  std::mt19937 g(3);
  for (int s = 0; s < 60; ++s) {
    TwoBodies pair(test::scaled(test::rock(1, 2), 0.5), test::scaled(test::rock(2, 1), 0.5), kStiffness, 0.06, 1, 0, kPullOff, 0.03);
    if (bridge) pair.make_bridge();
    place_at_random(pair, g);
    if (!pair.approach(1.8)) continue;
    const auto deepest = [&] {
      double overlap = -1;
      for (const ContactFeature& f : pair.features) overlap = std::max(overlap, f.overlap);
      return overlap;
    };
    while (pair.force(0), deepest() < pressed) pair.body[0].x.z -= 0.0005;
    if (pair.features.size() < 2) continue;
    for (const ContactFeature& f : pair.features) {
      check.faded += f.faded ? 1 : 0;
      check.beyond += f.overlap < 0 ? 1 : 0;
    }
    const PairForce at = pair.force(0);
    Vec3 of_contacts;
    for (const ContactOutput& c : pair.outputs) of_contacts += c.normal_force * c.normal + c.tangential_force;
    EXPECT_LE(length(of_contacts - at.force), 1e-12 * kPullOff) << "frames hold what acts";
    const Vec3 force = rotate(pair.body[0].q, at.force), torque = rotate(pair.body[0].q, at.torque);
    const PairBody home = pair.body[0];
    constexpr double kStep = 1e-7;
    double worst = 0, largest = kPullOff;  // at rest push and pull nearly cancel
    for (int c = 0; c < 6; ++c) {
      double u[2];
      for (int side = 0; side < 2; ++side) {
        const double e = side == 1 ? kStep : -kStep;
        if (c < 3)
          pair.body[0].x[c] += e;
        else {
          Vec3 axis;
          axis[c - 3] = 1;
          pair.body[0].q = normalised(quaternion_of(axis, e) * home.q);
        }
        u[side] = pair.force(0).elastic;
        pair.body[0] = home;
      }
      const double exact = c < 3 ? force[c] : torque[c - 3];
      worst = std::max(worst, std::abs(exact + (u[1] - u[0]) / (2 * kStep)));
      largest = std::max(largest, std::abs(exact));
    }
    check.worst = std::max(check.worst, worst / largest);
    ++check.tested;
  }
  return check;
}

TEST(Attraction, force_and_torque_are_the_gradient_of_the_energy_in_contact_and_beyond_it) {
  for (const double pressed : {0.02, -0.01}) {
    const GradientCheck check = check_gradients(pressed);
    EXPECT_LE(check.worst, 1e-7) << pressed;
    EXPECT_GE(check.tested, 40) << pressed;
    EXPECT_GE(check.faded, 10) << "the poses must exercise the fading terms";
    EXPECT_GE(check.beyond, 10) << "the poses must have features beyond touch";
  }
}

// The force of a bridge is that of a potential too, over the same features: however it bends, energy is kept as long as it holds.
TEST(Attraction, of_a_liquid_bridge_is_the_gradient_of_its_energy) {
  for (const double pressed : {0.02, -0.01}) {
    const GradientCheck check = check_gradients(pressed, true);
    EXPECT_LE(check.worst, 1e-7) << pressed;
    EXPECT_GE(check.tested, 40) << pressed;
    EXPECT_GE(check.beyond, 10) << pressed;
  }
}

/// The largest force that holds a body on a floor as it is lifted from where it rests, turned as given, in F_c.
double pull_off(const TriangleMesh& mesh, const Quat& turn, double range = kRange, double* work = nullptr) {
  TwoBodies pair(mesh, test::grid_box(1, {8, 8, 1}), kStiffness, kMargin, 1, 0, kPullOff, range);
  pair.fix(1);
  pair.place(1, {0, 0, -0.5});
  pair.place(0, {}, turn);
  double lowest = 1e300;
  for (const Vec3& v : pair.body[0].shape->mesh.vertices) lowest = std::min(lowest, rotate(pair.body[0].q, v).z);
  double most = 0, from_touch = 0;
  constexpr int kSteps = 400;  // through the range; one of them is at touch, where the force is largest
  const double lift = range / kSteps;
  for (int n = -kSteps / 2; n <= kSteps; ++n) {
    pair.body[0].x.z = -lowest + kMargin + n * lift;
    pair.forget_lists();
    pair.force(0);
    const double force = -pair.force_on_a().z;
    most = std::max(most, force);
    if (n >= 0) from_touch += (n == 0 || n == kSteps ? 0.5 : 1.0) * force * lift;
  }
  if (work != nullptr) *work = from_touch / (0.5 * kPullOff * range);
  return most / kPullOff;
}

const Quat kEdgeDown = quaternion_of({1, 0, 0}, std::numbers::pi / 4);
/// A cube on its corner: the diagonal down.
const Quat kCornerDown = quaternion_of(normalised(Vec3{1, -1, 0}), std::acos(1 / std::sqrt(3.0)));

TEST(Attraction, a_cube_parts_at_the_force_of_its_equal_features) {
  const TriangleMesh cube = test::grid_box(1, {1, 1, 1});
  double work = 0;
  constexpr double kRounding = 1e-7;  // of gaps, over the range
  EXPECT_NEAR(pull_off(cube, kCornerDown, kRange, &work), 1, kRounding);
  EXPECT_NEAR(work, 1, kRounding) << "the force goes with the way left in the range: the rule of trapezoids is exact";
  EXPECT_NEAR(pull_off(cube, kEdgeDown), std::pow(2.0, 0.125), kRounding);
  EXPECT_NEAR(pull_off(cube, Quat{}), std::pow(4.0, 0.125), kRounding);
}

TEST(Attraction, a_flat_refinement_changes_no_pull_off) {
  for (const Quat& turn : {Quat{}, kEdgeDown, kCornerDown}) {
    const double coarse = pull_off(test::grid_box(1, {1, 1, 1}), turn);
    for (const int n : {2, 4, 8}) EXPECT_NEAR(pull_off(test::grid_box(n, {1, 1, 1}), turn), coarse, 1e-9) << n;
  }
  const Quat turn = quaternion_of(normalised(Vec3{1, 2, 3}), 1);
  EXPECT_NEAR(pull_off(test::scaled(test::rock(1, 2, 0.22, 1), 0.5), turn), pull_off(test::scaled(test::rock(1, 2), 0.5), turn), 1e-9);
}

/// The force at touch in F_c: of a smooth body, its pull-off force.
double pull_at_touch(TwoBodies& pair, const Quat& turn) {
  pair.place(0, {}, turn);
  double lowest = 1e300;
  for (const Vec3& v : pair.body[0].shape->mesh.vertices) lowest = std::min(lowest, rotate(pair.body[0].q, v).z);
  pair.body[0].x.z = -lowest + kMargin;
  pair.forget_lists();
  pair.force(0);
  return -pair.force_on_a().z / kPullOff;
}

// As ever more vertices come within the range, they count as one. With weights of 1 an icosphere of level 6 would have 1.36 F_c at a range
// of a tenth of a margin, 1.81 at one of a margin.
TEST(Attraction, an_icosphere_of_any_level_parts_at_the_force_of_a_ball) {
  for (const double range : {0.1 * 0.5 * kMargin, 0.5 * kMargin}) {
    for (int level = 0; level <= 6; ++level) {
      TwoBodies pair(test::scaled(test::icosphere(level), 0.5), test::grid_box(1, {8, 8, 1}), kStiffness, kMargin, 1, 0, kPullOff, range);
      pair.fix(1);
      pair.place(1, {0, 0, -0.5});
      std::mt19937 g(1);
      double mean = 0;
      constexpr int kTurns = 6;
      for (int n = 0; n < kTurns; ++n) mean += pull_at_touch(pair, test::random_quaternion(g)) / kTurns;
      RecordProperty("range_" + std::to_string(range) + "_level_" + std::to_string(level), std::to_string(mean));
      EXPECT_GE(mean, 0.99) << "level " << level << " range " << range;
      EXPECT_LE(mean, 1.12) << "level " << level << " range " << range;
      if (level == 6) {
        EXPECT_NEAR(mean, 1, 0.02) << "range " << range;
      }
    }
  }
}

TEST(Attraction, elastic_sticky_impacts_keep_their_energy_better_with_a_smaller_step) {
  double before = 0;
  for (const double steps : {100.0, 800.0}) {
    std::mt19937 g(11);
    test::Statistics s;
    for (int i = 0; i < 30; ++i) {
      TwoBodies pair(test::scaled(test::rock(1, 2), 0.5), test::scaled(test::rock(2, 2), 0.5), kStiffness, kMargin, 1, 0, kPullOff, kRange);
      place_at_random(pair, g);
      if (!pair.approach(1.8)) continue;
      while (!pair.features.empty()) {
        pair.body[0].x.z += 0.5 * kRange;
        pair.force(0);
      }
      const double energy = pair.kinetic_energy(0) + pair.kinetic_energy(1);
      const double dt = std::numbers::pi * std::sqrt(0.5 / kStiffness) / steps;
      bool touched = false;
      int quiet = 0;
      for (int n = 0; n < 16 * steps && quiet < steps; ++n) {
        pair.step(dt);
        touched = touched || pair.last().largest_overlap > 0;
        quiet = pair.features.empty() && touched ? quiet + 1 : 0;
      }
      if (touched && pair.features.empty()) s.add(std::abs(pair.energy() / energy - 1));
    }
    RecordProperty("mean_" + std::to_string(static_cast<int>(steps)), std::to_string(s.mean));
    EXPECT_GE(s.hits, 20);
    if (before > 0) {
      // first order at nearest-point switches, second order elsewhere: 8 times finer is at least 4 times better
      EXPECT_LE(s.mean, 0.25 * before);
    } else {
      EXPECT_LE(s.mean, 3e-3);
    }
    before = s.mean;
  }
}

TEST(Attraction, damping_and_friction_go_with_the_push_alone) {
  // a cube's corner that hangs in the range beyond touch and slides: nothing is lost; and one that is pressed has mu times its push
  TwoBodies pair(test::grid_box(1, {1, 1, 1}), test::grid_box(1, {8, 8, 1}), kStiffness, kMargin, 0.5, 0.5, kPullOff, kRange);
  pair.fix(1);
  pair.place(1, {0, 0, -0.5});
  pair.place(0, {}, kCornerDown);
  const double touch = std::sqrt(0.75) + kMargin;
  pair.v[0] = {1, 0, 0.3};
  pair.body[0].x.z = touch + 0.5 * kRange;
  const PairForce hanging = pair.force(1e-5);
  EXPECT_EQ(length(hanging.dissipative_force), 0);
  EXPECT_NEAR(pair.force_on_a().z, -0.5 * kPullOff, 1e-9 * kPullOff);
  EXPECT_NEAR(hanging.elastic, -0.125 * kPullOff * kRange, 1e-9 * kPullOff * kRange);
  const double overlap = 1e-4;
  pair.v[0] = {1, 0, 0};
  pair.body[0].x.z = touch - overlap;
  for (int n = 0; n < 3; ++n) pair.force(1e-3);
  EXPECT_NEAR(pair.force_on_a().z, kStiffness * overlap - kPullOff, 1e-9 * kPullOff);
  EXPECT_NEAR(-pair.force_on_a().x, 0.5 * kStiffness * overlap, 1e-9 * kPullOff) << "mu (N + F_c), with N the net force";
}

TEST(Attraction, a_scene_without_it_has_the_function_that_it_had) {
  Scene plain = test::empty_scene(1e4, 0.5, 0.5, 0.01), sticky = plain;
  sticky.pairs[0].pull_off = 1;
  sticky.pairs[0].adhesion_range = 1e-3;
  const SolverScene without(plain), with(sticky);
  EXPECT_EQ(without.contact_range(), without.margin());
  EXPECT_NEAR(with.contact_range(), with.margin() + 0.5e-3, 1e-18);
  EXPECT_NE(pair_force_function(without.law_choice()), pair_force_function(with.law_choice()));
}

}  // namespace
}  // namespace scree
