// Two meshes and the law between them, stepped alone: no grid, no ranks. The set-ups of docs/reference/contact-law.md sections 1 and 2.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <numbers>

#include "solver/bodies/motion.hpp"
#include "solver/contact/chosen_law.hpp"
#include "solver/contact/cluster_weights.hpp"
#include "solver/scene/solver_scene.hpp"
#include "tests/support/scenes.hpp"
#include "tests/support/shapes.hpp"

namespace scree::test {

/// Two free meshes of unit mass, and the law between them: no grid, no ranks.
class TwoBodies {
 public:
  /// in   pull_off, range   of the attraction [N, m]; 0: none
  TwoBodies(const TriangleMesh& a, const TriangleMesh& b, double stiffness, double margin, double restitution, double friction,
            double pull_off = 0, double range = 0)
      : scene_(test::empty_scene(stiffness, restitution, friction, 0.5 * margin)), margin_(margin), reach_(margin + range) {
    scene_.pairs[0].pull_off = pull_off;
    scene_.pairs[0].adhesion_range = range;
    scene_.shapes = {make_solid("a", a), make_solid("b", b)};
    prepare();
  }
  /// A liquid bridge in place of the attraction: of as much force at touch, that ruptures at its range; between bodies of R* = 1.
  void make_bridge() {
    MaterialPair& pair = scene_.pairs[0];
    const double force = pair.pull_off, range = pair.adhesion_range;
    pair.pull_off = pair.adhesion_range = 0;
    pair.contact_radius = 1;
    pair.surface_tension = force / (4 * std::numbers::pi);
    pair.bridge_rupture = BridgeRupture::lian;
    pair.bridge_volume = range * range * range;
    prepare();
  }
  void prepare() {
    prepared_ = std::make_unique<SolverScene>(scene_);
    for (int i = 0; i < 2; ++i) {
      body[i].shape = &prepared_->shape(i);
      body[i].weights = prepared_->weights(i, 1);
      inverse_mass[i] = 1;
      inverse_inertia[i] = {10, 10 / 1.1, 10 / 0.9};
    }
  }
  PairForce force(double dt) {
    const RelativePose pose(body[0], body[1]);
    const double motion = lists_.skin < 0 ? 1e300 : follow_motion(lists_, pose, radius(0), radius(1));
    if (motion > lists_.skin) {
      EXPECT_TRUE(
          list_mesh_pair(body[0], body[1], reach_, kSharingOfVertices * margin_, 0.5 * margin_, radius(0), radius(1), *scratch_, lists_));
    }
    mesh_pair_features(body[0], body[1], pose, reach_, kSharingOfVertices * margin_, std::min(radius(0), radius(1)), lists_, features);
    if (reach_ > margin_) {
      for (ContactFeature& f : features) f.overlap -= reach_ - margin_;
    }
    PairMotion m;
    const Quat to_a = conjugate(body[0].q);
    m.v_a = rotate(to_a, v[0]);
    m.v_b = rotate(to_a, v[1]);
    m.w_a = rotate(to_a, spin(0));
    m.w_b = rotate(to_a, spin(1));
    m.centre_b = m.pivot_b = rotate(to_a, body[1].x - body[0].x);
    m.pivot_v_b = m.v_b;
    m.inverse_mass_a = inverse_mass[0];
    m.inverse_mass_b = inverse_mass[1];
    m.inverse_inertia_a = inverse_inertia[0];
    m.inverse_inertia_b = inverse_inertia[1];
    m.turn = to_a * body[1].q;
    m.b_to_a = matrix_of(m.turn);
    found_.list = features;
    found_.has_cells = cell_size > 0;
    found_.cluster_share = 1;
    if (reach_ > margin_) {
      PullView pull{reach_ - margin_, prepared_->pull_table_depth(), body[0], body[1]};
      pull.a.weights = prepared_->pull_weights(0, 1);
      pull.b.weights = prepared_->pull_weights(1, 1);
      solve_weights_separately(0.5 * margin_, !(barrier > 0), pull, found_);
    } else {
      solve_weights(0.5 * margin_, !(cell_size > 0 || barrier > 0), found_);
    }
    if (cell_size > 0) {
      find_cell_shares(body[0], body[1], cell_size, cells, features, found_.cells);
      found_.cell_energy = energy_share(cells);
    }
    PairLaw law = prepared_->law(0, 0);
    m.radius = law.radius;
    law.barrier = barrier;
    law.margin = margin_;
    if (friction_sliding >= 0) law.friction_sliding = friction_sliding;
    PairForce f = pair_force_function(prepared_->law_choice())(found_, law, m, dt, dt, springs_, &outputs);
    last_ = f;
    return f;
  }
  /// Puts a body where its file says: origin of the file at `origin`, its axes turned by `turn`.
  void place(int i, const Vec3& origin, const Quat& turn = {}) {
    body[i].q = turn * body[i].shape->body_from_principal;
    body[i].x = origin + rotate(turn, scene_.shapes[static_cast<std::size_t>(i)].origin_shift);
  }
  /// Inertia [kg m^2] of a body of the given mass and of the shape that its mesh has.
  void set_mass(int i, double mass) {
    const double density = mass / body[i].shape->volume;
    const Vec3& I = body[i].shape->inertia;
    inverse_mass[i] = 1 / mass;
    inverse_inertia[i] = {1 / (density * I.x), 1 / (density * I.y), 1 / (density * I.z)};
  }
  void fix(int i) {
    inverse_mass[i] = 0;
    inverse_inertia[i] = {};
  }
  Vec3 spin(int i) const { return angular_velocity(body[i].q, inverse_inertia[i], L[i]); }
  double radius(int i) const { return body[i].scale * body[i].shape->radius; }
  double energy() const { return last_.elastic + kinetic_energy(0) + kinetic_energy(1); }
  double kinetic_energy(int i) const {
    if (inverse_mass[i] == 0) return 0;
    return 0.5 * (squared_length(v[i]) / inverse_mass[i] + dot(L[i], spin(i)));
  }
  /// Takes the lists of candidates for used up: after a body was put elsewhere.
  void forget_lists() { lists_ = {}; }
  const PairForce& last() const { return last_; }
  const std::vector<FrictionSpring>& springs() const { return springs_; }
  /// Force on A as of the last evaluation, world.
  Vec3 force_on_a() const { return rotate(body[0].q, last_.force); }
  void kick(double h) {
    const Vec3 f = rotate(body[0].q, last_.force), t = rotate(body[0].q, last_.torque);
    v[0] += h * (inverse_mass[0] * f + gravity);
    v[1] -= h * inverse_mass[1] * f;
    L[0] += h * t;
    if (inverse_mass[1] > 0) L[1] -= h * (t + cross(body[0].x - body[1].x, f));
  }
  void step(double dt) {
    kick(0.5 * dt);
    for (int i = 0; i < 2; ++i) {
      body[i].x += dt * v[i];
      Vec3 w;
      if (!(inverse_inertia[i].x > 0)) continue;
      const Vec3& inverse = inverse_inertia[i];
      rotate_freely(Integrator::kdk_dlm, {1 / inverse.x, 1 / inverse.y, 1 / inverse.z}, inverse, false, dt, L[i], body[i].q, remainder[i],
                    w);
    }
    force(dt);
    kick(0.5 * dt);
  }
  /// Moves A towards B along -z until they touch, then back by `back`; false when they pass by each other.
  bool approach(double start, double back = -1) {
    body[0].x.z = start;
    for (int i = 0; i < 1000; ++i) {
      lists_.skin = -1;
      if (force(0); !features.empty()) {
        body[0].x.z += back < 0 ? 0.2 * margin_ : back;
        force(0);
        return true;
      }
      body[0].x.z -= 0.2 * margin_;
    }
    return false;
  }

  PairBody body[2];
  Vec3 v[2], L[2], inverse_inertia[2];
  Quat remainder[2] = {{0, 0, 0, 0}, {0, 0, 0, 0}};  // of the orientations
  double inverse_mass[2];
  Vec3 gravity;                  // on A only [m/s^2]
  double cell_size = 0;          // as if B were a very large wall [m]
  CellSide cells = CellSide::b;  // or A a very large body, or both
  double barrier = 0;            // k_b [N/m]
  double friction_sliding = -1;  // below that at rest; < 0: the same
  std::vector<ContactFeature> features;
  std::vector<ContactOutput> outputs;

 private:
  Scene scene_;
  std::unique_ptr<SolverScene> prepared_;
  double margin_, reach_;
  CandidateLists lists_;
  std::vector<FrictionSpring> springs_;
  PairFeatures found_;
  MeshDistanceScratchPtr scratch_ = make_mesh_distance_scratch();
  PairForce last_;
};

inline constexpr double kMargin = 0.02, kStiffness = 1e4;

inline void place_at_random(TwoBodies& pair, std::mt19937& g) {
  std::normal_distribution<double> n;
  pair.body[0].q = test::random_quaternion(g);
  pair.body[1].q = test::random_quaternion(g);
  pair.body[0].x = {0.12 * n(g), 0.12 * n(g), 0};
  pair.v[0] = {0, 0, -0.5};
  pair.v[1] = {0, 0, 0.5};
}

struct Statistics {
  double mean = 0, worst = 0;
  int hits = 0;
  double largest_overlap = 0;  // of the margin sum
  void add(double error) {
    ++hits;
    mean += (error - mean) / hits;
    worst = std::max(worst, error);
  }
};

/// Impacts of two free bodies that meet at random, without damping: what their energy is off by after each.
/// in   trace   when not null: some velocities after each impact
inline Statistics elastic_impacts_of(const TriangleMesh& first, const TriangleMesh& second, double steps_per_contact, int count,
                                     std::vector<double>* trace = nullptr) {
  std::mt19937 g(11);
  Statistics s;
  for (int i = 0; i < count; ++i) {
    TwoBodies pair(first, second, kStiffness, kMargin, 1, 0);
    place_at_random(pair, g);
    if (!pair.approach(1.8)) continue;
    const double dt = std::numbers::pi * std::sqrt(0.5 / kStiffness) / steps_per_contact;
    const double before = pair.energy();
    bool touched = false;
    int quiet = 0;
    for (int n = 0; n < 12 * steps_per_contact && quiet < steps_per_contact; ++n) {
      pair.step(dt);
      s.largest_overlap = std::max(s.largest_overlap, pair.last().largest_overlap / kMargin);
      touched = touched || !pair.features.empty();
      quiet = pair.features.empty() && touched ? quiet + 1 : 0;
    }
    if (!touched) continue;
    s.add(std::abs(pair.energy() / before - 1));
    if (trace != nullptr) trace->insert(trace->end(), {pair.v[0].x, pair.v[0].y, pair.v[0].z, pair.L[1].x});
  }
  return s;
}

inline Statistics elastic_impacts(int level, int flat_levels, double steps_per_contact, int count, std::vector<double>* trace = nullptr,
                                  double roughness = 0.22) {
  return elastic_impacts_of(test::scaled(test::rock(1, level, roughness, flat_levels), 0.5),
                            test::scaled(test::rock(2, level, roughness, flat_levels), 0.5), steps_per_contact, count, trace);
}

}  // namespace scree::test
