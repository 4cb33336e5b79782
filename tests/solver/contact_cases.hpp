// The scenes of docs/reference/contact-law.md section 5 that both the short tests and the full ones run.
#pragma once

#include "tests/solver/two_bodies.hpp"

namespace scree::test {

/// Bowl in a fixed bowl, dropped without damping; `count` drops of both small and larger tilts.
inline Statistics nested_bowls(int count) {
  std::mt19937 g(7);
  std::normal_distribution<double> n;
  Statistics s;
  for (int i = 0; i < count; ++i) {
    TwoBodies pair(bowl(.5, .4, 16, 6), bowl(.65, .53, 20, 7), kStiffness, kMargin, 1, 0);
    pair.inverse_inertia[0] = {1 / .12, 1 / .11, 1 / .15};
    pair.fix(1);
    pair.place(1, {});
    const double tilt = i % 2 == 1 ? .01 : .05;
    const double tx = tilt * n(g), ty = tilt * n(g), turn = n(g);
    const double x = .01 * n(g), y = .01 * n(g);
    pair.place(0, {x, y, .06}, normalised(Quat{1, tx, ty, turn}));
    const double vx = .1 * n(g), vy = .05 * n(g);
    pair.v[0] = {vx, vy, -1};
    for (int c = 0; c < 3; ++c) pair.L[0][c] = .02 * n(g);
    if (!pair.approach(pair.body[0].x.z)) continue;
    const double before = pair.energy(), dt = std::numbers::pi * std::sqrt(1 / kStiffness) / 100;
    bool touched = false;
    for (int k = 0; k < 1500; ++k) {
      pair.step(dt);
      touched = touched || !pair.features.empty();
      s.largest_overlap = std::max(s.largest_overlap, pair.last().largest_overlap / kMargin);
    }
    if (!touched) continue;
    s.add(std::abs(pair.energy() / before - 1));
  }
  return s;
}

/// A small rock against a fixed one ten times as large.
inline Statistics size_ratio_ten(int count) {
  std::mt19937 g(11);
  std::normal_distribution<double> n;
  Statistics s;
  for (int i = 0; i < count; ++i) {
    TwoBodies pair(scaled(rock(1, 2), .1), rock(2, 2), 4e4, .01, 1, 0);
    pair.inverse_inertia[0] = {1 / .004, 1 / .0044, 1 / .0036};
    pair.fix(1);
    pair.body[0].q = random_quaternion(g);
    pair.body[1].q = random_quaternion(g);
    const double x = .3 * n(g), y = .3 * n(g);
    pair.body[0].x = {x, y, 0};
    pair.v[0] = {0, 0, -1};
    if (!pair.approach(2.0)) continue;
    const double before = pair.energy(), dt = std::numbers::pi * std::sqrt(1 / 4e4) / 100;
    bool touched = false;
    for (int k = 0, quiet = 0; k < 1200 && quiet < 100; ++k) {
      pair.step(dt);
      touched = touched || !pair.features.empty();
      quiet = touched && pair.features.empty() ? quiet + 1 : 0;
    }
    if (!touched) continue;
    s.add(std::abs(pair.energy() / before - 1));
  }
  return s;
}

/// Restitutions of pairs of concave rocks of nominal 0.5: e = -(P u') / (P u) with the velocities u of both bodies before, u' after, and
/// the impulses P that they received, which for an impact at one point is the ratio of the normal speeds there.
inline Statistics rock_restitutions(int level, bool turning, int count) {
  std::mt19937 g(19);
  Statistics s;
  for (int i = 0; i < count; ++i) {
    TwoBodies pair(scaled(rock(1, level), .5), scaled(rock(2, level), .5), kStiffness, kMargin, .5, 0);
    if (!turning) pair.inverse_inertia[0] = pair.inverse_inertia[1] = {};
    place_at_random(pair, g);
    if (!pair.approach(1.8)) continue;
    const Vec3 v[2] = {pair.v[0], pair.v[1]};
    constexpr double kSteps = 100;
    const double dt = std::numbers::pi * std::sqrt(.5 / kStiffness) / kSteps;
    bool touched = false;
    double quiet = 0;
    for (int k = 0; k < 12 * kSteps && quiet < kSteps; ++k) {
      pair.step(dt);
      touched = touched || !pair.features.empty();
      quiet = touched && pair.features.empty() ? quiet + 1 : 0;
    }
    if (!touched) continue;
    double before = 0, after = 0;
    for (int b = 0; b < 2; ++b) {
      const Vec3 impulse = (1 / pair.inverse_mass[b]) * (pair.v[b] - v[b]);
      before += dot(impulse, v[b]);
      after += dot(impulse, pair.v[b]) + dot(pair.L[b], pair.spin(b));  // at first nothing turns
    }
    s.add(-after / before);
  }
  return s;
}

/// Boxes that fall without damping on a box nearly flat, one corner after the other; the lower one fixed or free.
inline Statistics near_flat_impacts(bool free_base, double steps_per_contact, int count) {
  std::mt19937 g(13);
  std::normal_distribution<double> n;
  Statistics s;
  for (int i = 0; i < count; ++i) {
    TwoBodies pair(grid_box(1, {1, .8, .6}), grid_box(2, {2.2, 1.7, .5}), kStiffness, kMargin, 1, 0);
    pair.set_mass(0, 1);
    if (free_base)
      pair.set_mass(1, 2);
    else
      pair.fix(1);
    pair.place(1, {});
    const double lean = .03 * n(g), toward = n(g), turn = n(g), x = .2 * n(g), y = .2 * n(g);
    pair.place(0, {x, y, 0}, quaternion_of({std::cos(toward), std::sin(toward), 0}, lean) * quaternion_of({0, 0, 1}, turn));
    pair.v[0] = {0, 0, -1};
    if (!pair.approach(1.2)) continue;
    const double before = pair.energy(), dt = std::numbers::pi * std::sqrt(.5 / kStiffness) / steps_per_contact;
    bool touched = false;
    double quiet = 0;
    for (int k = 0; k < 40 * steps_per_contact && quiet < 2 * steps_per_contact; ++k) {
      pair.step(dt);
      s.largest_overlap = std::max(s.largest_overlap, pair.last().largest_overlap / kMargin);
      touched = touched || !pair.features.empty();
      quiet = touched && pair.features.empty() ? quiet + 1 : 0;
    }
    if (touched) s.add(std::abs(pair.energy() / before - 1));
  }
  return s;
}

/// An icosphere of unit mass and radius 0.5 that may not turn falls on a floor.
struct LockedIcosphere {
  int level;
  double speed, steps_per_contact, restitution = .5;
  Quat orientation = quaternion_of(normalised(Vec3{1, 2, 3}), .4);
  bool by_density = true;  ///< the weights of its vertices
  struct Result {
    double restitution = -1, duration = 0, largest_overlap = 0;  ///< [-, s, m]
  };
  Result run() const {
    TwoBodies pair(scaled(icosphere(level), .5), grid_box(1, {4, 4, 1}), kStiffness, kMargin, restitution, 0);
    if (!by_density) pair.body[0].weights = nullptr;
    pair.inverse_inertia[0] = {};
    pair.fix(1);
    pair.body[0].q = orientation;
    pair.v[0] = {0, 0, -speed};
    Result r;
    if (!pair.approach(1.03, 0)) return r;
    pair.body[0].x.z += .3 * kMargin;
    pair.force(0);
    const double dt = std::numbers::pi * std::sqrt(1 / kStiffness) / steps_per_contact;
    int touching = 0;
    for (int n = 0; n < 1000 * steps_per_contact; ++n) {
      pair.step(dt);
      if (touching > 0 && pair.features.empty()) break;
      touching += pair.features.empty() ? 0 : 1;
      r.largest_overlap = std::max(r.largest_overlap, pair.last().largest_overlap);
    }
    r.duration = touching * dt;
    r.restitution = pair.v[0].z / speed;
    return r;
  }
};

/// Largest kinetic energy [J] of a rock between `from` and `until` seconds after it was let go above the bumpy bed; drag for
/// the first 5 s.
inline double energy_of_a_rock_on_a_bed(unsigned seed, int level, double from, double until, double steps_per_contact) {
  std::mt19937 g(40 + seed);
  std::normal_distribution<double> n;
  constexpr double k = 1e5;
  TwoBodies pair(scaled(rock(1 + seed, level), .4), bumpy_bed(), k, kMargin, .3, .5);
  pair.inverse_inertia[0] = {1 / .07, 1 / .075, 1 / .065};
  pair.fix(1);
  pair.place(1, {});
  const double x = .1 * n(g), y = .1 * n(g);
  pair.body[0].q = random_quaternion(g);
  pair.body[0].x = {x, y, 0};
  const double vx = .2 * n(g), vy = .2 * n(g);
  pair.v[0] = {vx, vy, 0};
  pair.gravity = {0, 0, -9.81};
  if (!pair.approach(1.2, .02)) return -1;
  const double dt = std::numbers::pi / std::sqrt(k) / steps_per_contact;
  double largest = 0;
  for (double time = 0; time < until; time += dt) {
    pair.step(dt);
    if (time < 5) {
      pair.v[0] *= 1 - 3 * dt;
      pair.L[0] *= 1 - 3 * dt;
    }
    if (time >= from) largest = std::max(largest, pair.kinetic_energy(0));
  }
  return pair.body[0].x.z > -1 ? largest : -1;
}

}  // namespace scree::test
