// Boxes on boxes, both meshed independently: docs/reference/contact-law.md section 5 test 4, docs/reference/validation-plan.md section 3.6
// M1 and M3.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "tests/support/shapes.hpp"
#include "tests/support/test_run.hpp"

namespace scree {
namespace {

struct Rebound {
  Vec3 velocity, spin;
};

/// A cube falls at 1 m/s on a larger free box, `aside` from its centre; both tell how they fly apart.
std::array<Rebound, 2> rebound(const TriangleMesh& cube, const TriangleMesh& base, double aside) {
  test::TestRun run(test::empty_scene(1e4, 0.5, 0, 0.01, 1));
  run.scene.settings.step = 2e-5;  // the same for all meshes
  run.scene.shapes = {make_solid("cube", cube), make_solid("base", base)};
  test::add_body(run.scene, 0, {aside, 0.07, 1.0201}, quaternion_of({0, 0, 1}, 0.3), {0, 0, -1});
  test::add_body(run.scene, 1, {0, 0, 0});
  run.start();
  bool touched = false;
  for (int n = 0; n < 20000; ++n) {
    run.simulation->advance();
    const bool touches = contact_count(run.simulation->state()) > 0;
    if (touched && !touches) break;
    touched = touched || touches;
  }
  run.simulation->agree_on_failures();
  EXPECT_TRUE(touched);
  return {Rebound{run.velocity(0), run.spin(0)}, Rebound{run.velocity(1), run.spin(1)}};
}

/// The largest difference of any component over the impact speed.
double difference(const std::array<Rebound, 2>& l, const std::array<Rebound, 2>& r) {
  double most = 0;
  for (std::size_t i = 0; i < 2; ++i) most = std::max({most, length(l[i].velocity - r[i].velocity), length(l[i].spin - r[i].spin)});
  return most;
}

const Vec3 kCube{1, 1, 1}, kBase{2.2, 1.7, 1};

/// Two grids on the faces that meet, and slivers: a cube whose faces are cut close to their edges.
TriangleMesh graded(TriangleMesh mesh) {
  for (Vec3& p : mesh.vertices) {
    for (int k = 0; k < 3; ++k) p[k] = p[k] > 0 ? 0.5 - 4 * std::pow(0.5 - p[k], 3) : -0.5 + 4 * std::pow(0.5 + p[k], 3);
  }
  return mesh;
}

TEST(MeshIndependence, box_on_box_flies_apart_alike_however_finely_both_are_meshed) {
  const auto reference = rebound(test::grid_box(1, kCube), test::grid_box(1, kBase), 0.1);
  double most = 0;
  for (const int a : {1, 4, 16}) {
    for (const int b : {1, 4, 16})
      most = std::max(most, difference(rebound(test::grid_box(a, kCube), test::grid_box(b, kBase), 0.1), reference));
  }
  most = std::max(most, difference(rebound(graded(test::grid_box(8, kCube)), test::grid_box(3, kBase), 0.1), reference));
  std::printf("box on box: velocities and spins differ by %.1e of the impact speed over ten pairs of meshes\n", most);
  EXPECT_LE(most, 1e-5);
  // restitution of the face: 0.5 of the approach at the centre of pressure, which moves with the spin
  EXPECT_NEAR(reference[0].velocity.z - reference[1].velocity.z, 0.5, 0.05);
}

TEST(MeshIndependence, a_box_that_overhangs_turns_alike_however_finely_both_are_meshed) {
  const auto reference = rebound(test::grid_box(1, kCube), test::grid_box(1, kBase), 1.05);
  EXPECT_GT(length(reference[0].spin), 0.1);
  double most = 0;
  for (const int a : {4, 16}) {
    for (const int b : {4, 16})
      most = std::max(most, difference(rebound(test::grid_box(a, kCube), test::grid_box(b, kBase), 1.05), reference));
  }
  std::printf("overhang: velocities and spins differ by %.1e over five pairs of meshes\n", most);
  EXPECT_LE(most, 1e-6);
}

// M8: a whole impact of two concave rocks with friction.
TEST(MeshIndependence, an_impact_does_not_know_the_order_of_triangles_to_1e_12) {
  std::mt19937 g(4);
  const TriangleMesh a = test::scaled(test::rock(1, 2), 0.5), b = test::scaled(test::rock(2, 2), 0.5);
  const auto fly = [](const TriangleMesh& first, const TriangleMesh& second) {
    test::TestRun run(test::empty_scene(1e7, 0.5, 0.4, 0.01));
    run.scene.settings.step = 2e-5;
    run.scene.shapes = {make_solid("a", first), make_solid("b", second)};
    test::add_body(run.scene, 0, {0.1, 0.05, 1.2}, normalised(Quat{1, 0.3, 0.2, 0.1}), {0, 0, -2}, {1, 2, 3});
    test::add_body(run.scene, 1, {0, 0, 0});
    run.start();
    std::int64_t contacts = 0;
    for (int n = 0; n < 12000; ++n) {
      run.simulation->advance();
      contacts += contact_count(run.simulation->state());
    }
    run.simulation->agree_on_failures();
    EXPECT_GT(contacts, 100);
    return std::array<Rebound, 2>{Rebound{run.velocity(0), run.spin(0)}, Rebound{run.velocity(1), run.spin(1)}};
  };
  const auto reference = fly(a, b);
  double most = 0;
  for (int i = 0; i < 3; ++i) most = std::max(most, difference(fly(test::shuffled(a, g), test::shuffled(b, g)), reference) / 2);
  std::printf("order of triangles: velocities and spins differ by %.1e of the impact speed\n", most);
  EXPECT_LE(most, 1e-12);
}

// M1 to 32 subdivisions, with slivers.
TEST(MeshIndependence, restitution_of_a_flat_drop_spreads_by_less_than_1e_5_up_to_2048_triangles_a_face) {
  std::vector<double> e, duration;
  for (const TriangleMesh& mesh :
       {test::grid_box(1, kCube), test::grid_box(2, kCube), test::grid_box(32, kCube), graded(test::grid_box(8, kCube))}) {
    test::TestRun run(test::empty_scene(1e4, 0.5, 0, 0.01, 1));
    run.scene.settings.step = 2e-5;
    run.scene.shapes = {make_solid("cube", mesh)};
    test::add_body(run.scene, 0, {0, 0, 0.5201}, {}, {0, 0, -1});
    test::add_plane(run.scene, {0, 0, 0}, {0, 0, 1});
    run.start();
    std::int64_t touching = 0;
    for (int n = 0; n < 3000; ++n) {
      run.simulation->advance();
      touching += contact_count(run.simulation->state()) > 0 ? 1 : 0;
    }
    e.push_back(run.velocity(0).z);
    duration.push_back(static_cast<double>(touching) * run.scene.settings.step);
  }
  const auto [shortest, longest] = std::minmax_element(duration.begin(), duration.end());
  const auto [low, high] = std::minmax_element(e.begin(), e.end());
  std::printf("flat drop: e from %.7f to %.7f, contacts of %.3f to %.3f ms\n", *low, *high, 1e3 * *shortest, 1e3 * *longest);
  EXPECT_LE(*longest - *shortest, 0.01 * *shortest);
  EXPECT_LE(*high - *low, 1e-5);
  EXPECT_NEAR(*low, 0.5, 1e-3);
}

}  // namespace
}  // namespace scree
