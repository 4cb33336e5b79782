// Mass flow, residence times and sizes against closed forms, from tables as the solver writes them.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "core/base/error.hpp"
#include "post/statistics/flow_output.hpp"

namespace scree {
namespace {

const std::string kInserted = "step,time,id,mass,diameter,x,y,z,shape,inlet\n# units: -,s,-,kg,m,m,m,m,-,-\n";
const std::string kRemoved =
    "step,time,id,mass,x,y,z,velocity_x,velocity_y,velocity_z,residence_time,outlet\n# units: -,s,-,kg,m,m,m,m/s,m/s,m/s,s,-\n";

std::string came_in(double time, int id, double mass, double diameter, const std::string& inlet = "feed") {
  return fmt::format("1,{:.17g},{},{:.17g},{:.17g},0,0,0,ball,{}\n", time, id, mass, diameter, inlet);
}

std::string went_out(double time, int id, double mass, double residence, const std::string& outlet = "chute") {
  return fmt::format("1,{:.17g},{},{:.17g},0,0,0,0,0,0,{:.17g},{}\n", time, id, mass, residence, outlet);
}

/// A run with one inlet and one outlet, of which only the tables are there.
class FlowTables : public ::testing::Test {
 protected:
  FlowTables() {
    run_.folder = std::string(SCREE_TEST_FOLDER) + "/flow.run";
    std::filesystem::create_directories(run_.folder);
    Inlet inlet;
    inlet.name = "feed";
    run_.scene.inlets.push_back(inlet);
    Outlet outlet;
    outlet.name = "chute";
    run_.scene.outlets.push_back(outlet);
  }
  void write(const std::string& inserted, const std::string& removed) {
    std::ofstream(run_.folder + "/inserted.csv") << kInserted << inserted;
    std::ofstream(run_.folder + "/removed.csv") << kRemoved << removed;
  }
  std::string failure() const {
    try {
      read_flow(run_, 0, 10, 10);
    } catch (const InputError& e) {
      return e.what();
    }
    return "nothing was refused";
  }
  scree::Run run_;  // testing::Test has a member Run
};

// A perfectly mixed vessel: E(t) = exp(-t / tau) / tau, mean tau, deviation tau, median tau ln 2 (Danckwerts 1953).
TEST_F(FlowTables, of_a_perfectly_mixed_vessel_have_its_exponential_distribution) {
  constexpr int kBodies = 20000;
  constexpr double kTau = 3, kMass = 0.02, kEnd = 100;
  std::string in, out;
  for (int n = 0; n < kBodies; ++n) {
    const double at = (n + 0.5) / kBodies;
    in += came_in(at * kEnd, n + 1, kMass, 0.01);
    // the n-th quantile, in an order that does not go with time
    const double quantile = (static_cast<double>((n * 7919LL) % kBodies) + 0.5) / kBodies;
    out += went_out(at * kEnd, n + 1, kMass, -kTau * std::log(1 - quantile));
  }
  write(in, out);
  const Flow flow = read_flow(run_, 0, kEnd, 10);
  ASSERT_EQ(flow.gates.size(), 2u);
  const Gate &inlet = flow.gates[0], &outlet = flow.gates[1];
  EXPECT_EQ(inlet.name, "inlet feed");
  EXPECT_EQ(outlet.name, "outlet chute");
  EXPECT_EQ(inlet.residence.count, 0u);
  for (const Gate* gate : {&inlet, &outlet}) {
    EXPECT_NEAR(gate->mass, kBodies * kMass, 1e-9);
    EXPECT_NEAR(gate->flow.mean, kBodies * kMass / kEnd, 1e-9);
    EXPECT_LT(gate->flow.ci95, 1e-9);  // as even as bodies can be: the same number in each interval
    EXPECT_NEAR(gate->cumulative.back(), gate->mass, 1e-9);
  }
  EXPECT_NEAR(outlet.residence.mean, kTau, 1e-3 * kTau);
  EXPECT_NEAR(outlet.deviation, kTau, 2e-3 * kTau);
  EXPECT_NEAR(outlet.median, kTau * std::log(2), 1e-3 * kTau);
  const Density density = residence_density(outlet);
  double area = 0;
  for (std::size_t k = 0; k < density.end.size(); ++k) {
    const double begin = density.end[k] - density.width, exact = std::exp(-begin / kTau) - std::exp(-density.end[k] / kTau);
    EXPECT_NEAR(density.value[k] * density.width, exact, 1.5 / kBodies) << k;
    EXPECT_NEAR(density.share[k], 1 - std::exp(-density.end[k] / kTau), 1.5 / kBodies) << k;
    area += density.value[k] * density.width;
  }
  EXPECT_NEAR(area, 1, 1e-12);
}

TEST_F(FlowTables, weigh_residence_times_and_sizes_by_mass) {
  // of each small one there are three large ones by mass: a body of 3 kg that stays 8 s and three of 1/3 kg that stay 4 s
  write(came_in(1, 1, 3, 0.2) + came_in(1, 2, 1.0 / 3, 0.1) + came_in(1, 3, 1.0 / 3, 0.1) + came_in(1, 4, 1.0 / 3, 0.1),
        went_out(5, 2, 1.0 / 3, 4) + went_out(5, 3, 1.0 / 3, 4) + went_out(5, 4, 1.0 / 3, 4) + went_out(9, 1, 3, 8));
  const Flow flow = read_flow(run_, 0, 10, 10);
  const Gate& outlet = flow.gates[1];
  EXPECT_DOUBLE_EQ(outlet.residence.mean, (1 * 4 + 3 * 8) / 4.0);
  EXPECT_DOUBLE_EQ(outlet.deviation, std::sqrt((1 * 9 + 3 * 1) / 4.0));
  EXPECT_EQ(outlet.median, 8);
  EXPECT_EQ(outlet.residence.smallest, 4);
  EXPECT_EQ(outlet.residence.largest, 8);
  const ShareCurve sizes = share_curve(outlet, &Passage::diameter);
  ASSERT_EQ(sizes.value.size(), 2u);
  EXPECT_EQ(sizes.value[0], 0.1);
  EXPECT_DOUBLE_EQ(sizes.share[0], 0.25);
  EXPECT_EQ(sizes.share[1], 1);
  EXPECT_EQ(flow_charts(flow).size(), 3u);
}

TEST_F(FlowTables, count_what_passed_within_the_chosen_time) {
  write(came_in(0, 1, 1, 0.1) + came_in(2, 2, 1, 0.1) + came_in(4, 3, 1, 0.1), went_out(3, 1, 1, 3) + went_out(6, 2, 1, 4));
  EXPECT_EQ(read_flow(run_, 0, 10, 10).gates[0].mass, 3);  // the start is part of the run
  const Flow later = read_flow(run_, 2, 4, 10);            // neither what came in at 2 s nor what left after 4 s
  EXPECT_EQ(later.gates[0].mass, 1);
  EXPECT_EQ(later.gates[1].mass, 1);
  EXPECT_DOUBLE_EQ(later.gates[1].flow.mean, 0.5);
  EXPECT_EQ(later.times.back(), 4);
}

TEST_F(FlowTables, know_bodies_of_the_scene_and_the_sides_of_the_domain) {
  Shape ball;
  ball.kind = ShapeKind::sphere;
  ball.sphere_radius = 0.5;
  ball.mass.volume = std::acos(-1.0) / 6;
  run_.scene.shapes.push_back(ball);
  run_.scene.settings.domain.outside = Outside::remove;
  BodyTable& b = run_.scene.bodies;
  b.id = {7};
  b.shape = {0};
  b.scale = {0.25};
  write("", went_out(1, 7, 2, 1, ""));
  EXPECT_EQ(failure(), "nothing was refused");
  const Flow flow = read_flow(run_, 0, 10, 10);
  ASSERT_EQ(flow.gates.size(), 3u);
  EXPECT_EQ(flow.gates[2].name, "sides of the domain");
  ASSERT_EQ(flow.gates[2].passed.size(), 1u);
  EXPECT_NEAR(flow.gates[2].passed[0].diameter, 0.25, 1e-15);
  EXPECT_EQ(flow.gates[1].residence.count, 0u);
}

TEST_F(FlowTables, that_end_within_a_row_are_read_and_damaged_ones_are_refused_with_their_line) {
  write(came_in(1, 1, 1, 0.1) + "1,2,2,1,0.", went_out(3, 1, 1, 2));
  EXPECT_EQ(read_flow(run_, 0, 10, 10).gates[0].passed.size(), 1u);
  write("1,2,2,1,0.\n" + came_in(1, 1, 1, 0.1), "");
  EXPECT_NE(failure().find("inserted.csv:3: 5 cells, expected 10"), std::string::npos) << failure();
  write("1,x,2,1,0.1,0,0,0,ball,feed\n", "");
  EXPECT_NE(failure().find("inserted.csv:3: time = 'x' is no number"), std::string::npos) << failure();
  write(came_in(1, 1, 1, 0.1, "hatch"), "");
  EXPECT_NE(failure().find("inserted.csv:3: the inlet 'hatch'"), std::string::npos) << failure();
  write(came_in(1, 1, 1, 0.1), went_out(3, 2, 1, 2));
  EXPECT_NE(failure().find("removed.csv:3: the body 2"), std::string::npos) << failure();
  write(came_in(1, 1, 1, 0.1), went_out(3, 1, 1, 2, ""));
  EXPECT_NE(failure().find("removed.csv:3: a side of the domain"), std::string::npos) << failure();
  std::filesystem::remove(run_.folder + "/removed.csv");
  const Flow flow = read_flow(run_, 0, 10, 10);  // as of a run that was copied without its tables
  EXPECT_TRUE(flow.empty());
  EXPECT_NE(flow.missing.find("removed.csv: is missing"), std::string::npos) << flow.missing;
}

TEST(Flow, of_a_closed_box_is_nothing) {
  const Flow flow = read_flow(scree::Run{}, 0, 1, 10);
  EXPECT_TRUE(flow.empty());
  EXPECT_TRUE(flow_tables(flow).empty());
  EXPECT_TRUE(flow_charts(flow).empty());
}

}  // namespace
}  // namespace scree
