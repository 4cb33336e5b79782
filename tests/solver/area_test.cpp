// gather = "area": closed forms of an elastic layer, exact gradients, energy, and independence of the mesh.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <random>

#include "solver/bodies/motion.hpp"
#include "solver/contact/area_model.hpp"
#include "solver/contact/chosen_law.hpp"
#include "solver/features/triangle_contacts.hpp"
#include "tests/support/shapes.hpp"
#include "tests/support/test_run.hpp"

namespace scree {
namespace {

constexpr double kLayer = 1e6, kMargin = 0.01, kKappa = kLayer / (2 * kMargin);  // [Pa], [m] of each body, [N/m^3]

Scene layer_scene(double restitution = 1, double friction = 0) {
  Scene scene = test::empty_scene(0, restitution, friction, kMargin);
  scene.settings.gather = Gathering::area;
  scene.pairs[0].layer_modulus = kLayer;
  return scene;
}

/// Two meshes, or a mesh and a zone of a wall, and the layer between them.
struct Layer {
  Scene scene = layer_scene();
  std::unique_ptr<SolverScene> prepared;
  PairBody body[2];
  const WallZone* zone = nullptr;
  MeshDistanceScratchPtr scratch = make_mesh_distance_scratch();
  PairFeatures found;
  double range = 0;  ///< of an attraction [m]
  std::vector<ContactOutput> outputs;

  Layer(const TriangleMesh& a, const TriangleMesh& b) {
    scene.shapes = {make_solid("a", a), make_solid("b", b)};
    prepare();
  }
  Layer(const TriangleMesh& a, Shape b) {
    scene.shapes = {make_solid("a", a), std::move(b)};
    prepare();
  }
  explicit Layer(const TriangleMesh& a, const Wall& wall) {
    scene.shapes = {make_solid("a", a)};
    scene.walls = {wall};
    prepare();
    zone = &prepared->zones()[0];
  }
  void prepare() {
    prepared = std::make_unique<SolverScene>(scene);
    for (std::size_t i = 0; i < scene.shapes.size(); ++i) {
      body[i].shape = &prepared->shape(static_cast<std::int32_t>(i));
      body[i].q = body[i].shape->body_from_principal;
    }
  }
  /// in   adhesion   work of the attraction [J/m^2]     in  range   [m]
  Layer& attract(double adhesion, double reach) {
    scene.pairs[0].adhesion = adhesion;
    scene.pairs[0].adhesion_range = range = reach;
    const bool has_zone = zone != nullptr;
    prepare();
    if (has_zone) zone = &prepared->zones()[0];
    return *this;
  }
  void find_with_attraction() {
    PairView view;
    view.a = body[0];
    view.b = body[1];
    view.pose = RelativePose(body[0], body[1]);
    view.radius_a = body[0].shape->radius;
    view.radius_b = zone != nullptr ? 2 * view.radius_a : body[1].shape->radius;
    view.margin = 2 * kMargin;
    view.reach = 2 * kMargin + range;
    view.zone = zone;
    view.geometry = zone != nullptr ? PairGeometry::body_zone : PairGeometry::two_meshes;
    CandidateLists lists;
    EXPECT_TRUE(AreaModel::list(view, 0.01, *scratch, lists));
    AreaModel::find_features(view, 0, lists, found);
    for (ContactFeature& f : found.list) f.overlap -= range;
    PullView pull;
    pull.range = range;
    AreaModel::weigh(view, pull, 0, lists, found);
  }
  PairForce force(double share_of_a = 1) {
    CandidateLists lists;
    if (range > 0) find_with_attraction();
    const double ra = body[0].shape->radius, rb = zone != nullptr ? 2 * ra : body[1].shape->radius;
    if (range > 0) {
    } else if (zone != nullptr) {
      list_area_zone(body[0], body[1], *zone, 2 * kMargin, 0.01, ra, lists);
      area_zone_features(body[0], body[1], *zone, 2 * kMargin, 0, lists, found.list, found.layer);
    } else {
      EXPECT_TRUE(list_triangle_contacts(body[0], body[1], 2 * kMargin, 0.01, ra, rb, *scratch, lists));
      area_features(body[0], body[1], 2 * kMargin, 0, share_of_a, lists, found.list, found.layer);
    }
    PairMotion m{};
    m.inverse_mass_a = 1;
    m.inverse_inertia_a = {1, 1, 1};
    m.centre_b = rotate_inverse(body[0].q, body[1].x - body[0].x);
    m.b_to_a = matrix_of(conjugate(body[0].q) * body[1].q);
    found.has_layer = true;
    std::vector<FrictionSpring> springs;
    return pair_force_function(prepared->law_choice())(found, prepared->law(0, 0), m, 0, 0, springs, &outputs);
  }
  Vec3 world_force() {
    const PairForce f = force();
    return rotate(body[0].q, f.force);
  }
};

Wall plane_wall() {
  Wall wall;
  wall.name = "plane";
  wall.kind = WallKind::plane;
  wall.normal = {0, 0, 1};
  return wall;
}

// Winkler's foundation under a flat punch: kappa times area times overlap, however both are meshed, and less where it overhangs.
TEST(AreaPressure, of_a_flat_punch_is_the_foundation_stiffness_on_every_mesh) {
  const double overlap = 0.004, gap = 2 * kMargin - overlap, expected = kKappa * 0.2 * 0.1 * overlap;
  for (const int n : {1, 2, 5}) {
    for (const int m : {1, 3}) {
      Layer layer(test::grid_box(n, {0.2, 0.1, 0.1}), test::grid_box(m, {1, 1, 0.1}));
      layer.body[0].x = {0.03, -0.02, 0.1 + gap};
      const PairForce f = layer.force(n == 1 ? 1 : n == 2 ? 0 : 0.5);
      const Vec3 force = rotate(layer.body[0].q, f.force);
      EXPECT_NEAR(force.z, expected, 1e-11 * expected);
      EXPECT_NEAR(f.elastic, 0.5 * expected * overlap, 1e-11 * expected * overlap);
      EXPECT_NEAR(length(force - Vec3{0, 0, force.z}), 0, 1e-11 * expected);
      EXPECT_NEAR(length(f.torque), 0, 1e-11 * expected);
      EXPECT_NEAR(f.largest_overlap, overlap, 1e-12);
    }
    Layer on_plane(test::grid_box(n, {0.2, 0.1, 0.1}), plane_wall());
    on_plane.body[0].x = {0, 0, 0.05 + gap};
    EXPECT_NEAR(on_plane.world_force().z, expected, 1e-11 * expected);
    // a quarter of the face beyond the rim: less force, a moment, and a push off the rim by the energy of the overlap
    Layer rim(test::grid_box(n, {0.2, 0.1, 0.1}), test::grid_box(2, {1, 1, 0.1}));
    rim.body[0].x = {0.45, 0, 0.1 + gap};
    const PairForce f = rim.force();
    EXPECT_NEAR(rotate(rim.body[0].q, f.force).z, 0.75 * expected, 1e-10 * expected);
    EXPECT_NEAR(rotate(rim.body[0].q, f.force).x, 0.5 * kKappa * 0.1 * overlap * overlap, 1e-10 * expected);
  }
}

// A ball on a plane: F = kappa pi R d^2, exactly for the analytic one, to second order in the facets for meshes.
TEST(AreaPressure, of_a_ball_is_that_of_a_paraboloid) {
  const double R = 0.5, overlap = 0.01, expected = kKappa * std::numbers::pi * R * overlap * overlap;
  double before = 1;
  for (const int level : {3, 4, 5}) {
    Layer ball(test::scaled(test::icosphere(level), R), plane_wall());
    double error = 0;
    std::mt19937 g(1);
    for (int i = 0; i < 8; ++i) {
      ball.body[0].q = test::random_quaternion(g);
      double low = 0;
      for (const Vec3& p : ball.body[0].shape->mesh.vertices) low = std::min(low, rotate(ball.body[0].q, p).z);
      ball.body[0].x = {0, 0, R + 2 * kMargin - overlap};
      error = std::max(error, std::abs(ball.world_force().z / expected - 1));
    }
    EXPECT_LT(error, 0.45 * before) << level;
    before = error;
  }
  EXPECT_LT(before, 0.05);
  test::TestRun run(layer_scene());
  run.scene.shapes = {make_sphere("ball", R)};
  test::add_body(run.scene, 0, {0, 0, R + 2 * kMargin - overlap});
  test::add_plane(run.scene, {0, 0, 0}, {0, 0, 1});
  run.start();
  EXPECT_NEAR(energies_of(run.simulation->state()).elastic, expected * overlap / 3, 1e-12 * expected * overlap);
}

// A thin plate stands on a corner in any tilt, on a sheet and beneath it: what presses is what presses on a plane. By the normals alone the
// faces beside the corner that look away from the sheet pressed on its far side, as deep as they are long.
TEST(AreaPressure, of_a_sheet_is_that_of_a_plane_on_the_side_where_the_body_is) {
  const TriangleMesh sheet{{{-2, -2, 0}, {2, -2, 0}, {2, 2, 0}, {-2, 2, 0}}, {{0, 1, 2}, {0, 2, 3}}};
  const TriangleMesh plate = test::grid_box(2, {0.4, 0.3, 0.04});
  std::mt19937 g(5);
  for (int i = 0; i < 60; ++i) {
    Layer on_plane(plate, plane_wall()), on_sheet(plate, make_surface("sheet", sheet));
    const Quat q = test::random_quaternion(g);
    double low = 0;
    for (const Vec3& p : on_plane.body[0].shape->mesh.vertices) low = std::min(low, rotate(q, p).z);
    on_plane.body[0].q = on_sheet.body[0].q = q;
    on_plane.body[0].x = on_sheet.body[0].x = {0, 0, -low + kMargin};
    const PairForce expected = on_plane.force(), above = on_sheet.force();
    ASSERT_GT(expected.elastic, 0);
    EXPECT_NEAR(above.elastic, expected.elastic, 1e-9 * expected.elastic) << i;
    EXPECT_LT(length(above.force - expected.force), 1e-9 * length(expected.force)) << i;
    EXPECT_NEAR(above.largest_overlap, expected.largest_overlap, 1e-9 * kMargin) << i;
    // seen in a mirror, from below
    on_sheet.body[1].q = quaternion_of({1, 0, 0}, std::numbers::pi);
    EXPECT_NEAR(on_sheet.force().elastic, expected.elastic, 1e-9 * expected.elastic) << i;
  }
}

// A box slides and turns on another of the same shape: which of them is A changes nothing but rounding.
TEST(AreaPressure, of_two_bodies_of_one_size_does_not_depend_on_which_is_first) {
  const std::array<Vec3, 2> at{Vec3{0, 0, 0}, Vec3{0.05, 0.03, 0.1 + 2 * kMargin - 0.002}}, velocity{Vec3{}, Vec3{0.4, -0.2, -0.3}};
  const std::array<Vec3, 2> spin{Vec3{0, 0, 1}, Vec3{2, 0, -5}};
  std::array<std::array<Vec3, 2>, 2> x;  // by order and body
  for (const std::size_t first : {0, 1}) {
    test::TestRun run(layer_scene(0.5, 0.4));
    run.scene.shapes = {make_solid("box", test::grid_box(2, {0.2, 0.15, 0.1}))};
    for (const std::size_t i : {first, 1 - first}) test::add_body(run.scene, 0, at[i], {}, velocity[i], spin[i]);
    run.start();
    run.run_for(0.02);
    for (const std::size_t i : {first, 1 - first}) x[first][i] = run.position(i == first ? 0 : 1);
  }
  EXPECT_GT(length(x[0][1] - at[1] - 0.02 * velocity[1]), 1e-4) << "they have not touched";
  for (const std::size_t i : {0, 1}) EXPECT_LT(length(x[0][i] - x[1][i]), 1e-13) << i;
}

/// Force and torque on A against central differences of the energy over a small motion of A.
void expect_gradient(Layer& layer, double scale) {
  const PairForce f = layer.force();
  const Vec3 x = layer.body[0].x;
  const Quat q = layer.body[0].q;
  constexpr double h = 1e-6;
  for (int k = 0; k < 6; ++k) {
    double u[2];
    for (const int side : {0, 1}) {
      Vec3 step;
      step[k % 3] = side == 0 ? -h : h;
      layer.body[0].x = x;
      layer.body[0].q = q;
      if (k < 3)
        layer.body[0].x = x + rotate(q, step);
      else
        layer.body[0].q = q * rotation_by(step);
      u[side] = layer.force().elastic;
    }
    layer.body[0].x = x;
    layer.body[0].q = q;
    EXPECT_NEAR((k < 3 ? f.force : f.torque)[k % 3], -(u[1] - u[0]) / (2 * h), 2e-6 * scale) << k;
  }
}

TEST(AreaPressure, is_the_gradient_of_its_energy_on_meshes_and_walls) {
  std::mt19937 g(3);
  std::normal_distribution<double> n;
  Wall cylinder, sphere;
  cylinder.kind = WallKind::cylinder_inside;
  cylinder.axis_start = {0, 0, -3};
  cylinder.axis_end = {0, 0, 3};
  sphere.kind = WallKind::sphere_inside;
  cylinder.radius = sphere.radius = 1;
  int touched = 0;
  for (int i = 0; i < 40; ++i) {
    const TriangleMesh rock = test::scaled(test::rock(1 + static_cast<unsigned>(i % 3), 2, 0.3), 0.5),
                       other = test::scaled(test::rock(7, 1, 0.3), 0.5);
    Layer layer = i % 4 == 0 ? Layer(rock, cylinder) : i % 4 == 1 ? Layer(rock, sphere) : Layer(rock, other);
    layer.body[0].q = test::random_quaternion(g);
    layer.body[1].q = i % 4 < 2 ? Quat{} : test::random_quaternion(g);
    // towards each other until the layer is pressed
    const Vec3 direction = normalised(Vec3{n(g), n(g), 0.3 * n(g)});
    for (double way = i % 4 < 2 ? 0 : -1.6; way < 2; way += 0.004) {
      layer.body[0].x = way * direction;
      const PairForce f = layer.force();
      if (!(f.largest_overlap > 0.5 * kMargin)) continue;
      ++touched;
      expect_gradient(layer, length(f.force));
      break;
    }
  }
  EXPECT_EQ(touched, 40);
}

TEST(AreaPressure, with_attraction_is_the_gradient_of_its_energy_beyond_touch_and_within) {
  std::mt19937 g(5);
  std::normal_distribution<double> n;
  Wall cylinder;
  cylinder.kind = WallKind::cylinder_inside;
  cylinder.axis_start = {0, 0, -3};
  cylinder.axis_end = {0, 0, 3};
  cylinder.radius = 1;
  int beyond = 0, within = 0;
  for (int i = 0; i < 40; ++i) {
    const TriangleMesh rock = test::scaled(test::rock(1 + static_cast<unsigned>(i % 3), 2, 0.3), 0.5),
                       other = test::scaled(test::rock(7, 1, 0.3), 0.5);
    Layer layer = i % 4 == 0 ? Layer(rock, cylinder) : Layer(rock, other);
    layer.attract(40, 0.02);
    layer.body[0].q = test::random_quaternion(g);
    layer.body[1].q = i % 4 == 0 ? Quat{} : test::random_quaternion(g);
    const Vec3 direction = normalised(Vec3{n(g), n(g), 0.3 * n(g)});
    bool was_beyond = false;
    for (double way = i % 4 == 0 ? 0 : -1.6; way < 2; way += 0.004) {
      layer.body[0].x = way * direction;
      const PairForce f = layer.force();
      Vec3 of_contacts;
      for (const ContactOutput& c : layer.outputs) of_contacts += c.normal_force * c.normal;
      EXPECT_LE(length(of_contacts - f.force), 1e-12 * (1 + length(f.force))) << "frames hold what acts";
      if (!was_beyond && layer.found.list.size() > 3 && f.largest_overlap == 0) {
        EXPECT_LT(f.elastic, 0);
        expect_gradient(layer, length(f.force));
        was_beyond = true;
        ++beyond;
      }
      if (!(f.largest_overlap > 0.5 * kMargin)) continue;
      ++within;
      double largest = 0;  // push and pull nearly cancel
      for (const ContactOutput& c : layer.outputs) largest += std::abs(c.normal_force);
      expect_gradient(layer, largest);
      break;
    }
  }
  EXPECT_EQ(within, 40);
  EXPECT_GE(beyond, 25);
}

double rebound(const TriangleMesh& box, int floor_mesh, double restitution, double tilt = 0) {
  test::TestRun run(layer_scene(restitution));
  run.scene.settings.step = 1e-4;
  run.scene.shapes = {make_solid("box", box)};
  if (floor_mesh > 0) run.scene.shapes.push_back(make_solid("floor", test::grid_box(floor_mesh, {2, 2, 0.2})));
  test::add_body(run.scene, 0, {0.013, 0.007, 0.5 + 0.0201 + 0.6 * tilt}, quaternion_of(normalised(Vec3{1, 0.4, 0}), tilt), {0, 0, -1});
  if (floor_mesh > 0) {
    test::add_body(run.scene, 1, {0, 0, -0.1});
    run.scene.bodies.fixed[1] = 1;
  } else {
    test::add_plane(run.scene, {0, 0, 0}, {0, 0, 1});
  }
  run.start();
  const Energies before = energies_of(run.simulation->state());
  const double steps_to_go = 4000;
  for (int n = 0; n < steps_to_go; ++n) run.simulation->advance();
  run.simulation->agree_on_failures();
  const Energies after = energies_of(run.simulation->state());
  EXPECT_EQ(after.elastic, 0) << "still in touch";
  EXPECT_NEAR(after.balance(), before.balance(), 1e-3 * before.balance());
  return tilt > 0 ? after.balance() - after.dissipated : run.velocity(0).z;
}

TEST(AreaPressure, rebounds_as_asked_from_any_mesh) {
  const double reference = rebound(test::grid_box(1, {1, 1, 1}), 0, 0.6);
  EXPECT_NEAR(reference, 0.6, 1e-3);
  for (const int n : {2, 4}) EXPECT_NEAR(rebound(test::grid_box(n, {1, 1, 1}), 0, 0.6), reference, 1e-10);
  for (const int m : {1, 3}) EXPECT_NEAR(rebound(test::grid_box(2, {1, 1, 1}), m, 0.6), reference, 1e-10);
}

TEST(AreaPressure, keeps_the_energy_of_an_elastic_impact_on_an_edge) {
  EXPECT_NEAR(rebound(test::grid_box(2, {1, 1, 1}), 3, 1, 0.02), 500, 500 * 2e-4);
}

// A disc of triangles around its centre that spins on its face stops at 3 R w / (4 mu g): pressure all over it, M = 2/3 mu m g R.
TEST(AreaPressure, stops_a_spinning_disc_as_uniform_pressure_does) {
  const double R = 0.1, w0 = 20, mu = 0.3, g = 9.81;
  test::TestRun run(layer_scene(0.5, mu));
  run.scene.settings.gravity = {0, 0, -g};
  run.scene.shapes = {make_solid("disc", test::revolved({{0, -0.02}, {R, -0.02}, {R, 0.02}, {0, 0.02}}, 96))};
  const double mass = 1000 * run.scene.shapes[0].mass.volume, area = run.scene.shapes[0].mass.volume / 0.04;
  test::add_body(run.scene, 0, {0, 0, 0.02 + 2 * kMargin - mass * g / (kKappa * area)}, {}, {}, {0, 0, w0});
  test::add_plane(run.scene, {0, 0, 0}, {0, 0, 1});
  run.start();
  const double stop = 3 * R * w0 / (4 * mu * g);
  run.run_for(0.5 * stop);
  EXPECT_NEAR(run.spin(0).z, 0.5 * w0, 0.01 * w0);
  run.run_for(0.55 * stop);
  EXPECT_NEAR(run.spin(0).z, 0, 0.01 * w0);
}

}  // namespace
}  // namespace scree
