// Statistics against closed forms: lattices, two bodies, uniform random points, forces that were put there.
#include "post/statistics/statistics.hpp"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <sstream>

#include "post/run/apparatus.hpp"
#include "post/run/choice.hpp"
#include "post/statistics/bed.hpp"
#include "post/statistics/space_measures.hpp"
#include "post/statistics/volume_samples.hpp"
#include "tests/post/sample_run.hpp"
#include "tests/support/shapes.hpp"

namespace scree {
namespace {

constexpr double kPi = std::numbers::pi;

/// Balls of one size in a box, by hand.
struct Packing {
  scree::Run run;
  Frame frame;

  Packing(double radius, const Vec3& lower, const Vec3& upper, const Vec3& gravity) {
    Scene& scene = run.scene;
    scene.settings.gravity = gravity;
    scene.materials = {{"rock", 2000, 0, 0}, {"glass", 1000, 0, 0}};
    scene.shapes = {make_sphere("ball", radius), make_solid("box", box_mesh({radius, 2 * radius, 3 * radius}))};
    Wall box;
    box.kind = WallKind::box_inside;
    box.id = 1000000;
    box.lower = lower;
    box.upper = upper;
    scene.walls = {box};
    run.boundary_ids = {box.id};
    frame.walls.id = {box.id};
    frame.walls.position = {Vec3{}};
    frame.walls.orientation = {Quat{}};
    frame.walls.force = {Vec3{}};
    frame.walls.torque = {Vec3{}};
  }
  void add(const Vec3& position, const Vec3& velocity = {}, std::int32_t material = 0, std::int32_t shape = 0, double scale = 1) {
    FrameBodies& b = frame.bodies;
    b.id.push_back(static_cast<std::int64_t>(b.id.size()));
    b.shape.push_back(shape);
    b.material.push_back(material);
    b.rank.push_back(0);
    b.scale.push_back(scale);
    b.position.push_back(position);
    b.orientation.push_back({});
    b.velocity.push_back(velocity);
    b.angular_velocity.push_back({});
    run.scene.bodies.add({b.id.back(), shape, material, scale, position, {}, velocity, {}});
  }
  void contact(std::int64_t a, std::int64_t b, const Vec3& point, const Vec3& normal, double normal_force, const Vec3& tangential = {}) {
    test::add_contact(frame, a, b, 0, normal, normal_force);
    frame.contacts.point.back() = point;
    frame.contacts.tangential_force.back() = tangential;
  }
  /// n^3 balls on a cubic lattice that fill the box from (0, 0, 0), each pressing on its neighbours and on the walls with `force`.
  void fill_lattice(int n, double diameter, const Vec3& force) {
    for (int z = 0; z < n; ++z) {
      for (int y = 0; y < n; ++y) {
        for (int x = 0; x < n; ++x) add(diameter * Vec3{x + 0.5, y + 0.5, z + 0.5});
      }
    }
    const int stride[3] = {1, n, n * n};
    for (int i = 0; i < n * n * n; ++i) {
      const int place[3] = {i % n, i / n % n, i / n / n};
      const Vec3 x = frame.bodies.position[static_cast<std::size_t>(i)];
      for (int k = 0; k < 3; ++k) {
        Vec3 e;
        e[k] = 1;
        if (place[k] + 1 < n) contact(i, i + stride[k], x + (0.5 * diameter) * e, -e, force[k]);
      }
      for (int k = 0; k < 3; ++k) {
        Vec3 e;
        e[k] = 1;
        if (place[k] == 0) contact(i, 1000000, x - (0.5 * diameter) * e, e, force[k]);
        if (place[k] == n - 1) contact(i, 1000000, x + (0.5 * diameter) * e, -e, force[k]);
      }
    }
  }
};

double trace(const Mat3& m) { return m[0].x + m[1].y + m[2].z; }

TEST(ContactMeasures, a_cubic_lattice_has_the_neighbours_and_the_stress_of_its_walls) {
  constexpr int n = 6;
  constexpr double d = 0.1;
  const Vec3 force{1, 2, 4};
  Packing p(d / 2, {0, 0, 0}, {n * d, n * d, n * d}, {0, 0, 0});
  p.fill_lattice(n, d, force);
  const SceneFacts facts(p.run, std::nullopt, p.frame);
  const FrameView view(facts, p.frame);
  const ContactMeasures m = contact_measures(view, {}, std::pow(n * d, 3));
  // six, but the box is one wall: a ball in an edge (12 (n-2)) has one neighbour less for it, in a corner (8) two
  EXPECT_DOUBLE_EQ(m.coordination, 6.0 - (12.0 * (n - 2) + 8 * 2) / (n * n * n));
  EXPECT_EQ(m.rattlers, 0);
  EXPECT_DOUBLE_EQ(m.fabric[0].x, 1.0 / 3);  // as many contacts along each axis
  EXPECT_NEAR(m.fabric_anisotropy, 0, 1e-12);
  EXPECT_DOUBLE_EQ(m.force_fabric[2].z, 4.0 / 7);
  EXPECT_NEAR(trace(m.fabric), 1, 1e-14);
  EXPECT_NEAR(trace(m.force_fabric), 1, 1e-14);
  // n^2 forces on each side over its area, which is what a gauge in the wall shows
  for (int k = 0; k < 3; ++k) {
    EXPECT_NEAR(m.stress[k][k], n * n * force[k] / (n * d * n * d), 1e-9 * m.stress[k][k]);
    EXPECT_NEAR(m.stress[k][(k + 1) % 3], 0, 1e-12 * m.pressure);
  }
  // half of the box, cut through the middle of the balls: the same stress
  const Region half = parse_region("half=box:0,0,0,0.6,0.6,0.25");
  const ContactMeasures lower = contact_measures(view, {"half", &half, -1, -1}, half.volume());
  EXPECT_NEAR(lower.stress[2].z, m.stress[2].z, 1e-9 * m.stress[2].z);
  EXPECT_NEAR(lower.stress[0].x, m.stress[0].x * 36.0 / 30, 0.2 * m.stress[0].x) << "rows of balls are cut through their contacts along x";
}

// A container whose wall has moved is measured where the wall is in the frame, and not where it was at the start of the run.
TEST(Container, is_where_its_wall_is_in_the_frame) {
  constexpr int n = 4;
  constexpr double d = 0.1;
  const double balls = n * n * n * std::numbers::pi * d * d * d / 6, room = std::pow(n * d, 3);
  Packing p(d / 2, {0, 0, 0}, {n * d, n * d, n * d}, {0, 0, 0});
  p.fill_lattice(n, d, {1, 1, 1});
  const auto fraction = [&] {
    const SceneFacts facts(p.run, std::nullopt, p.frame);
    const FrameView view(facts, p.frame);
    const Profile profile_x = profile(view, {'x', 0, n * d, 1});
    EXPECT_NEAR(view.room_between(0, n * d), room, 1e-12 * room);
    return profile_x.solid_fraction[0];
  };
  const double at_rest = fraction();
  EXPECT_NEAR(at_rest, balls / room, 0.06);  // of the heights that hold 10 % to 90 % of the solid
  const Vec3 away{0, n * d, 0};
  for (Vec3& x : p.frame.bodies.position) x += away;
  p.frame.walls.id = {p.run.scene.walls.at(0).id};
  p.frame.walls.position = {away};
  p.frame.walls.orientation = {Quat{}};
  EXPECT_NEAR(fraction(), at_rest, 1e-9);
  const SceneFacts facts(p.run, std::nullopt, p.frame);
  EXPECT_TRUE(FrameView(facts, p.frame).facts.container.holds(away + Vec3{d, d, d}));
  EXPECT_FALSE(FrameView(facts, p.frame).facts.container.holds({d, d, d}));
  // a container that was asked for stays where it was asked for
  const SceneFacts given(p.run, parse_region("given=box:0,0,0,0.4,0.4,0.4"), p.frame);
  EXPECT_TRUE(FrameView(given, p.frame).facts.container.holds({d, d, d}));
  // a box that turns has no room along the axes
  p.frame.walls.orientation = {Quat{std::sqrt(0.5), 0, 0, std::sqrt(0.5)}};
  EXPECT_TRUE(is_turned_box(facts, p.frame));
  EXPECT_TRUE(FrameView(facts, p.frame).facts.container.holds({d, d, d}));
}

TEST(Container, a_tube_that_was_lifted_and_tilted_is_measured_where_it_is) {
  Packing p(0.05, {0, 0, 0}, {1, 1, 1}, {0, 0, 0});
  Wall& tube = p.run.scene.walls.at(0);
  tube.kind = WallKind::cylinder_inside;
  tube.axis_start = {0, 0, 0};
  tube.axis_end = {0, 0, 1};
  tube.radius = 0.3;
  p.add({0, 0, 0.5});
  p.frame.walls.id = {tube.id};
  p.frame.walls.position = {{2, 0, 0.5}};
  p.frame.walls.orientation = {Quat{std::sqrt(0.5), 0, std::sqrt(0.5), 0}};  // z to x
  const SceneFacts facts(p.run, std::nullopt, p.frame);
  const FrameView view(facts, p.frame);
  const Container& c = view.facts.container;
  EXPECT_NEAR(length(c.room.lower - Vec3{2, 0, 0.5}), 0, 1e-12);
  EXPECT_NEAR(length(c.room.upper - Vec3{3, 0, 0.5}), 0, 1e-12);
  EXPECT_TRUE(c.holds({2.9, 0.2, 0.5}));
  EXPECT_FALSE(c.holds({0, 0, 0.5}));
  // turned about its own axis it is where it was
  p.frame.walls.position = {{0, 0, 0}};
  p.frame.walls.orientation = {Quat{std::cos(0.4), 0, 0, std::sin(0.4)}};
  EXPECT_EQ(FrameView(facts, p.frame).of_frame, nullptr);
}

TEST(ContactMeasures, materials_share_the_stress_between_them) {
  Packing p(0.05, {0, 0, 0}, {0.2, 0.2, 0.2}, {0, 0, 0});
  p.fill_lattice(2, 0.1, {3, 2, 1});
  for (std::size_t i = 0; i < 4; ++i) p.frame.bodies.material[i] = 1;
  const SceneFacts facts(p.run, std::nullopt, p.frame);
  const FrameView view(facts, p.frame);
  const ContactMeasures all = contact_measures(view, {}, 1), rock = contact_measures(view, {"rock", nullptr, 0, -1}, 1),
                        glass = contact_measures(view, {"glass", nullptr, 1, -1}, 1);
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(rock.stress[k][k] + glass.stress[k][k], all.stress[k][k], 1e-12);
  EXPECT_NEAR(rock.stress[0].x, glass.stress[0].x, 1e-12);
}

TEST(ContactMeasures, two_bodies_have_the_stress_of_force_times_branch) {
  Packing p(0.5, {0, 0, 0}, {4, 4, 4}, {0, 0, 0});
  p.add({1, 1, 1});
  p.add({2, 1, 1});
  p.contact(0, 1, {1.5, 1, 1}, {-1, 0, 0}, 3, {0, 2, 0});
  const SceneFacts facts(p.run, std::nullopt, p.frame);
  const FrameView view(facts, p.frame);
  const ContactMeasures m = contact_measures(view, {}, 2);
  EXPECT_DOUBLE_EQ(m.stress[0].x, 1.5);  // (-3) * (1 - 2) / 2
  EXPECT_DOUBLE_EQ(m.stress[1].x, -1);   // 2 * (1 - 2) / 2
  EXPECT_DOUBLE_EQ(m.pressure, 0.5);
  EXPECT_DOUBLE_EQ(m.normal_force, 3);
  EXPECT_DOUBLE_EQ(m.tangential_force, 2);
  EXPECT_DOUBLE_EQ(m.coordination, 1);
  EXPECT_DOUBLE_EQ(m.rattlers, 1);
  // deviator of diag(1.5, 0, 0) with shear 0.5 (half of -1 twice): s:s = 1.5 + 0.5
  EXPECT_NEAR(m.deviatoric_stress, std::sqrt(1.5 * 2.0), 1e-12);
}

TEST(ContactMeasures, contacts_that_pull_are_counted_and_take_from_the_pressure) {
  Packing p(0.5, {0, 0, 0}, {4, 4, 4}, {0, 0, 0});
  p.add({1, 1, 1});
  p.add({2, 1, 1});
  p.add({3, 1, 1});
  p.contact(0, 1, {1.5, 1, 1}, {-1, 0, 0}, 3);
  p.contact(1, 2, {2.5, 1, 1}, {-1, 0, 0}, -1.2);
  const SceneFacts facts(p.run, std::nullopt, p.frame);
  const FrameView view(facts, p.frame);
  const ContactMeasures m = contact_measures(view, {}, 2);
  EXPECT_DOUBLE_EQ(m.tensile, 0.5);
  EXPECT_DOUBLE_EQ(m.tensile_force, 1.2);
  EXPECT_DOUBLE_EQ(m.normal_force, 0.9);
  EXPECT_DOUBLE_EQ(m.stress[0].x, 0.9);  // (3 - 1.2) / 2
  EXPECT_DOUBLE_EQ(m.pressure, 0.3);
  EXPECT_DOUBLE_EQ(m.cohesive_pressure, 0.2);  // 1.2 / 2 / 3
  EXPECT_DOUBLE_EQ(m.coordination, 4.0 / 3);
}

TEST(ContactMeasures, the_stress_passes_through_a_periodic_side) {
  Packing p(0.5, {0, 0, 0}, {4, 4, 4}, {0, 0, 0});
  Domain& domain = p.run.scene.settings.domain;
  domain.bounded = true;
  domain.upper = {4, 4, 4};
  domain.periodic = {true, false, false};
  p.add({0.2, 1, 1});
  p.add({3.3, 1, 1});
  p.contact(0, 1, {3.8, 1, 1}, {1, 0, 0}, 5);
  const SceneFacts facts(p.run, std::nullopt, p.frame);
  EXPECT_DOUBLE_EQ(contact_measures(FrameView(facts, p.frame), {}, 1).stress[0].x, 5 * 0.9);
}

TEST(ContactMeasures, a_lid_on_a_packing_is_apparatus_and_stresses_it_as_a_wall) {
  constexpr int n = 4;
  Packing p(0.5, {0, 0, 0}, {n, n, n}, {0, 0, -9.81});
  p.fill_lattice(n, 1, {0, 0, 3});
  for (std::int32_t& population : p.run.scene.bodies.population) population = 0;
  const SceneFacts before(p.run, std::nullopt, p.frame);
  const FrameView packing(before, p.frame);
  const double height = packing.highest, stress = contact_measures(packing, {}, packing.room_between(0, height)).stress[2].z;
  EXPECT_NEAR(stress, 3, 1e-12);  // 3 N on each square metre

  // a plate of [[bodies]] in the place of the upper wall, squeezed from above
  const std::int64_t lid = static_cast<std::int64_t>(p.frame.bodies.size());
  for (std::size_t i = 0; i < p.frame.contacts.size(); ++i) {
    if (p.frame.contacts.body_b[i] == 1000000 && p.frame.contacts.normal[i].z < 0) p.frame.contacts.body_b[i] = lid;
  }
  p.run.scene.shapes.push_back(make_solid("plate", box_mesh({n, n, 2})));
  p.add({n / 2.0, n / 2.0, n + 1}, {}, 1, 2);
  p.contact(lid, 1000000, {n / 2.0, n / 2.0, n + 2}, {0, 0, -1}, 48);
  scree::Run run = p.run;
  EXPECT_NE(set_apparatus_apart(run, {}), "") << "as large as the packing";
  for (scree::Run* chosen : {&run, &p.run}) {
    if (chosen == &p.run) {
      EXPECT_NE(set_apparatus_apart(*chosen, {"plate"}).find("64 (plate)"), std::string::npos);
    }
    const SceneFacts facts(*chosen, std::nullopt, p.frame);
    const FrameView view(facts, p.frame);
    EXPECT_EQ(view.particles, 64u);
    EXPECT_DOUBLE_EQ(view.highest, height);
    EXPECT_DOUBLE_EQ(contact_measures(view, {}, view.room_between(0, view.highest)).stress[2].z, stress);
  }
  EXPECT_THROW(set_apparatus_apart(run, {"lid"}), UsageError);
}

TEST(ContactMeasures, the_anisotropy_of_a_known_distribution_comes_back) {
  // normals with density (1 + a P(n)) / 4 pi, A = diag(-a/2, -a/2, a): by weights on a fine grid of the sphere, carried by forces
  constexpr double a = 0.6;
  Mat3 fabric;
  double total = 0;
  for (int i = 0; i < 1000; ++i) {
    const double z = -1 + (i + 0.5) / 500, r = std::sqrt(1 - z * z);
    for (int j = 0; j < 8; ++j) {
      const Vec3 normal{r * std::cos(kPi * j / 4), r * std::sin(kPi * j / 4), z};
      const double weight = 1 + a * (1.5 * z * z - 0.5);
      for (int k = 0; k < 3; ++k) fabric[k] += weight * normal[k] * normal;
      total += weight;
    }
  }
  for (int k = 0; k < 3; ++k) fabric[k] *= 1 / total;
  EXPECT_NEAR(anisotropy(fabric), 1.5 * a, 1e-4);  // sqrt(3/2 A:A) = sqrt(3/2 * 3/2) a
}

TEST(ForceChains, a_loaded_column_is_a_chain_and_its_weak_neighbours_are_not) {
  Packing p(0.5, {0, 0, 0}, {9, 9, 9}, {0, 0, 0});
  for (int z = 0; z < 5; ++z) p.add({1, 1, 1.0 + z});
  for (int z = 0; z < 5; ++z) p.add({2, 1, 1.0 + z});
  for (int z = 0; z < 4; ++z) {
    p.contact(z, z + 1, {1, 1, 1.5 + z}, {0, 0, -1}, 100);
    p.contact(z, z + 5, {1.5, 1, 1.0 + z}, {-1, 0, 0}, 1);
  }
  const SceneFacts facts(p.run, std::nullopt, p.frame);
  const ForceChains chains = force_chains(FrameView(facts, p.frame));
  ASSERT_EQ(chains.chains.size(), 1u);
  EXPECT_EQ(chains.chains[0], (std::vector<std::int64_t>{0, 1, 2, 3, 4}));
  EXPECT_EQ(chains.members, 5u);
}

TEST(ForceDistribution, densities_of_exponential_forces_are_those_of_the_exponential) {
  Packing p(0.5, {0, 0, 0}, {9, 9, 9}, {0, 0, 0});
  p.add({1, 1, 1});
  p.add({2, 1, 1});
  constexpr int n = 20000;
  for (int i = 0; i < n; ++i) p.contact(0, 1, {}, {1, 0, 0}, -3 * std::log((i + 0.5) / n));  // quantiles of the exponential of mean 3
  const SceneFacts facts(p.run, std::nullopt, p.frame);
  const ForceDistribution d = force_distribution(FrameView(facts, p.frame), 16, 8);
  for (std::size_t k = 0; k < 12; ++k) {
    const double low = 0.5 * static_cast<double>(k), expected = (std::exp(-low) - std::exp(-low - 0.5)) / 0.5;
    EXPECT_NEAR(d.normal[k], expected, 0.02 * expected + 2.0 / n) << k;
  }
}

TEST(VolumeSamples, they_have_the_volume_of_any_part_of_a_ball_and_of_a_box) {
  const Shape ball = make_sphere("ball", 1);
  const std::vector<Vec3> points = volume_samples(ball, 2000);
  EXPECT_NEAR(static_cast<double>(points.size()), 2000, 100);
  constexpr double cap = 0.5;  // above z = 1/2: (2 + 1/2) (1/2)^2 pi / 3 over 4 pi / 3 = 5 / 32
  EXPECT_NEAR(static_cast<double>(std::count_if(points.begin(), points.end(), [](const Vec3& q) { return q.z > cap; })) /
                  static_cast<double>(points.size()),
              5.0 / 32, 0.01);
  const std::vector<Vec3> inside = volume_samples(make_solid("box", box_mesh({1, 2, 3})), 2000);
  for (const Vec3& q : inside) {
    EXPECT_LE(std::abs(q.x), 0.55);
    EXPECT_LE(std::abs(q.z), 1.55);
  }
  EXPECT_NEAR(static_cast<double>(std::count_if(inside.begin(), inside.end(), [](const Vec3& q) { return q.z > 0.75; })) /
                  static_cast<double>(inside.size()),
              0.25, 0.02);
}

TEST(VolumeSamples, thin_walls_have_their_share_whatever_way_they_stand) {
  // a square tube without ends, its walls 1/200 of its width: each wall is a quarter of the volume, each half of the height a half
  constexpr double outer = 1, inner = 0.99;
  const TriangleMesh diamond = test::revolved({{inner, -1}, {outer, -1}, {outer, 1}, {inner, 1}, {inner, -1}}, 4);
  for (const double turn : {0.0, 0.1, kPi / 4, 1.0}) {
    for (const bool lies : {false, true}) {
      TriangleMesh tube = diamond;
      for (Vec3& v : tube.vertices) {
        v = {std::cos(turn) * v.x - std::sin(turn) * v.y, std::sin(turn) * v.x + std::cos(turn) * v.y, v.z};
        if (lies) v = {v.z, v.x, v.y};
      }
      Shape shape = make_solid("tube", tube);
      shape.mesh = tube;  // where it was drawn: its centre is there, and its axes need not be the principal ones
      std::array<double, 4> walls{};
      double above = 0;
      const std::vector<Vec3> points = volume_samples(shape, 2000);
      for (const Vec3& p : points) {
        const Vec3 q = lies ? Vec3{p.y, p.z, p.x} : p;
        const double angle = std::atan2(q.y, q.x) - turn + 4 * kPi;
        walls[static_cast<std::size_t>(std::fmod(angle, 2 * kPi) / (kPi / 2)) % 4] += 1;
        above += q.z > 0 ? 1 : 0;
      }
      const double all = static_cast<double>(points.size());
      EXPECT_NEAR(all, 2000, 100);
      for (const double share : walls) EXPECT_NEAR(share / all, 0.25, 0.02) << turn << ' ' << lies;
      EXPECT_NEAR(above / all, 0.5, 0.02) << turn << ' ' << lies;
    }
  }
}

TEST(SpaceMeasures, a_cubic_lattice_fills_pi_over_six_of_bed_region_and_every_layer_by_the_balls_section) {
  constexpr int n = 10;  // so that 10 % of the solid is one layer
  Packing p(0.5, {0, 0, 0}, {n, n, n}, {0, 0, -9.81});
  p.fill_lattice(n, 1, {1, 1, 1});
  const SceneFacts facts(p.run, std::nullopt, p.frame);
  const FrameView view(facts, p.frame);
  EXPECT_DOUBLE_EQ(view.lowest, 0);
  EXPECT_DOUBLE_EQ(view.highest, n);
  EXPECT_NEAR(bed_solid(view).fraction, kPi / 6, 0.01);
  EXPECT_NEAR(region_solid_fraction(view, parse_region("box:1,1,1,6,6,6")), kPi / 6, 0.005);
  const Profile layers = profile(view, {'z', 0, n, 4 * n});
  for (std::size_t k = 0; k < layers.solid_fraction.size(); ++k) {
    // a quarter of a ball's height: outer quarter pi h^2 (3 R - h) / 3 with h = 1/4, R = 1/2, inner the rest of the half
    const double outer = kPi * (1.0 / 16) * (1.5 - 0.25) / 3, inner = kPi / 12 - outer;
    const double expected = (k % 4 == 0 || k % 4 == 3 ? outer : inner) / 0.25;
    EXPECT_NEAR(layers.solid_fraction[k], expected, 0.03) << k;
  }
  EXPECT_EQ(layers.particles[1] + layers.particles[2], n * n);  // the centres lie at the height of the middle of a ball
}

/// Makes the container of a packing a cylinder.
void put_into_cylinder(Packing& p, const Vec3& start, const Vec3& end, double radius) {
  Wall& wall = p.run.scene.walls[0];
  wall.kind = WallKind::cylinder_inside;
  wall.axis_start = start;
  wall.axis_end = end;
  wall.radius = radius;
}

/// Share of a unit disc below the height h above its middle.
double disc_below(double h) { return h <= -1 ? 0 : h >= 1 ? 1 : (kPi / 2 + std::asin(h) + h * std::sqrt(1 - h * h)) / kPi; }

TEST(Region, the_volume_of_its_part_in_a_box_is_the_closed_form_whatever_way_it_lies) {
  const double whole = kPi * 0.3 * 0.3 * 1.4;
  for (int axis = 0; axis < 3; ++axis) {
    Region cylinder;
    cylinder.kind = Region::Kind::cylinder;
    cylinder.radius = 0.3;
    cylinder.upper[axis] = 1.4;
    const Box3 all = cylinder.bounds();
    for (int across = 0; across < 3; ++across) {
      for (const double share : {0.1, 0.5, 0.77, 1.0}) {
        Box3 box = all;
        box.upper[across] = all.lower[across] + share * all.extent()[across];
        const double expected = across == axis ? share * whole : whole * disc_below(2 * share - 1);
        EXPECT_NEAR(cylinder.volume_in(box), expected, 1e-4 * whole) << axis << across << share;  // 3e-5 with 128 lines
      }
    }
  }
  const Region ball = parse_region("sphere:0,0,0,1");
  Box3 cap = ball.bounds();
  cap.lower.x = 0.5;
  EXPECT_NEAR(ball.volume_in(cap), ball.volume() * 5 / 32, 1e-4 * ball.volume());
  const Region box = parse_region("box:0,0,0,1,2,3");
  EXPECT_DOUBLE_EQ(box.volume_in(parse_region("box:0.5,-1,1,9,1,2").bounds()), 0.5);
  EXPECT_EQ(box.volume_in(parse_region("box:2,0,0,3,1,1").bounds()), 0);

  // one that leans, in a box that cuts its side and an end: against points at random
  const Region leaning = parse_region("cylinder:0,0,0,1,2,3,0.8");
  const Region part = parse_region("box:-0.2,0.3,0.1,1.1,1.4,3.3");
  std::mt19937_64 generator(11);
  std::uniform_real_distribution<double> place(0, 1);
  constexpr int kPoints = 1000000;
  int inside = 0;
  for (int i = 0; i < kPoints; ++i) {
    const Vec3 e = part.upper - part.lower;
    inside += leaning.contains(part.lower + Vec3{e.x * place(generator), e.y * place(generator), e.z * place(generator)}) ? 1 : 0;
  }
  const double share = static_cast<double>(inside) / kPoints, sigma = std::sqrt(share * (1 - share) / kPoints);
  EXPECT_NEAR(leaning.volume_in(part.bounds()) / part.volume(), share, 4 * sigma);
}

TEST(SpaceMeasures, a_drum_that_lies_is_filled_as_its_lattice_in_layers_rings_and_bed) {
  // small balls on a cubic lattice fill a lying drum up to a level, or up to a slope of 30 degrees
  constexpr double d = 0.04, radius = 1, length = 0.8;
  for (const double slope : {0.0, std::tan(kPi / 6)}) {
    Packing p(d / 2, {}, {}, {0, 0, -9.81});
    put_into_cylinder(p, {0, 0, 0}, {0, length, 0}, radius);
    for (int i = -25; i < 25; ++i) {
      for (int k = -25; k < 25; ++k) {
        const double x = (i + 0.5) * d, z = (k + 0.5) * d;
        if (std::hypot(x, z) > radius - d / 2 || z > -0.2 + slope * x) continue;
        for (int j = 0; j < 20; ++j) p.add({x, (j + 0.5) * d, z});
      }
    }
    const SceneFacts facts(p.run, std::nullopt, p.frame);
    const FrameView view(facts, p.frame);
    const BedSolid bed = bed_solid(view);
    EXPECT_NEAR(bed.fraction, kPi / 6, 0.02) << slope;
    const double bodies = view.particle_volume / (kPi * length);
    EXPECT_NEAR(bed.of_container, bodies / (disc_below(view.highest) - disc_below(view.lowest)), 1e-3) << slope;
    if (slope > 0) continue;
    const Profile layers = profile(view, {'z', -1, -0.2, 10});
    for (std::size_t k = 1; k < 10; ++k)
      EXPECT_NEAR(layers.solid_fraction[k], kPi / 6, 0.05)
          << k;  // half a ball and a step of the lattice are empty at either end of a chord of 1 to 2
    const Profile sides = profile(view, {'x', -0.6, 0.6, 6});
    for (std::size_t k = 0; k < 6; ++k) EXPECT_NEAR(sides.solid_fraction[k], kPi / 6, 0.04) << k;
    const Profile rings = profile(view, {'r', 0.4, 1, 3});  // where the lattice is, between the heights of the bed
    for (std::size_t k = 0; k < 3; ++k) EXPECT_GT(rings.solid_fraction[k], 0.4) << k;
    for (std::size_t k = 0; k < 3; ++k) EXPECT_LT(rings.solid_fraction[k], kPi / 6 + 0.04) << k;
  }
}

TEST(SpaceMeasures, what_lies_across_a_periodic_side_counts_on_both) {
  Packing p(0.5, {0, 0, 0}, {4, 4, 4}, {0, 0, -9.81});
  Domain& domain = p.run.scene.settings.domain;
  domain.bounded = true;
  domain.upper = {4, 4, 4};
  domain.periodic = {true, true, false};
  for (int x = 0; x < 4; ++x) {
    for (int y = 0; y < 4; ++y) {
      for (int z = 0; z < 4; ++z) p.add({static_cast<double>(x), static_cast<double>(y), z + 0.5});  // centres on the sides
    }
  }
  const double ball = 4 * kPi / 3 / 8;
  // contacts on the side of the cell, and beyond it as one of the two bodies sees it
  p.contact(0, 48, {-0.5, 0, 0.5}, {1, 0, 0}, 1);
  const SceneFacts facts(p.run, std::nullopt, p.frame);
  const FrameView view(facts, p.frame);
  const Profile layers = profile(view, {'x', 0, 4, 4});
  for (const double fraction : layers.solid_fraction) EXPECT_NEAR(fraction, kPi / 6, 0.03);
  // the cap of a ball beyond a quarter of its diameter is 5 / 32 of it; half a ball lies on either side of a seam
  EXPECT_NEAR(region_solid_fraction(view, parse_region("box:0,0,0,0.25,4,4")), 16 * ball * (0.5 - 5.0 / 32) / 4,
              0.03);  // a quarter of a body: 4 %
  EXPECT_NEAR(region_solid_fraction(view, parse_region("box:3.75,0,0,4,4,4")), 16 * ball * (0.5 - 5.0 / 32) / 4, 0.03);
  for (const char* text : {"box:-1,0,0,1,4,4", "box:3,0,0,5,4,4", "box:7.5,-2,0,8.5,2,4", "box:-4,0,0,4,4,4"}) {  // any image of the cell
    EXPECT_NEAR(region_solid_fraction(view, parse_region(text)), kPi / 6, 0.01) << text;
  }
  const Region seam = parse_region("ball=sphere:4,4,1.5,0.5");
  EXPECT_NEAR(region_solid_fraction(view, seam), 1, 0.01);
  EXPECT_EQ(motion_measures(view, {"seam", &seam, -1, -1}).particles, 1);
  const Region beyond = parse_region("box:3.25,-0.25,0,3.75,0.25,1");
  EXPECT_TRUE((Group{"beyond", &beyond, -1, -1}.holds_contact(view, 0)));
  EXPECT_NEAR(bed_solid(view).fraction, kPi / 6, 0.03);
  // along a periodic axis a box is no longer than the cell
  const Region all = facts.within_a_period(parse_region("box:-1000,3,-1,1000,9,2"));
  EXPECT_EQ(all.lower, (Vec3{0, 0, -1}));
  EXPECT_EQ(all.upper, (Vec3{4, 4, 2}));
  EXPECT_EQ(facts.within_a_period(beyond).lower, beyond.lower);
}

TEST(SpaceMeasures, the_temperature_of_a_layer_does_not_see_the_shear) {
  Packing p(0.05, {0, 0, 0}, {1, 1, 1}, {0, 0, -9.81});
  // velocity 2 z along x, and +-0.3 along y in turn: T = 0.09 / 3 in a layer, plus the shear's 4 var(z) / 3 in the whole
  double z_square = 0;
  for (int z = 0; z < 10; ++z) {
    for (int i = 0; i < 20; ++i) {
      p.add({0.05 * i + 0.025, 0.5, 0.1 * z + 0.05}, {2 * (0.1 * z + 0.05), i % 2 == 0 ? 0.3 : -0.3, 0});
      z_square += std::pow(0.1 * z + 0.05 - 0.5, 2) / 200;
    }
  }
  const SceneFacts facts(p.run, std::nullopt, p.frame);
  const FrameView view(facts, p.frame);
  const Profile layers = profile(view, {'z', 0, 1, 10});
  for (std::size_t k = 0; k < 10; ++k) {
    EXPECT_NEAR(layers.granular_temperature[k], 0.03, 1e-12);
    EXPECT_NEAR(layers.velocity[k].x, 2 * (0.1 * static_cast<double>(k) + 0.05), 1e-12);
  }
  const MotionMeasures whole = motion_measures(view, {});
  EXPECT_NEAR(whole.granular_temperature, 0.03 + 4 * z_square / 3, 1e-12);
  EXPECT_NEAR(whole.mass, 200 * 2000 * 4 * kPi / 3 * 1.25e-4, 1e-9);
}

TEST(SpaceMeasures, uniform_random_points_have_a_pair_correlation_of_one) {
  for (const bool periodic : {false, true}) {
    Packing p(0.01, {0, 0, 0}, {1, 1, 1}, {0, 0, 0});
    p.run.scene.settings.domain.bounded = periodic;
    p.run.scene.settings.domain.upper = {1, 1, 1};
    p.run.scene.settings.domain.periodic = {periodic, periodic, periodic};
    std::mt19937_64 generator(5);
    std::uniform_real_distribution<double> place(0, 1);
    for (int i = 0; i < 6000; ++i) p.add({place(generator), place(generator), place(generator)});
    const SceneFacts facts(p.run, std::nullopt, p.frame);
    const std::vector<double> g = pair_correlation(FrameView(facts, p.frame), 10, 0.3);
    for (std::size_t s = 2; s < g.size(); ++s) EXPECT_NEAR(g[s], 1, 0.03) << s << " periodic " << periodic;  // 4e4 pairs and more in each
  }
}

TEST(SpaceMeasures, the_pair_correlation_of_a_lattice_holds_six_twelve_and_eight_neighbours) {
  constexpr int n = 10;
  Packing p(0.5, {0, 0, 0}, {n, n, n}, {0, 0, 0});
  Domain& domain = p.run.scene.settings.domain;
  domain.bounded = true;
  domain.upper = {n, n, n};
  domain.periodic = {true, true, true};
  p.fill_lattice(n, 1, {1, 1, 1});
  const SceneFacts facts(p.run, std::nullopt, p.frame);
  const std::vector<double> g = pair_correlation(FrameView(facts, p.frame), 19, 1.9);
  const auto neighbours = [&](std::size_t s) {  // density n^3 / V = 1, estimated from pairs: (n^3 - 1) / n^3
    const double low = 0.1 * static_cast<double>(s), high = low + 0.1;
    return g[s] * 4.0 / 3 * kPi * (high * high * high - low * low * low) * (n * n * n - 1) / (n * n * n);
  };
  EXPECT_NEAR(neighbours(10) + neighbours(9), 6, 1e-9);
  EXPECT_NEAR(neighbours(14), 12, 1e-9);  // at 1.414
  EXPECT_NEAR(neighbours(17), 8, 1e-9);   // at 1.732
  EXPECT_EQ(g[5], 0);
}

TEST(SpaceMeasures, halves_that_lie_apart_have_index_zero_and_random_kinds_one) {
  Packing p(0.05, {0, 0, 0}, {1, 1, 1}, {0, 0, 0});
  p.fill_lattice(16, 0.0625, {1, 1, 1});
  const SceneFacts facts(p.run, std::nullopt, p.frame);
  const FrameView view(facts, p.frame);
  std::vector<std::uint8_t> apart, random;
  std::mt19937_64 generator(3);
  for (std::size_t i = 0; i < p.frame.bodies.size(); ++i) {
    apart.push_back(p.frame.bodies.position[i].x > 0.5 ? 1 : 0);
    random.push_back(generator() % 2);
  }
  EXPECT_LT(mixing_index(view, apart), 0.2) << "of seven layers of cells only the one that the border cuts is mixed";
  EXPECT_NEAR(mixing_index(view, random), 1, 0.02);
  // a cube: halves along any axis lie apart alike
  EXPECT_DOUBLE_EQ(mixing_index_apart(view, apart), mixing_index(view, apart));
  EXPECT_LT(mixing_index_apart(view, random), 0.2) << "their own places do not matter";
  EXPECT_TRUE(std::isnan(mixing_index_apart(view, std::vector<std::uint8_t>(random.size(), 1)))) << "one kind";
}

TEST(SpaceMeasures, a_heap_and_a_slope_have_the_angle_they_were_built_with) {
  constexpr double degrees = 30;
  const double slope = std::tan(degrees * kPi / 180);
  Packing cone(0.01, {-1, -1, 0}, {1, 1, 1}, {0, 0, -9.81}), plane(0.01, {-1, -1, 0}, {1, 1, 2}, {0, 0, -9.81});
  for (double x = -0.95; x < 1; x += 0.02) {
    for (double y = -0.95; y < 1; y += 0.02) {
      const double height = slope * (0.9 - std::hypot(x, y));
      if (height > 0) cone.add({x, y, height});  // the surface is all that counts
      plane.add({x, y, slope * (0.6 * x + 0.8 * y + 1)});
    }
  }
  const SceneFacts cone_facts(cone.run, std::nullopt, cone.frame), plane_facts(plane.run, std::nullopt, plane.frame);
  EXPECT_NEAR(angle_of_repose_cone(FrameView(cone_facts, cone.frame)), degrees, 0.5);
  EXPECT_NEAR(angle_of_repose_slope(FrameView(plane_facts, plane.frame)), degrees, 0.5);
}

TEST(SpaceMeasures, a_column_has_no_angle_and_the_reason_is_given) {
  Packing column(0.01, {-1, -1, 0}, {1, 1, 1}, {0, 0, -9.81}), few(0.01, {-1, -1, 0}, {1, 1, 1}, {0, 0, -9.81});
  for (double x = -0.1; x < 0.1; x += 0.02) {
    for (double y = -0.1; y < 0.1; y += 0.02) column.add({x, y, 0.5}), column.add({x, y, 0.01});
  }
  few.add({0, 0, 0.5});
  const SceneFacts facts(column.run, std::nullopt, column.frame), few_facts(few.run, std::nullopt, few.frame);
  std::string reason;
  EXPECT_TRUE(std::isnan(angle_of_repose_cone(FrameView(facts, column.frame), &reason)));
  EXPECT_NE(reason.find("the sides are too steep (a column)"), std::string::npos) << reason;
  EXPECT_TRUE(std::isnan(angle_of_repose_slope(FrameView(few_facts, few.frame), &reason)));
  EXPECT_NE(reason.find("8 are needed: too few bodies"), std::string::npos) << reason;
}

TEST(BlockAverage, the_interval_of_independent_numbers_is_students) {
  BlockAverage average(1, 4, 2);  // two blocks: means 2 and 6
  for (const double v : {1.0, 3.0, 5.0, 7.0}) average.add({v});
  const Average a = average.of(0);
  EXPECT_EQ(a.mean, 4);
  EXPECT_EQ(a.smallest, 1);
  EXPECT_EQ(a.largest, 7);
  EXPECT_NEAR(a.ci95, 2 * std::tan(0.475 * std::acos(-1.0)), 1e-12);  // s / sqrt(n) = 2; one degree of freedom is Cauchy's distribution
}

TEST(BlockAverage, intervals_hold_the_true_mean_in_ninety_five_of_a_hundred_correlated_series) {
  std::mt19937_64 generator(11);
  std::normal_distribution<double> random(0, 1);
  int held = 0;
  for (int trial = 0; trial < 1000; ++trial) {
    BlockAverage average(1, 2000, 10);
    double x = 0;
    for (int i = 0; i < 2000; ++i) average.add({x = 0.8 * x + random(generator)});  // remembers about five frames
    held += std::abs(average.of(0).mean) <= average.of(0).ci95;
  }
  EXPECT_NEAR(held, 950, 30);  // four standard deviations of the count, and what is left of the correlation
}

// Data of five frames, the last of them a thousandth of an interval after the fourth: the mean over time is that of the four.
TEST(BlockAverage, a_frame_a_few_steps_after_the_last_counts_next_to_nothing) {
  const std::vector<double> weights = frame_weights({0, 1, 2, 3, 3.001});
  EXPECT_NEAR(weights[0], 2 * weights[3], 1e-3);
  EXPECT_NEAR(weights[4], 0, 1e-3);
  EXPECT_EQ(frame_weights({0, 1, 2, 3}), std::vector<double>(4, 0.25)) << "at equal intervals all count alike";
  EXPECT_EQ(frame_weights({7}), std::vector<double>{1});
  EXPECT_EQ(frame_weights({7, 7}), (std::vector<double>{0.5, 0.5}));
  BlockAverage average(1, 5, 2);
  const double values[5] = {1, 1, 1, 1, 1000};
  for (std::size_t i = 0; i < 5; ++i) average.add({values[i]}, weights[i]);
  EXPECT_NEAR(average.of(0).mean, 1, 0.5);
  EXPECT_EQ(average.of(0).largest, 1000);
}

TEST(BlockAverage, what_is_no_number_is_left_out) {
  BlockAverage average(2, 2, 10);
  average.add({1, std::nan("")});
  average.add({std::nan(""), std::nan("")});
  EXPECT_EQ(average.of(0).mean, 1);
  EXPECT_TRUE(std::isnan(average.of(0).ci95));
  EXPECT_EQ(average.of(1).count, 0u);
}

class StatisticsOfARun : public testing::Test {
 protected:
  void SetUp() override {
    folder = std::filesystem::path(SCREE_TEST_FOLDER) / testing::UnitTest::GetInstance()->current_test_info()->name();
    test::write_sample_run(folder / "sample.run");
  }
  std::filesystem::path folder;
};

/// A run on disk of frames of a packing, a second apart.
scree::Run written(const std::filesystem::path& folder, const Packing& p, std::vector<Frame> frames) {
  std::filesystem::create_directories(folder);
  write_scene_file((folder / "scene.h5").string(), p.run.scene);
  std::vector<FrameEntry> entries;
  for (std::size_t f = 0; f < frames.size(); ++f) {
    frames[f].number = static_cast<std::int64_t>(f);
    frames[f].time = static_cast<double>(f);
    entries.push_back({(folder / fmt::format("frame_{:06}.hdf", f)).string(), frames[f].time});
    write_frame_file(MPI_COMM_SELF, entries.back().path, frames[f]);
  }
  write_frame_series(folder.string(), entries);
  return open_run(folder.string());
}

/// Of the first frame, without the bodies of these names.
double mean_without(const scree::Run& run, const std::vector<std::string>& names, const char* quantity) {
  StatisticsOptions options;
  options.frames = {0};
  options.without = ids_left_out(run, names);
  return run_statistics(run, options, "").of(quantity).mean;
}

TEST_F(StatisticsOfARun, kinds_of_the_mixing_index_are_sizes_or_populations) {
  // 512 balls in a cube; the left half is a population, and every other one is smaller
  Packing p(0.05, {0, 0, 0}, {1, 1, 1}, {0, 0, -9.81});
  for (int i = 0; i < 512; ++i)
    p.add(0.125 * Vec3{i % 8 + 0.5, i / 8 % 8 + 0.5, i / 64 + 0.5}, {}, 0, 0, (i % 8 + i / 8 % 8 + i / 64) % 2 == 0 ? 1 : 0.9);
  for (int i = 0; i < 512; ++i) p.run.scene.bodies.population[static_cast<std::size_t>(i)] = i % 8 < 4 ? 0 : 1;
  // the same with the three layers on the left smaller, one layer of cells: the median is one of the large ones
  Packing layers = p;
  for (int i = 0; i < 512; ++i) {
    const double scale = i % 8 < 3 ? 0.9 : 1;
    layers.frame.bodies.scale[static_cast<std::size_t>(i)] = layers.run.scene.bodies.scale[static_cast<std::size_t>(i)] = scale;
  }
  const scree::Run run = written(folder / "even.run", p, {p.frame}), other = written(folder / "layers.run", layers, {layers.frame});
  const auto index = [](const scree::Run& of, const char* kinds) {
    StatisticsOptions options;
    options.frames = {0};
    options.mixing = kinds;
    return run_statistics(of, options, "").of("mixing_index").mean;
  };
  EXPECT_LT(index(run, "population"), 0.3) << "the middle layer of cells is cut";
  EXPECT_GT(index(run, "size"), 0.8);
  EXPECT_NEAR(index(run, "population"), index(run, "half-x"), 1e-12);
  EXPECT_LT(index(other, "size"), 0.05);
}

TEST_F(StatisticsOfARun, the_torque_on_a_wall_that_turns_is_also_told_about_its_own_axis) {
  Packing p(0.05, {0, 0, 0}, {1, 1, 1}, {0, 0, -9.81});
  p.add({0.5, 0.5, 0.5});
  p.run.scene.walls[0].motion.kind = Rotate{{0, 1, 0}, {1, 0, 2}, 3};
  p.frame.walls.force = {Vec3{4, 5, 6}};
  p.frame.walls.torque = {Vec3{7, 8, 9}};
  StatisticsOptions options;
  options.frames = {0};
  const Statistics s = run_statistics(written(folder / "turns.run", p, {p.frame}), options, "");
  for (std::size_t q = 0; q < s.wall_quantities.size(); ++q) {
    // (7, 8, 9) - (1, 0, 2) x (4, 5, 6) along y
    if (s.wall_quantities[q].name == "axis_torque") {
      EXPECT_NEAR(s.wall_averages[0][q].mean, 6, 1e-12);
      return;
    }
  }
  ADD_FAILURE() << "no torque about the axis";
}

TEST_F(StatisticsOfARun, size_classes_that_lie_apart_are_segregated_and_those_that_alternate_are_not) {
  // 512 balls in a cube: three sizes in layers along x, or drawn without regard to the place
  Packing p(0.05, {0, 0, 0}, {1, 1, 1}, {0, 0, -9.81});
  for (int i = 0; i < 512; ++i)
    p.add(0.125 * Vec3{i % 8 + 0.5, i / 8 % 8 + 0.5, i / 64 + 0.5}, {}, 0, 0, i % 8 < 3 ? 0.8 : i % 8 < 5 ? 0.9 : 1);
  Packing mixed = p, two = p;
  std::mt19937 g(3);
  for (std::size_t i = 0; i < 512; ++i) {
    const double drawn = std::uniform_real_distribution<double>(0.8, 1)(g);
    mixed.frame.bodies.scale[i] = mixed.run.scene.bodies.scale[i] = drawn;
    two.frame.bodies.scale[i] = two.run.scene.bodies.scale[i] = i % 8 < 2 ? 0.8 : 1;
  }
  const auto of = [&](const scree::Run& run, const char* quantity) {
    StatisticsOptions options;
    options.frames = {0};
    return run_statistics(run, options, "").of(quantity);
  };
  const scree::Run apart = written(folder / "apart.run", p, {p.frame}), drawn = written(folder / "drawn.run", mixed, {mixed.frame}),
                   pair = written(folder / "pair.run", two, {two.frame});
  for (const char* quantity : {"segregation_fine", "segregation_coarse"}) {
    EXPECT_GT(of(apart, quantity).mean, 0.7) << quantity << ": cells are cut";
    EXPECT_NEAR(of(drawn, quantity).mean, 0, 0.1) << quantity;
  }
  EXPECT_NEAR(of(drawn, "segregation_middle").mean, 0, 0.1);
  // a quarter is small: all others are of the size that holds the middle third, and nothing is larger
  EXPECT_NEAR(of(pair, "segregation_fine").mean, of(pair, "segregation_middle").mean, 1e-12);
  EXPECT_GT(of(pair, "segregation_fine").mean, 0.4) << "the first cells hold a layer of large ones too";
  EXPECT_EQ(of(pair, "segregation_coarse").count, 0u);
}

// Cells of twelve bodies are higher than a bed of two layers: the halves along z share each cell from the start.
TEST_F(StatisticsOfARun, an_axis_that_the_cells_of_mixing_do_not_resolve_is_named) {
  Packing p(0.05, {0, 0, 0}, {2, 2, 2}, {0, 0, -9.81});
  for (int i = 0; i < 800; ++i) p.add(0.1 * Vec3{i % 20 + 0.5, i / 20 % 20 + 0.5, i / 400 + 0.5});
  const scree::Run run = written(folder / "flat.run", p, {p.frame});
  const auto statistics = [&](const char* mixing) {
    StatisticsOptions options;
    options.frames = {0};
    options.mixing = mixing;
    return run_statistics(run, options, "");
  };
  const Statistics flat = statistics("half-z"), wide = statistics("half-x");
  EXPECT_GT(flat.of("mixing_index").mean, 0.9);
  EXPECT_LT(flat.of("mixing_index_apart").mean, 0.2) << "along x or y they can be apart";
  const auto named = [](const Statistics& s) {
    return std::any_of(s.gaps.begin(), s.gaps.end(), [](const auto& gap) {
      return gap.first == "mixing_index" && gap.second.find("halves along z") != std::string::npos;
    });
  };
  EXPECT_TRUE(named(flat));
  EXPECT_LT(wide.of("mixing_index").mean, 0.2);
  EXPECT_FALSE(named(wide));
}

TEST_F(StatisticsOfARun, energies_are_those_of_the_bodies_that_are_counted) {
  Packing p(0.5, {0, 0, 0}, {4, 4, 4}, {0, 0, -10});
  p.add({1, 1, 1}, {2, 0, 0});
  p.add({3, 1, 2}, {0, 0, -30}, 0, 1);
  p.frame.bodies.angular_velocity[1] = {0, 6, 0};
  p.run.scene.forces = {{1, {3, 0, 5}}};
  const double ball = 2000 * std::numbers::pi / 6, box = 2000 * 0.5 * 1 * 1.5;
  // of the box with edges 0.5, 1 and 1.5 m about its axis y: m (a^2 + c^2) / 12
  const double of_box = 0.5 * box * (900 + (0.25 + 2.25) / 12 * 36);
  p.frame.kinetic = 0.5 * ball * 4 + of_box;
  p.frame.potential = ball * 10 * 1 + box * 10 * 2 - 3 * 3 - 5 * 2;
  const scree::Run run = written(folder / "two.run", p, {p.frame});
  const auto of = [&](const std::vector<std::string>& left_out, const char* quantity) { return mean_without(run, left_out, quantity); };
  EXPECT_DOUBLE_EQ(of({}, "kinetic_energy"), p.frame.kinetic);
  EXPECT_DOUBLE_EQ(of({}, "potential_energy"), p.frame.potential);
  EXPECT_NEAR(of({"1"}, "kinetic_energy"), 0.5 * ball * 4, 1e-9 * ball);
  EXPECT_NEAR(of({"0"}, "kinetic_energy"), of_box, 1e-9 * of_box);
  EXPECT_NEAR(of({"1"}, "potential_energy"), ball * 10, 1e-9 * ball);
  EXPECT_NEAR(of({"0"}, "potential_energy"), box * 20 - 3 * 3 - 5 * 2, 1e-9 * box);  // that of its constant force too
}

/// Two balls that press on each other through the lower and upper side of a cell of 4 m, which fill the rest of it with nothing.
Packing two_through_a_periodic_side(const Vec3& gravity) {
  Packing p(0.5, {0, 0, 0}, {4, 4, 4}, gravity);
  p.run.scene.walls.clear();
  p.run.boundary_ids.clear();
  p.frame.walls = {};
  Domain& domain = p.run.scene.settings.domain;
  domain.bounded = true;
  domain.periodic = {true, true, true};
  domain.lower = {0, 0, 0};
  domain.upper = {4, 4, 4};
  p.add({1, 1, 0.5});
  p.add({1, 1, 3.5});
  p.contact(0, 1, {1, 1, 0}, {0, 0, 1}, 8);
  return p;
}

TEST_F(StatisticsOfARun, a_cell_that_is_periodic_along_up_is_the_room_of_its_stress_and_its_layers) {
  const Packing p = two_through_a_periodic_side({0, 0, 0});
  const scree::Run run = written(folder / "cell.run", p, {p.frame});
  const auto of = [&](const char* quantity) { return mean_without(run, {}, quantity); };
  EXPECT_NEAR(of("stress_zz"), 8 * 1.0 / 64, 1e-12);  // force times branch over the volume
  EXPECT_NEAR(of("pressure"), 8 * 1.0 / 64 / 3, 1e-12);
  EXPECT_NEAR(of("solid_fraction_of_container"), 2 * std::numbers::pi / 6 / 64, 1e-12);
  StatisticsOptions options;
  options.frames = {0};
  options.profiles = {"z:4"};
  options.regions = {parse_region("whole=box:-1000,-1000,-1000,1000,1000,1000")};  // each body once, in the volume of the cell
  const Statistics measured = run_statistics(run, options, "");
  for (std::size_t k = 0; k < measured.quantities.size(); ++k) {
    const std::string& name = measured.quantities[k].name;
    const double mean = measured.averages[1][k].mean;
    if (name == "particle_count" || name == "mass" || name == "stress_zz") {
      EXPECT_NEAR(mean, measured.averages[0][k].mean, 1e-12) << name;
    }
    if (name == "solid_fraction") {
      EXPECT_NEAR(mean, 2 * std::numbers::pi / 6 / 64, 1e-12);
    }
  }
  const StatisticsTable& table = measured.tables.front();
  EXPECT_EQ(table.coordinates, (std::vector<double>{0.5, 1.5, 2.5, 3.5}));
  const double ball = std::numbers::pi / 6 / 16;
  for (const std::size_t k : {0, 1, 2, 3}) EXPECT_NEAR(table.values[0][k].mean, k % 3 == 0 ? ball : 0, 1e-12) << k;
}

TEST_F(StatisticsOfARun, of_a_part_of_the_bodies_the_energy_of_a_fall_without_an_end_is_not_known) {
  Packing p = two_through_a_periodic_side({1, 0, -10});
  p.frame.potential = -7;
  const scree::Run run = written(folder / "endless.run", p, {p.frame});
  EXPECT_DOUBLE_EQ(mean_without(run, {}, "potential_energy"), -7);
  EXPECT_TRUE(std::isnan(mean_without(run, {"0"}, "potential_energy")));
  EXPECT_FALSE(std::isnan(mean_without(run, {"0"}, "kinetic_energy")));
  StatisticsOptions options;
  options.frames = {0};
  options.without = ids_left_out(run, {"0"});
  const Statistics statistics = run_statistics(run, options, "");
  EXPECT_TRUE(std::any_of(statistics.gaps.begin(), statistics.gaps.end(), [](const auto& gap) {
    return gap.first == "potential_energy" && gap.second.find("periodic") != std::string::npos;
  }));
}

TEST_F(StatisticsOfARun, layers_across_a_container_that_moves_go_with_it) {
  Packing p(0.5, {0, 0, 0}, {4, 4, 4}, {0, 0, -10});
  for (const double x : {0.5, 1.5, 3.5}) p.add({x, 2, 0.5});
  std::vector<Frame> frames{p.frame, p.frame};
  frames[1].walls.position = {Vec3{10, 0, 0}};
  for (Vec3& x : frames[1].bodies.position) x.x += 10;
  const scree::Run run = written(folder / "moved.run", p, frames);
  for (const std::size_t f : {0, 1}) {
    StatisticsOptions options;
    options.frames = {f};
    options.profiles = {"x:4"};
    const StatisticsTable table = run_statistics(run, options, "").tables.front();
    EXPECT_EQ(table.coordinates, (std::vector<double>{0.5, 1.5, 2.5, 3.5}));
    for (const std::size_t k : {0, 1, 2, 3}) EXPECT_EQ(table.values[1][k].mean, k == 2 ? 0 : 1) << f << ' ' << k;
  }
}

TEST_F(StatisticsOfARun, what_is_left_out_counts_in_no_contact) {
  constexpr int n = 4;
  Packing p(0.5, {0, 0, 0}, {n, n, n}, {0, 0, -9.81});
  p.fill_lattice(n, 1, {0, 0, 3});
  p.run.scene.walls[0].name = "crate";
  const scree::Run run = written(folder / "lattice.run", p, {p.frame});
  const auto of = [&](const std::vector<std::string>& left_out, const char* quantity) { return mean_without(run, left_out, quantity); };
  EXPECT_DOUBLE_EQ(of({}, "coordination_number"), 2);  // above and below
  EXPECT_DOUBLE_EQ(of({"crate"}, "coordination_number"), 2 - 2.0 / n);
  EXPECT_DOUBLE_EQ(of({"1000000"}, "coordination_number"), 2 - 2.0 / n);
  EXPECT_EQ(of({"0", "5"}, "particle_count"), n * n * n - 2);
  EXPECT_NEAR(of({"0"}, "coordination_number"), (2.0 * n * n * n - 3) / (n * n * n - 1), 1e-12) << "its two contacts, one of them shared";
  EXPECT_EQ(of({"rock"}, "particle_count"), 0);
  EXPECT_THROW(ids_left_out(run, {"lid"}), UsageError);
}

TEST_F(StatisticsOfARun, removed_mass_is_discharged_and_rates_and_powers_have_charts) {
  Packing p(0.05, {0, 0, 0}, {1, 1, 1}, {0, 0, -9.81});
  for (int i = 0; i < 10; ++i) p.add({0.1 * i, 0.5, 0.5});
  p.run.scene.settings.domain.bounded = true;
  p.run.scene.settings.domain.upper = {1, 1, 1};
  p.run.scene.settings.domain.outside = Outside::remove;
  std::vector<Frame> frames(3, p.frame);
  take_rows(frames[1].bodies, {0, 1, 2, 3, 4, 5, 6});
  take_rows(frames[2].bodies, {0, 1, 2, 3, 4, 5});
  scree::Run run = written(folder / "leaves.run", p, frames);
  run.log.names = {"time", "wall1000000_power"};
  run.log.columns = {{0, 2}, {0, 8}};
  StatisticsOptions options;
  options.frames = {0, 1, 2};
  const Statistics s = run_statistics(run, options, "");
  const double ball = 2000 * 4.0 / 3 * kPi * 0.05 * 0.05 * 0.05;
  const auto series = [&](const char* name) {
    for (std::size_t q = 0; q < s.quantities.size(); ++q) {
      if (s.quantities[q].name == name) return s.series[q].value;
    }
    return std::vector<double>{};
  };
  const std::vector<double> mass = series("discharged_mass"), rate = series("discharge_rate");
  ASSERT_EQ(mass.size(), 3u);
  EXPECT_NEAR(mass[0], 0, 1e-12);
  EXPECT_NEAR(mass[2], 4 * ball, 1e-12);
  EXPECT_NEAR(rate[1], 3 * ball, 1e-12);  // in a second
  EXPECT_NEAR(rate[2], ball, 1e-12);
  const std::vector<NamedChart> charts = charts_of(s);
  const auto chart = [&](const char* name) {
    return std::find_if(charts.begin(), charts.end(), [&](const NamedChart& c) { return c.name == name; });
  };
  ASSERT_NE(chart("discharge_rate"), charts.end());
  ASSERT_NE(chart("wall_power"), charts.end());
  EXPECT_EQ(chart("wall_power")->chart.lines.at(0).y, (std::vector<double>{0, 4, 8}));
  // with a level it is what has passed it, and apparatus is none of it
  run.boundary_ids.insert(9);
  options.discharge = "x=0.45";
  EXPECT_NEAR(run_statistics(run, options, "").of("discharged_mass").smallest, 5 * ball, 1e-12);
}

TEST_F(StatisticsOfARun, tables_and_json_have_the_same_numbers_and_any_number_of_processes_gives_them) {
  const scree::Run run = open_run((folder / "sample.run").string());
  std::string texts[2];
  for (const int jobs : {1, 2}) {
    StatisticsOptions options;
    options.frames = choose_frames(run, "all");
    options.by_shape = true;
    options.regions = {parse_region("left=box:-1,-1,-1,0.1,1,1")};
    options.pool = {jobs, false};
    const std::string out = (folder / fmt::format("out{}", jobs)).string();
    const Statistics s = run_statistics(run, options, out);
    write_statistics(run, s, out);
    EXPECT_EQ(s.groups, (std::vector<std::string>{"all", "region left", "shape box", "shape wedge", "shape ball"}));
    EXPECT_EQ(s.of("particle_count").mean, 12);
    EXPECT_EQ(s.of("particle_count", 2).mean, 4);
    // the bodies move by (0.1, 0.2, 0.3) t, the contacts of the sample press with 1..11 N in two of three frames
    EXPECT_DOUBLE_EQ(s.of("mean_normal_force").mean, 6);
    EXPECT_EQ(s.of("mean_normal_force").count, 2u);
    EXPECT_DOUBLE_EQ(s.of("kinetic_energy").mean, 0);
    std::ifstream json(out + "/statistics.json");
    const nlohmann::json read = nlohmann::json::parse(json);
    EXPECT_EQ(read["groups"]["all"]["mean_normal_force"]["mean"], 6.0);
    EXPECT_EQ(read["groups"]["all"]["mean_normal_force"]["unit"], "N");
    std::ifstream series(out + "/series.csv");
    std::stringstream text;
    text << series.rdbuf();
    texts[jobs - 1] = text.str();
    EXPECT_EQ(std::count(texts[jobs - 1].begin(), texts[jobs - 1].end(), '\n'), 2 + 3 * 5);
  }
  EXPECT_EQ(texts[0], texts[1]);
}

TEST_F(StatisticsOfARun, an_angle_that_no_frame_has_is_reported_with_the_reason) {
  const scree::Run run = open_run((folder / "sample.run").string());
  StatisticsOptions options;
  options.frames = choose_frames(run, "all");
  options.repose = "cone";
  options.without = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11};
  const Statistics s = run_statistics(run, options, "");
  ASSERT_EQ(s.gaps.size(), 1u);
  EXPECT_NE(summary_of(s).find("angle_of_repose: missing in 3 of 3 frames; in the last of them "), std::string::npos) << summary_of(s);
  EXPECT_EQ(json_of(run, s)["gaps"]["angle_of_repose"], s.gaps[0].second);
  options.repose = "none";
  EXPECT_TRUE(run_statistics(run, options, "").gaps.empty()) << "not requested";
}

TEST_F(StatisticsOfARun, mass_that_goes_below_a_level_gives_the_rate) {
  const scree::Run run = open_run((folder / "sample.run").string());
  StatisticsOptions options;
  options.frames = choose_frames(run, "all");
  options.discharge = "z=1 m";  // all bodies are below from the start: all mass has gone, and none goes on
  const Statistics s = run_statistics(run, options, "");
  double mass = 0;
  for (std::size_t i = 0; i < run.scene.bodies.size(); ++i) mass += run.scene.mass(i);
  EXPECT_DOUBLE_EQ(s.of("discharged_mass").mean, mass);
  EXPECT_DOUBLE_EQ(s.of("discharge_rate").mean, 0);
  // bodies start in layers at 0.05 + 0.07 k and rise by 0.03 a frame: through 0.06 goes the lowest layer, upwards
  options.discharge = "z=6 cm";
  const Statistics rising = run_statistics(run, options, "");
  double lowest = 0;
  for (std::size_t i = 0; i < 9; ++i) lowest += run.scene.mass(i);
  EXPECT_NEAR(rising.of("discharge_rate").smallest, -lowest / 0.1, 1e-9);
  options.discharge = "down";
  EXPECT_THROW(run_statistics(run, options, ""), UsageError);
}

TEST_F(StatisticsOfARun, the_number_of_frames_does_not_change_what_is_kept) {
  const scree::Run run = open_run((folder / "sample.run").string());
  StatisticsOptions options;
  options.pool = {1, false};
  for (int i = 0; i < 900; ++i) options.frames.push_back(static_cast<std::size_t>(i % 3));
  const Statistics s = run_statistics(run, options, "");
  EXPECT_EQ(s.frames, 900u);
  EXPECT_LE(s.series[0].time.size(), 600u);
  EXPECT_EQ(s.of("mean_normal_force").count, 600u);
}

}  // namespace
}  // namespace scree
