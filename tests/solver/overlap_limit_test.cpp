// Contacts deeper than their maximum overlap, which on_overlap = "continue" goes on with: force and energy in closed form, and what stays
// as it is.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "solver/contact/overlap_limit.hpp"
#include "tests/support/shapes.hpp"
#include "tests/support/test_run.hpp"

namespace scree {
namespace {

using test::TestRun;

constexpr double kSide = 0.1, kMargin = 0.002, kRoom = 2 * kMargin, kWay = 0.03, kPeriod = 0.5, kStiffness = 1e5;

enum class Press { plane, plate, slab, both_plates };  ///< what the walls are

/// A plate of triangles that covers the body, or a closed slab above it.
Shape plate(bool closed) {
  if (!closed) return make_surface("plate", {{{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}}, {{0, 1, 2}, {0, 2, 3}}});
  return make_surface("plate", test::grid_box(1, {2, 2, 0.2}));
}

/// A body that just fits between a floor and a press, which comes down by kWay and goes up again.
TestRun pressed(const Shape& shape, double height, Press kind, double restitution = 0.5, double friction = 0.3) {
  TestRun run(test::empty_scene(kStiffness, restitution, friction, kMargin));
  run.scene.settings.on_overlap = OnOverlap::proceed;
  run.scene.shapes = {shape};
  test::add_body(run.scene, 0, {0, 0, 0.5 * height + kRoom});
  const double top = height + 2 * kRoom;
  test::add_plane(run.scene, {0, 0, 0}, {0, 0, 1});
  test::add_plane(run.scene, {0, 0, top}, {0, 0, -1});
  run.scene.walls[0].name = "floor";
  run.scene.walls[1].name = "press";
  run.scene.walls[1].motion.kind =
      Oscillate{.axis = {0, 0, 1}, .amplitude = 0.5 * kWay, .frequency = 1 / kPeriod, .phase = 0.5 * std::numbers::pi};
  const auto make_mesh = [&](Wall& wall, double z) {
    run.scene.shapes.push_back(plate(kind == Press::slab));
    wall.kind = WallKind::mesh;
    wall.shape = static_cast<std::int32_t>(run.scene.shapes.size()) - 1;
    wall.position = {0, 0, kind == Press::slab ? z + 0.1 : z};
  };
  if (kind != Press::plane) make_mesh(run.scene.walls[1], top);
  if (kind == Press::both_plates) make_mesh(run.scene.walls[0], 0);
  return run;
}

/// Overlap at each wall: half of what the press has gone, since all is slow.
double overlap_at(double time) { return 0.25 * kWay * (1 - std::cos(2 * std::numbers::pi * time / kPeriod)); }

/// Compares the force on the press with a law, and the energies with what it did.
template <class Force>
void expect_law(TestRun& run, const char* what, Force&& force, double tolerance) {
  run.start();
  for (int n = 1; n <= 12; ++n) {
    run.run_for(kPeriod / 12);
    const double time = run.simulation->time(), overlap = overlap_at(time);
    const double found = wall_loads_of(run.simulation->state())[1].force.z;
    EXPECT_NEAR(found, force(overlap), tolerance * force(0.5 * kWay)) << what << " at " << time;
    const Energies e = energies_of(run.simulation->state());
    EXPECT_NEAR(e.balance(), 0, 1e-6 * kStiffness * kWay * kWay) << what << " at " << time;
  }
  const DeepTotals deep = over_ranks(run.comm.get(), run.simulation->state().totals.deep);
  EXPECT_EQ(deep.contacts, 2) << what;
  EXPECT_GT(deep.contact_steps, 100) << what;
  EXPECT_NEAR(deep.overlap, 0.5 * kWay, tolerance * kWay) << what;
  EXPECT_NEAR(deep.excess, 0.5 * kWay - kStopOverlapRatio * kRoom, tolerance * kWay) << what;
  EXPECT_NEAR(static_cast<double>(deep.step) * run.simulation->state().clock.size.step, 0.5 * kPeriod, 0.02 * kPeriod) << what;
}

// Overlaps of 3.75 times the room. Four corners share a potential, and have the stiffness 4^(1/4) k. The tolerance is that of damping and
// inertia at this speed.
TEST(DeepContact, of_a_cube_pressed_by_planes_or_plates_has_the_force_of_its_law) {
  const Shape cube = make_solid("cube", test::grid_box(1, {kSide, kSide, kSide}));
  const auto law = [](double overlap) { return kStiffness * std::sqrt(2.0) * overlap; };
  for (const auto& [kind, what] :
       {std::pair{Press::plane, "plane"}, {Press::plate, "plate"}, {Press::slab, "slab"}, {Press::both_plates, "plates"}}) {
    TestRun run = pressed(cube, kSide, kind);
    expect_law(run, what, law, 0.01);
  }
}

TEST(DeepContact, of_a_ball_has_the_force_of_its_law) {
  const Shape ball = make_sphere("ball", 0.5 * kSide);
  for (const auto& [kind, what] :
       {std::pair{Press::plane, "plane"}, {Press::plate, "plate"}, {Press::slab, "slab"}, {Press::both_plates, "plates"}}) {
    TestRun run = pressed(ball, kSide, kind);
    expect_law(
        run, what, [](double overlap) { return kStiffness * overlap; }, 0.01);
  }
}

// Hertz up to the limit, its tangent beyond.
TEST(DeepContact, of_a_hertzian_ball_goes_on_along_the_tangent) {
  constexpr double kYoung = 1e7, kModulus = kYoung / 2, kRadius = 0.5 * kSide, kLimit = kStopOverlapRatio * kRoom;
  const double root = std::sqrt(kRadius), tangent = 2 * kModulus * root * std::sqrt(kLimit);
  const auto law = [&](double d) {
    const auto hertz = [&](double x) { return 4.0 / 3 * kModulus * root * x * std::sqrt(x); };
    return d < kLimit ? hertz(d) : hertz(kLimit) + tangent * (d - kLimit);
  };
  for (const auto& [kind, what] : {std::pair{Press::plane, "plane"}, {Press::plate, "plate"}}) {
    TestRun run = pressed(make_sphere("ball", kRadius), kSide, kind);
    run.scene.settings.law = ContactLaw::hertz_mindlin;
    run.scene.materials[0].young = kYoung;
    run.scene.materials[0].poisson = 0;
    run.scene.pairs[0].stiffness = 0;
    run.scene.settings.impact_speed = 0.01;  // of no account: the step follows from the slope at the limit
    expect_law(run, what, law, 0.01);
    const double step = run.simulation->state().clock.size.step;
    const double mass = 1000 * 4.0 / 3 * std::numbers::pi * std::pow(kRadius, 3);
    EXPECT_LT(step, std::numbers::pi / std::sqrt(tangent / mass) / 29) << what;
  }
}

// The default ends the run where it always did.
TEST(DeepContact, ends_a_run_that_does_not_ask_for_more) {
  for (const Press kind : {Press::plane, Press::plate}) {
    TestRun run = pressed(make_solid("cube", test::grid_box(1, {kSide, kSide, kSide})), kSide, kind);
    run.scene.settings.on_overlap = OnOverlap::stop;
    run.start();
    EXPECT_THROW(run.run_for(kPeriod), Error);
    EXPECT_LT(run.simulation->time(), 0.25 * kPeriod);
    EXPECT_EQ(run.simulation->state().totals.deep.contact_steps, 0);
  }
}

// A chain: the press, three bodies, the floor. Each contact has the same force, and a third part of the way of the two walls is not enough
// room for any.
TEST(DeepContact, of_a_chain_of_bodies_shares_the_way_of_the_press) {
  TestRun run = pressed(make_solid("cube", test::grid_box(1, {kSide, kSide, kSide})), kSide, Press::plane);
  const double gap = kRoom;
  test::add_body(run.scene, 0, {0, 0, 1.5 * kSide + 2 * gap});
  run.scene.walls[1].point = {0, 0, 2 * kSide + 3 * gap};
  run.start();
  run.run_for(0.5 * kPeriod);
  const double on_press = wall_loads_of(run.simulation->state())[1].force.z, on_floor = -wall_loads_of(run.simulation->state())[0].force.z;
  EXPECT_NEAR(on_press, on_floor, 0.02 * on_press);
  // face on face: what the pair of cubes has at its overlap is more than corners on a plane, so that its share of the way is less
  EXPECT_GT(on_press, kStiffness * kWay / 3);
  EXPECT_NEAR(energies_of(run.simulation->state()).balance(), 0, 1e-3 * energies_of(run.simulation->state()).elastic);
  run.run_for(0.5 * kPeriod);
  EXPECT_NEAR(energies_of(run.simulation->state()).elastic, 0, 1e-3 * kStiffness * kWay * kWay);
  EXPECT_EQ(over_ranks(run.comm.get(), run.simulation->state().totals.deep).contacts, 3);
}

// Nothing differs before the limit: the same bits.
TEST(DeepContact, changes_no_bit_of_a_run_that_has_none) {
  const auto hash = [](OnOverlap choice, const Shape& shape, Press kind) {
    TestRun run = pressed(shape, kSide, kind);
    run.scene.settings.on_overlap = choice;
    run.scene.settings.gravity = {0, 0, -9.81};
    std::get<Oscillate>(run.scene.walls[1].motion.kind).amplitude = 0.4 * kRoom;
    run.scene.bodies.velocity[0] = {0.1, 0.05, -0.1};
    run.scene.bodies.angular_velocity[0] = {1, 2, 3};
    run.start();
    run.run_for(0.25 * kPeriod);
    const std::string all = state_hash(run.simulation->state());
    EXPECT_EQ(run.simulation->state().totals.deep.contact_steps, 0);
    return all;
  };
  for (const Shape& shape : {make_solid("cube", test::grid_box(1, {kSide, kSide, kSide})), make_sphere("ball", 0.5 * kSide)}) {
    for (const Press kind : {Press::plane, Press::plate, Press::slab})
      EXPECT_EQ(hash(OnOverlap::stop, shape, kind), hash(OnOverlap::proceed, shape, kind)) << shape.name << " " << static_cast<int>(kind);
  }
}

// A body deeper than it is large is through: nothing is left to be continued.
TEST(DeepContact, ends_where_a_body_is_nearly_through) {
  TestRun run = pressed(make_solid("cube", test::grid_box(1, {kSide, kSide, kSide})), kSide, Press::plane);
  run.scene.walls[1].motion.kind = Translate{.axis = {0, 0, 1}, .rate = -1};
  run.scene.bodies.fixed[0] = 0;
  run.start();
  try {
    run.run_for(0.5);
    FAIL() << "nothing stopped the run";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ExitCode::run_invalid);
    EXPECT_NE(std::string(e.what()).find("nothing is left for on_overlap"), std::string::npos) << e.what();
    EXPECT_NE(std::string(e.what()).find("wall 'press', which moves, and wall 'floor'"), std::string::npos) << e.what();
  }
}

TEST(DeepContact, refuses_what_it_does_not_go_with) {
  const auto message = [](auto&& change) {
    TestRun run = pressed(make_solid("cube", test::grid_box(1, {kSide, kSide, kSide})), kSide, Press::plane);
    change(run.scene);
    try {
      run.make();
    } catch (const UsageError& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  EXPECT_EQ(message([](Scene&) {}), "");
  EXPECT_EQ(message([](Scene& s) { s.walls[1].motion = {}; }), "") << "a run goes on where its motions have ended";
  EXPECT_NE(message([](Scene& s) { s.settings.barrier = 10; }).find("does not go with contact.barrier"), std::string::npos);
  EXPECT_NE(message([](Scene& s) { s.settings.gather = Gathering::pairs; }).find("contact.gather = \"potential\" only"), std::string::npos);
}

// Shifts and back: the overlap of a contact with plane faces does not depend on the shift that it is found with.
TEST(DeepContact, has_the_same_overlap_at_any_shift) {
  std::vector<ContactFeature> features(2);
  const Vec3 n{0, 0, 1}, m = normalised(Vec3{1, 0, 1}), shift{0.001, 0.002, 0.03};
  const double reach = 0.004, gap_n = 0.001, gap_m = 0.002;  // at the shifted pose
  features[0].n = n;
  features[1].n = m;
  features[0].overlap = reach + length(shift) - gap_n;
  features[1].overlap = reach + length(shift) - gap_m;
  take_shift_back(shift, features);
  EXPECT_NEAR(features[0].overlap, reach - (gap_n - dot(shift, n)), 1e-15);
  EXPECT_NEAR(features[1].overlap, reach - (gap_m - dot(shift, m)), 1e-15);
}

}  // namespace
}  // namespace scree
