// The pair potential on pairs of concave rocks: gradient, energy, mesh independence. CONTACT.md section 5.
#include <gtest/gtest.h>

#include <algorithm>

#include "solver/motion.hpp"
#include "solver/potential.hpp"
#include "solver/solver_scene.hpp"
#include "tests/support/scenes.hpp"
#include "tests/support/shapes.hpp"

namespace scree {
namespace {

/// Two free meshes of unit mass, and the law between them: no grid, no ranks.
class TwoBodies {
 public:
  TwoBodies(const TriangleMesh& a, const TriangleMesh& b, double stiffness, double margin, double restitution, double friction)
      : scene_(test::empty_scene(stiffness, restitution, friction, 0.5 * margin)), margin_(margin) {
    scene_.shapes = {make_solid("a", a), make_solid("b", b)};
    prepared_ = std::make_unique<SolverScene>(scene_);
    for (int i = 0; i < 2; ++i) {
      body[i].shape = &prepared_->shape(i);
      inverse_mass[i] = 1;
      inverse_inertia[i] = {10, 10 / 1.1, 10 / 0.9};
    }
  }
  PairForce force(double dt) {
    const double motion = lists_.skin < 0 ? 1e300 : motion_since_listed(lists_, body[0], body[1], radius(0), radius(1));
    double used = motion;
    if (motion > lists_.skin) {
      EXPECT_TRUE(list_mesh_pair(body[0], body[1], margin_, 0.5 * margin_, radius(0), radius(1), *scratch_, lists_));
      used = 0;
    }
    mesh_pair_features(body[0], body[1], margin_, used, lists_, features);
    PairMotion m;
    const Quat to_a = conjugate(body[0].q);
    m.v_a = rotate(to_a, v[0]);
    m.v_b = rotate(to_a, v[1]);
    m.w_a = rotate(to_a, spin(0));
    m.w_b = rotate(to_a, spin(1));
    m.centre_b = rotate(to_a, body[1].x - body[0].x);
    m.inverse_mass_a = inverse_mass[0];
    m.inverse_mass_b = inverse_mass[1];
    m.inverse_inertia_a = inverse_inertia[0];
    m.inverse_inertia_b = inverse_inertia[1];
    m.b_to_a = matrix_of(to_a * body[1].q);
    PairForce f = pair_force(features, prepared_->law(0, 0), m, dt, springs_, &outputs);
    last_ = f;
    largest_normal = 0;
    for (const ContactFeature& c : features) largest_normal = std::max(largest_normal, kNormalBound * f.elastic / c.depth);
    return f;
  }
  Vec3 spin(int i) const { return angular_velocity(body[i].q, inverse_inertia[i], L[i]); }
  double radius(int i) const { return body[i].scale * body[i].shape->radius; }
  double energy() const {
    double e = last_.elastic;
    for (int i = 0; i < 2; ++i) e += 0.5 * (squared_length(v[i]) / inverse_mass[i] + dot(L[i], spin(i)));
    return e;
  }
  void kick(double h) {
    const Vec3 f = rotate(body[0].q, last_.force), t = rotate(body[0].q, last_.torque);
    v[0] += h * inverse_mass[0] * f;
    v[1] -= h * inverse_mass[1] * f;
    L[0] += h * t;
    L[1] -= h * (t + cross(body[0].x - body[1].x, f));
  }
  void step(double dt) {
    kick(0.5 * dt);
    for (int i = 0; i < 2; ++i) {
      body[i].x += dt * v[i];
      Vec3 w;
      if (inverse_inertia[i].x > 0) rotate_freely(inverse_inertia[i], false, dt, L[i], body[i].q, w);
    }
    force(dt);
    kick(0.5 * dt);
  }
  /// Moves A towards B along -z until they touch, then back a little; false when they pass by each other.
  bool approach(double start) {
    body[0].x.z = start;
    for (int i = 0; i < 1000; ++i) {
      lists_.skin = -1;
      if (force(0); !features.empty()) {
        body[0].x.z += 0.2 * margin_;
        force(0);
        return true;
      }
      body[0].x.z -= 0.2 * margin_;
    }
    return false;
  }

  PairBody body[2];
  Vec3 v[2], L[2], inverse_inertia[2];
  double inverse_mass[2];
  std::vector<ContactFeature> features;
  std::vector<ContactOutput> outputs;
  double largest_normal = 0;  // bound of any single elastic feature force

 private:
  static constexpr double kNormalBound = 2;  // f_j d_j <= sum f_j d_j = k D^2 = 2 U
  Scene scene_;
  std::unique_ptr<SolverScene> prepared_;
  double margin_;
  CandidateLists lists_;
  std::vector<FrictionSpring> springs_;
  MeshDistanceScratchPtr scratch_ = make_mesh_distance_scratch();
  PairForce last_;
};

constexpr double kMargin = 0.02, kStiffness = 1e4;

void place_at_random(TwoBodies& pair, std::mt19937& g) {
  std::normal_distribution<double> n;
  pair.body[0].q = test::random_quaternion(g);
  pair.body[1].q = test::random_quaternion(g);
  pair.body[0].x = {0.12 * n(g), 0.12 * n(g), 0};
  pair.v[0] = {0, 0, -0.5};
  pair.v[1] = {0, 0, 0.5};
}

TEST(PairPotential, force_and_torque_are_the_gradient_of_the_energy) {
  std::mt19937 g(3);
  int tested = 0, faded = 0;
  for (int s = 0; s < 60; ++s) {
    TwoBodies pair(test::scaled(test::rock(1, 2), 0.5), test::scaled(test::rock(2, 1), 0.5), kStiffness, 0.06, 1, 0);
    place_at_random(pair, g);
    if (!pair.approach(1.8)) continue;
    while (pair.force(0).deepest < 0.02) pair.body[0].x.z -= 0.001;
    if (pair.features.size() < 2) continue;
    for (const ContactFeature& f : pair.features) faded += f.faded ? 1 : 0;
    const PairForce at = pair.force(0);
    const Vec3 force = rotate(pair.body[0].q, at.force), torque = rotate(pair.body[0].q, at.torque);
    const PairBody home = pair.body[0];
    constexpr double kStep = 1e-7;
    double worst = 0, largest = 0;
    for (int c = 0; c < 6; ++c) {
      double u[2];
      for (int side = 0; side < 2; ++side) {
        const double e = side == 1 ? kStep : -kStep;
        if (c < 3) pair.body[0].x[c] += e;
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
}

TEST(PairPotential, one_feature_is_a_linear_spring_and_n_equal_ones_are_stiffer_by_n_to_the_quarter) {
  // a cube face on a larger cube face: four corners at the same depth
  TwoBodies pair(test::grid_box(1, {1, 1, 1}), test::grid_box(1, {3, 3, 1}), kStiffness, kMargin, 1, 0);
  pair.body[0].x.z = 1 + 0.75 * kMargin;
  const PairForce f = pair.force(0);
  ASSERT_EQ(pair.features.size(), 4u);
  const double d = 0.25 * kMargin;
  EXPECT_NEAR(f.elastic, 0.5 * kStiffness * d * d * std::sqrt(2.0), 1e-13 * kStiffness * d * d * 1e2);
}

struct Statistics {
  double mean = 0, worst = 0;
  int hits = 0;
};

Statistics elastic_impacts(int level, int flat_levels, double steps_per_contact, int count, std::vector<double>* trace = nullptr) {
  std::mt19937 g(11);
  Statistics s;
  for (int i = 0; i < count; ++i) {
    TwoBodies pair(test::scaled(test::rock(1, level, 0.22, flat_levels), 0.5), test::scaled(test::rock(2, level, 0.22, flat_levels), 0.5),
                   kStiffness, kMargin, 1, 0);
    place_at_random(pair, g);
    if (!pair.approach(1.8)) continue;
    const double dt = 3.14159265358979 * std::sqrt(0.5 / kStiffness) / steps_per_contact;
    const double before = pair.energy();
    bool touched = false;
    int quiet = 0;
    for (int n = 0; n < 12 * steps_per_contact && quiet < steps_per_contact; ++n) {
      pair.step(dt);
      touched = touched || !pair.features.empty();
      quiet = pair.features.empty() && touched ? quiet + 1 : 0;
    }
    if (!touched) continue;
    const double error = std::abs(pair.energy() / before - 1);
    s.mean += error;
    s.worst = std::max(s.worst, error);
    ++s.hits;
    if (trace != nullptr) trace->insert(trace->end(), {pair.v[0].x, pair.v[0].y, pair.v[0].z, pair.L[1].x});
  }
  s.mean /= std::max(1, s.hits);
  return s;
}

// CONTACT.md section 5, test 3: mean <= 1.5e-4, max <= 3e-3 at 100 steps a contact.
TEST(PairPotential, elastic_impacts_of_rocks_keep_their_energy_at_every_refinement) {
  for (const int level : {1, 2}) {
    const Statistics s = elastic_impacts(level, 0, 100, 60);
    RecordProperty("level_" + std::to_string(level) + "_mean", std::to_string(s.mean));
    EXPECT_GE(s.hits, 40);
    EXPECT_LE(s.mean, 1.5e-4) << "level " << level;
    EXPECT_LE(s.worst, 3e-3) << "level " << level;
  }
}

// CONTACT.md section 5, test 4: a flat subdivision changes nothing.
TEST(PairPotential, a_flat_subdivision_of_a_rock_changes_no_trajectory) {
  std::vector<double> coarse, fine;
  elastic_impacts(1, 0, 100, 10, &coarse);
  elastic_impacts(1, 1, 100, 10, &fine);
  ASSERT_EQ(coarse.size(), fine.size());
  ASSERT_FALSE(coarse.empty());
  for (std::size_t i = 0; i < coarse.size(); ++i) EXPECT_NEAR(coarse[i], fine[i], 1e-9);
}

// CONTACT.md section 5, test 6: each feature pushes, with and without damping.
TEST(PairPotential, feature_forces_never_pull) {
  std::mt19937 g(5);
  int looked_at = 0, separating = 0;
  for (int s = 0; s < 20; ++s) {
    TwoBodies pair(test::scaled(test::rock(3, 2, 0.3), 0.5), test::scaled(test::rock(4, 2, 0.3), 0.5), 600, 0.06, 0.5, 0.5);
    place_at_random(pair, g);
    if (!pair.approach(1.8)) continue;
    for (int n = 0; n < 2000; ++n) {
      pair.step(1e-4);
      for (const ContactOutput& c : pair.outputs) {
        EXPECT_GE(c.normal_force, 0);
        EXPECT_LE(length(c.tangential_force), 0.5 * pair.largest_normal * (1 + 1e-12));
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
