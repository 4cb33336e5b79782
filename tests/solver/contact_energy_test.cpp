// docs/reference/contact-law.md section 5, tests 2, 3, 5 and 9, at full size; prints what was measured.
#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <filesystem>
#include <string>

#include "core/storage/shape_file.hpp"
#include "mesher/io/mesh_file.hpp"
#include "mesher/repair/mesh_repair.hpp"
#include "solver/contact/chosen_law.hpp"
#include "tests/solver/contact_cases.hpp"

namespace scree {
namespace {

using test::TwoBodies;

void print(const char* what, const test::Statistics& s) {
  std::printf("%-24s hits %3d  mean %.2e  worst %.2e  depth/margin %.2f\n", what, s.hits, s.mean, s.worst, s.largest_overlap);
}

// Test 2: an energy jump would stay where it is as the step shrinks.
TEST(ContactEnergy, worst_of_100_elastic_impacts_falls_eightfold_from_200_to_1600_steps) {
  double first = 0, last = 0;
  for (const int steps : {200, 400, 800, 1600}) {
    const test::Statistics s = test::elastic_impacts(2, 0, steps, 130);
    print(("L2 N_c " + std::to_string(steps)).c_str(), s);
    EXPECT_GE(s.hits, 100);
    (steps == 200 ? first : last) = s.worst;
  }
  EXPECT_GE(first, 8 * last);
}

// Section 3.7: vertices in dents. With the nearest face alone the worst fell by 3.9, since the force jumped there.
TEST(ContactEnergy, worst_of_100_elastic_impacts_of_dented_bodies_falls_tenfold_from_120_to_480_steps) {
  double worst[2];
  for (const int n : {0, 1}) {
    const test::Statistics s = test::elastic_impacts(2, 0, n == 0 ? 120 : 480, 130, nullptr, .4);
    print(n == 0 ? "dents L2 N_c 120" : "dents L2 N_c 480", s);
    EXPECT_GE(s.hits, 100);
    worst[n] = s.worst;
  }
  EXPECT_GE(worst[0], 10 * worst[1]);
}

/// The worst error at 120 and at 480 steps a contact, printed with what it is of.
std::array<double, 2> worst_at_120_and_480(const std::string& what, const TriangleMesh& first, const TriangleMesh& second) {
  std::array<double, 2> worst{};
  for (const int n : {0, 1}) {
    const int steps = n == 0 ? 120 : 480;
    const test::Statistics s = test::elastic_impacts_of(first, second, steps, 130);
    print((what + " N_c " + std::to_string(steps)).c_str(), s);
    EXPECT_GE(s.hits, 60) << what;
    worst[static_cast<std::size_t>(n)] = s.worst;
  }
  return worst;
}

TEST(ContactEnergy, worst_of_elastic_impacts_of_rocks_and_cups_falls_tenfold_from_120_to_480_steps) {
  const auto [coarse, fine] = worst_at_120_and_480("rock and cup", test::scaled(test::rock(1, 2), 0.3), test::bowl(.5, .4, 16, 6));
  EXPECT_GE(coarse, 10 * fine);
}

TEST(ContactEnergy, worst_of_elastic_impacts_of_scanned_bodies_falls_tenfold_from_120_to_480_steps) {
  for (const char* name : {"toutatis", "castalia"}) {
    const std::string path = std::string("/usr/share/openuniverse/3dmodels/") + name + ".bmf";
    if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is missing: apt-get install openuniverse-common";
    TriangleMesh scan = read_mesh_file(path).mesh;
    clean_mesh(scan, false);
    turn_outward(scan);
    const Shape solid = make_solid(name, scan);
    const TriangleMesh body = test::scaled(solid.mesh, 0.5 / solid.bounding_radius());
    const auto [coarse, fine] = worst_at_120_and_480(name, body, body);
    EXPECT_GE(coarse, 10 * fine);
  }
}

// Test 3.
TEST(ContactEnergy, energy_of_100_rocks_at_each_level) {
  for (const int level : {1, 2, 3}) {
    const test::Statistics s = test::elastic_impacts(level, 0, 100, 130);
    print(("rocks L" + std::to_string(level)).c_str(), s);
    EXPECT_GE(s.hits, 100);
    EXPECT_LE(s.mean, 1.5e-4);
    EXPECT_LE(s.worst, 3e-3);
  }
}

// Test 3: up to 167 features at once.
TEST(ContactEnergy, energy_of_nested_bowls) {
  const test::Statistics s = test::nested_bowls(40);
  print("nested bowls", s);
  EXPECT_GE(s.hits, 38);
  EXPECT_LE(s.mean, 2e-4);
  EXPECT_LE(s.worst, 2e-3);
}

// docs/reference/validation-plan.md M4.
TEST(ContactEnergy, energy_of_boxes_that_land_nearly_flat) {
  for (const bool free_base : {false, true}) {
    const test::Statistics s = test::near_flat_impacts(free_base, 400, 60);
    print(free_base ? "near-flat, two free boxes" : "near-flat, fixed base", s);
    EXPECT_GE(s.hits, 55);
    EXPECT_LE(s.mean, 1e-4);
    EXPECT_LE(s.worst, 1e-2);
  }
}

TEST(ContactEnergy, energy_at_a_size_ratio_of_ten) {
  const test::Statistics s = test::size_ratio_ten(100);
  print("size ratio 10", s);
  EXPECT_GE(s.hits, 80);
  EXPECT_LE(s.worst, 1e-3);
}

// Test 9: momenta, with unequal masses, damping and friction; scale: sum of masses times speed is 1.25.
TEST(ContactEnergy, momenta_are_those_of_the_start) {
  std::mt19937 g(17);
  int contacts = 0;
  for (int s = 0; s < 10; ++s) {
    TwoBodies pair(test::scaled(test::rock(1, 2), .5), test::scaled(test::rock(2, 2), .3), test::kStiffness, test::kMargin, .5, .5);
    place_at_random(pair, g);
    pair.inverse_mass[0] = .5;
    pair.inverse_mass[1] = 4;
    if (!pair.approach(1.8)) continue;
    const auto momentum = [&] { return 2 * pair.v[0] + .25 * pair.v[1]; };
    const auto angular = [&] {
      return pair.L[0] + pair.L[1] + cross(pair.body[0].x, 2 * pair.v[0]) + cross(pair.body[1].x, .25 * pair.v[1]);
    };
    const Vec3 p = momentum(), L = angular();
    for (int n = 0; n < 600; ++n) {
      pair.step(2e-4);
      contacts += static_cast<int>(pair.features.size());
    }
    EXPECT_LE(length(momentum() - p), 1e-13);
    EXPECT_LE(length(angular() - L), 1e-13);
  }
  EXPECT_GT(contacts, 500);
}

// Test 9 and M8: neither the order of features nor that of triangles and vertices matters beyond rounding.
TEST(ContactEnergy, forces_do_not_know_the_order_of_features_or_triangles) {
  std::mt19937 g(23);
  const TriangleMesh a = test::bowl(.5, .4, 16, 6), b = test::bowl(.65, .53, 20, 7);
  const auto settle = [&](TwoBodies& pair) {
    pair.fix(1);
    pair.body[0].q = normalised(Quat{1, .01, .02, .3});  // centre and principal axes differ in the last bits between orders,
    pair.body[0].x = {.005, .002, .012};                 // so the test places the meshes by them, not by the file's frame
    pair.body[1].x = {};
    pair.body[1].q = {};
  };
  TwoBodies plain(a, b, test::kStiffness, test::kMargin, 1, 0);
  settle(plain);
  plain.approach(.2, 0);
  plain.body[0].x.z -= .4 * test::kMargin;
  const PairForce expected = plain.force(0);
  ASSERT_GE(plain.features.size(), 4u);
  const double size = length(expected.force);

  PairMotion still{};
  still.inverse_mass_a = 1;
  still.inverse_inertia_a = {1, 1, 1};
  PairLaw law;
  law.stiffness = test::kStiffness;
  std::vector<FrictionSpring> none;
  for (int i = 0; i < 20; ++i) {
    PairFeatures features;
    features.list = plain.features;
    std::shuffle(features.list.begin(), features.list.end(), g);
    const PairForce f = pair_force_function({})(features, law, still, 0, 0, none, nullptr);
    EXPECT_LE(length(f.force - expected.force), 1e-14 * size);
    EXPECT_LE(length(f.torque - expected.torque), 1e-14 * size);
    EXPECT_NEAR(f.elastic, expected.elastic, 1e-14 * expected.elastic);
  }
  for (int i = 0; i < 3; ++i) {
    TwoBodies other(test::shuffled(a, g), test::shuffled(b, g), test::kStiffness, test::kMargin, 1, 0);
    settle(other);
    other.body[0].x.z = plain.body[0].x.z;
    const PairForce f = other.force(0);
    // The mass integrals run in the order of the triangles: centre and axes turn by rounding, which overlap magnifies by
    // size over overlap.
    constexpr double kMassRounding = 1e-12;
    EXPECT_LE(length(f.force - expected.force), kMassRounding / (plain.last().largest_overlap) * size);
    EXPECT_EQ(other.features.size(), plain.features.size());
  }
}

// Test 5.
TEST(ContactEnergy, restitution_of_a_locked_icosphere_is_the_nominal_one_at_any_level_and_speed) {
  for (int level = 0; level <= 5; ++level) {
    const double coarse = test::LockedIcosphere{level, 1, 100}.run().restitution;
    const double fine = test::LockedIcosphere{level, 1, 400}.run().restitution;
    const double slow = test::LockedIcosphere{level, .1, 400}.run().restitution;
    std::printf("icosphere L%d: e %.5f at 100, %.5f at 400, %.5f at 400 and speed 0.1\n", level, coarse, fine, slow);
    // asked for: 5e-3 at 100, 1e-3 at 400; damping of second order in the step does better
    EXPECT_NEAR(coarse, .5, 2e-3) << level;
    EXPECT_NEAR(fine, .5, 1e-4) << level;
    EXPECT_NEAR(slow, .5, 1e-4) << level;
  }
}

// docs/reference/validation-plan.md M2: restitution within 0.5 % at 1000 steps a contact, duration within 18 %; its word "monotone" is that
// of weights that have no limit (docs/reference/contact-law.md section 6).
TEST(ContactEnergy, a_locked_icosphere_rebounds_within_half_a_percent_at_any_level_and_its_contact_lasts_as_long_within_18_percent) {
  std::vector<double> duration;
  for (int level = 0; level <= 5; ++level) {
    const auto impact = test::LockedIcosphere{level, 1, 1000}.run();
    std::printf("icosphere L%d: e %.5f at 1000 steps a contact, touches for %.3f ms\n", level, impact.restitution, 1e3 * impact.duration);
    EXPECT_NEAR(impact.restitution, .5, .005 * .5) << level;
    duration.push_back(impact.duration);
  }
  const auto [least, most] = std::minmax_element(duration.begin(), duration.end());
  EXPECT_LE(*most, 1.18 * *least);
}

// Issue 4: concave rocks of 80, 320 and 1280 triangles rebound in the mean as asked, to 2 %, whether they may turn or not.
TEST(ContactEnergy, mean_restitution_of_concave_rocks_is_the_nominal_one_at_every_refinement) {
  for (const bool turning : {false, true}) {
    for (const int level : {1, 2, 3}) {
      const test::Statistics s = test::rock_restitutions(level, turning, 130);
      std::printf("rocks L%d %s: %d impacts, mean e %.4f, largest %.3f\n", level, turning ? "free" : "locked", s.hits, s.mean, s.worst);
      EXPECT_GE(s.hits, 100);
      EXPECT_NEAR(s.mean, .5, .02 * .5) << level;
    }
  }
}

}  // namespace
}  // namespace scree
