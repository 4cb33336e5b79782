// The pair potential on pairs of concave rocks: gradient, energy, mesh independence. docs/reference/contact-law.md section 5.
#include <gtest/gtest.h>

#include <algorithm>

#include "solver/laws/restitution.hpp"
#include "tests/solver/two_bodies.hpp"

namespace scree {
namespace {

using test::TwoBodies, test::kMargin, test::kStiffness, test::place_at_random, test::elastic_impacts;

/// in   finer   refinements of the rocks, whose vertices then lie in clusters
/// in   roughness   of the rocks: dents of .4 hold vertices that touch several faces
void expect_exact_gradient(double cell_size, CellSide cells = CellSide::b, double barrier = 0, int finer = 0, double roughness = .22) {
  std::mt19937 g(3);
  int tested = 0, faded = 0, shared = 0;
  const int poses = roughness > .3 && finer == 0 && cell_size == 0 && barrier == 0 ? 500 : 60;
  for (int s = 0; s < poses; ++s) {
    TwoBodies pair(test::scaled(test::rock(1, 2 + finer, roughness), 0.5), test::scaled(test::rock(2, 1 + finer, roughness), 0.5),
                   kStiffness, 0.06, 1, 0);
    pair.cell_size = cell_size;
    pair.cells = cells;
    pair.barrier = barrier;
    place_at_random(pair, g);
    if (!pair.approach(1.8)) continue;
    const double pressed = barrier > 0 ? 0.053 : 0.02;  // of margins of 0.06
    while (pair.force(0).largest_overlap < pressed) pair.body[0].x.z -= 0.0005;
    if (pair.features.size() < 2) continue;
    for (const ContactFeature& f : pair.features) {
      faded += f.faded ? 1 : 0;
      shared += f.faded && indices_of_key(f.key).kind != kEdgeEdge ? 1 : 0;
    }
    const PairForce at = pair.force(0);
    // what frames hold of the contacts adds up to the force, fading and cells included
    Vec3 of_contacts;
    for (const ContactOutput& c : pair.outputs) of_contacts += c.normal_force * c.normal + c.tangential_force;
    EXPECT_LE(length(of_contacts - at.force), 1e-12 * length(at.force));
    const Vec3 force = rotate(pair.body[0].q, at.force), torque = rotate(pair.body[0].q, at.torque);
    const PairBody home = pair.body[0];
    constexpr double kStep = 1e-7;
    double worst = 0, largest = 0;
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
    EXPECT_LE(worst, 1e-7 * largest) << "pose " << s;
    ++tested;
  }
  EXPECT_GE(tested, 40);
  EXPECT_GE(faded, 10) << "the poses must exercise the fading terms";
  EXPECT_GE(shared, roughness > .3 ? poses / 60 : 0) << "the poses must have vertices with several minima";
}

TEST(PairPotential, force_and_torque_are_the_gradient_of_the_energy) { expect_exact_gradient(0); }
// docs/reference/contact-law.md section 3.7
TEST(PairPotential, force_and_torque_are_the_gradient_of_the_energy_at_dents) { expect_exact_gradient(0, CellSide::b, 0, 0, .4); }
TEST(PairPotential, force_and_torque_are_the_gradient_of_the_energy_at_dents_with_crowds) {
  expect_exact_gradient(0, CellSide::b, 0, 1, .4);
}
TEST(PairPotential, force_and_torque_are_the_gradient_of_the_energy_at_dents_with_cells) {
  expect_exact_gradient(.1, CellSide::both, 0, 0, .4);
}
TEST(PairPotential, force_and_torque_are_the_gradient_of_the_energy_at_dents_with_a_barrier) {
  expect_exact_gradient(0, CellSide::b, 3 * kStiffness, 0, .4);
}
TEST(PairPotential, force_and_torque_are_the_gradient_of_the_energy_with_weights_by_density) {
  const Shape rock = make_solid("rock", test::scaled(test::rock(1, 4), 0.5));
  const auto weights = density_weights(make_solver_shape(rock), kDensityRadius * std::sqrt(0.5 * 0.03));
  ASSERT_LT(*std::min_element(weights.begin(), weights.end()), 0.2);
  expect_exact_gradient(0, CellSide::b, 0, 2);
}

// docs/reference/contact-law.md section 4, weakness 1: cells of a very large wall, here far smaller than they would ever be.
TEST(PairPotential, force_and_torque_are_the_gradient_of_the_energy_with_cells) { expect_exact_gradient(.1); }
TEST(PairPotential, force_and_torque_are_the_gradient_of_the_energy_with_cells_of_the_first_body) {
  expect_exact_gradient(.1, CellSide::a);
}
TEST(PairPotential, force_and_torque_are_the_gradient_of_the_energy_with_cells_of_both_bodies) {
  expect_exact_gradient(.1, CellSide::both);
}
TEST(PairPotential, force_and_torque_are_the_gradient_of_the_energy_with_a_barrier) {
  expect_exact_gradient(0, CellSide::b, 3 * kStiffness);
}

// Where both bodies have cells of one size, it does not matter which of them is A.
TEST(PairPotential, with_cells_of_both_bodies_the_first_may_be_the_second) {
  std::mt19937 g(4);
  int split = 0, tested = 0;
  for (int s = 0; s < 40; ++s) {
    const TriangleMesh one = test::scaled(test::rock(1, 2), 0.5), other = test::scaled(test::rock(2, 1), 0.5);
    TwoBodies pair(one, other, kStiffness, 0.06, 1, 0), swapped(other, one, kStiffness, 0.06, 1, 0);
    pair.cell_size = swapped.cell_size = 0.1;
    pair.cells = swapped.cells = CellSide::both;
    place_at_random(pair, g);
    if (!pair.approach(1.8)) continue;
    while (pair.force(0).largest_overlap < 0.02) pair.body[0].x.z -= 0.0005;
    for (int i = 0; i < 2; ++i) {
      swapped.body[i].x = pair.body[1 - i].x;
      swapped.body[i].q = pair.body[1 - i].q;
    }
    const PairForce f = pair.force(0), back = swapped.force(0);
    EXPECT_NEAR(back.elastic, f.elastic, 1e-10 * f.elastic);
    EXPECT_LE(length(swapped.force_on_a() + pair.force_on_a()), 1e-9 * length(f.force));
    pair.cells = CellSide::b;
    split += std::abs(pair.force(0).elastic - f.elastic) > 1e-3 * f.elastic ? 1 : 0;
    ++tested;
  }
  EXPECT_GE(tested, 25);
  EXPECT_GE(split, 5) << "the cells of one side alone must mean another energy, or this shows nothing";
}

TEST(PairPotential, one_feature_is_a_linear_spring_and_n_equal_ones_are_stiffer_by_n_to_the_quarter) {
  // a cube face on a larger cube face: four corners at the same overlap
  TwoBodies pair(test::grid_box(1, {1, 1, 1}), test::grid_box(1, {3, 3, 1}), kStiffness, kMargin, 1, 0);
  pair.body[0].x.z = 1 + 0.75 * kMargin;
  const PairForce f = pair.force(0);
  ASSERT_EQ(pair.features.size(), 4u);
  const double d = 0.25 * kMargin;
  EXPECT_NEAR(f.elastic, 0.5 * kStiffness * d * d * std::sqrt(2.0), 1e-13 * kStiffness * d * d * 1e2);
}

// docs/reference/contact-law.md section 5, test 3: mean <= 1.5e-4, max <= 3e-3 at 100 steps a contact.
TEST(PairPotential, elastic_impacts_of_rocks_keep_their_energy_at_every_refinement) {
  for (const int level : {1, 2}) {
    const test::Statistics s = elastic_impacts(level, 0, 100, 60);
    RecordProperty("level_" + std::to_string(level) + "_mean", std::to_string(s.mean));
    EXPECT_GE(s.hits, 40);
    EXPECT_LE(s.mean, 1.5e-4) << "level " << level;
    EXPECT_LE(s.worst, 3e-3) << "level " << level;
  }
}

// docs/reference/contact-law.md section 5, test 4: a flat subdivision changes nothing.
TEST(PairPotential, a_flat_subdivision_of_a_rock_changes_no_trajectory) {
  std::vector<double> coarse, fine;
  elastic_impacts(1, 0, 100, 10, &coarse);
  elastic_impacts(1, 1, 100, 10, &fine);
  ASSERT_EQ(coarse.size(), fine.size());
  ASSERT_FALSE(coarse.empty());
  for (std::size_t i = 0; i < coarse.size(); ++i) EXPECT_NEAR(coarse[i], fine[i], 1e-9);
}

// docs/reference/contact-law.md section 5, test 6: each feature pushes, with and without damping.
TEST(PairPotential, feature_forces_never_pull) {
  std::mt19937 g(5);
  int looked_at = 0, separating = 0;
  for (int s = 0; s < 20; ++s) {
    TwoBodies pair(test::scaled(test::rock(3, 2, 0.3), 0.5), test::scaled(test::rock(4, 2, 0.3), 0.5), 600, 0.06, 0.5, 0.5);
    place_at_random(pair, g);
    if (!pair.approach(1.8)) continue;
    for (int n = 0; n < 2000; ++n) {
      pair.step(1e-4);
      for (std::size_t j = 0; j < pair.outputs.size(); ++j) {
        const ContactOutput& c = pair.outputs[j];
        EXPECT_GE(c.normal_force, 0);
        // minima of one vertex hand load from one to the other: friction is limited by the push of each, which is not all of its force
        const bool hands_load = pair.features[j].faded && indices_of_key(pair.features[j].key).kind != kEdgeEdge;
        EXPECT_LE(length(c.tangential_force), 0.5 * c.normal_force * (hands_load ? 1.2 : 1 + 1e-12));
        ++looked_at;
        separating += c.normal_force == 0 ? 1 : 0;
      }
    }
  }
  EXPECT_GT(looked_at, 1000);
  EXPECT_GT(separating, 0) << "the clamp against tension must have been at work";
}

TEST(Restitution, the_damping_ratio_map_agrees_with_the_published_table) {
  const double table[][2] = {{.1, 1.24318785}, {.2, .73124693}, {.3, .49723939}, {.5, .25527564}, {.8, .07435510}, {.98, .00645713}};
  for (const auto& row : table) EXPECT_NEAR(damping_ratio_of_restitution(row[0]), row[1], 2e-8);
  EXPECT_EQ(damping_ratio_of_restitution(1), 0);
  EXPECT_NEAR(restitution_of_damping_ratio(0.1), .744079, 1e-6);
  EXPECT_NEAR(restitution_of_damping_ratio(2), .047769, 1e-6);
}

}  // namespace
}  // namespace scree
