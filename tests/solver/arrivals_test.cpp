// Bodies that join a run after its start, and leave it: the same bits on any number of ranks and after a restart. Runs on four ranks.
#include <gtest/gtest.h>
#include <unistd.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <filesystem>

#include "solver/run/checkpoint.hpp"
#include "tests/solver/rank_groups.hpp"
#include "tests/support/parallel_scenes.hpp"

namespace scree {
namespace {

using namespace test;

constexpr std::int64_t kFirstArrival = 1000;  // ids from here on are in no scene

/// Rocks that slide over the edge of a table and fall out of the domain.
Scene table_with_an_edge() {
  Scene scene = rock_scene();
  scene.shapes.push_back(make_solid("table", grid_box(1, {0.6, 0.4, 0.04})));

  Domain& domain = scene.settings.domain;
  domain.bounded = true;
  domain.lower = {-0.5, -0.5, -0.2};
  domain.upper = {0.25, 0.6, 1};
  domain.outside = Outside::remove;
  scene.shapes.resize(4);
  add_body(scene, 3, {0, 0, 0});
  scene.bodies.fixed.back() = 1;
  fill_lattice(scene, 3, 2, 1, {-0.1, -0.11, 0.03}, 0.108, {1.5, 0, -0.3});
  for (std::size_t b = 1; b < scene.bodies.size(); ++b) scene.bodies.shape[b] = static_cast<std::int32_t>(b % 3);
  return scene;
}

const Vec3 kVelocity{1.5, 0.1, -3};

BodyAtStart rock(std::int64_t id, double scale, const Vec3& position) {
  const auto shape = static_cast<std::int32_t>(id % 3);
  return {id, shape, 0, false, false, scale, position, quaternion_of({0, 0, 1}, 0.3), kVelocity, {3, 1, 0}};
}

/// What joins before a step; given by the last rank, so that most of it must travel.
void let_join(TestRun& run) {
  const std::int64_t step = run.simulation->step();
  if (step % 400 != 200) return;
  std::vector<ParticleRecord> mine;
  if (run.comm.rank() == run.comm.size() - 1) {
    const std::int64_t batch = step / 400;
    const Vec3 place{-0.3 + 0.14 * static_cast<double>(batch % 5), -0.13, batch < 5 ? 0.25 : 0.45};
    mine.push_back(make_record(*run.prepared, rock(kFirstArrival + 2 * batch, 1.05, place)));
    mine.push_back(make_record(*run.prepared, rock(kFirstArrival + 2 * batch + 1, 1.2, place + Vec3{0, 0.26, 0})));
  }
  run.simulation->add_bodies(mine);
}

void advance_to(TestRun& run, std::int64_t step) {
  while (run.simulation->step() < step) {
    let_join(run);
    run.simulation->advance();
  }
  run.simulation->agree_on_failures();
}

struct End {
  std::string hash;
  std::int64_t bodies = 0, arrived = 0;
  double removed = 0, arrived_energy = 0, dissipated = 0;
  bool operator==(const End&) const = default;
};

End end_of(TestRun& run) {
  const RunState& s = run.simulation->state();
  const Energies e = energies_of(s);
  return {state_hash(s), body_count(s), arrived_count(s), removed_totals(s).count, e.arrived, e.dissipated};
}

constexpr std::int64_t kRestart = 1500, kLast = 4000;

TEST(Arrivals, and_departures_give_the_same_bits_on_any_number_of_ranks_and_after_a_restart) {
  const Scene scene = table_with_an_edge();
  int process = static_cast<int>(getpid());
  MPI_Bcast(&process, 1, MPI_INT, 0, g_comm->get());
  const std::string folder = (std::filesystem::temp_directory_path() / fmt::format("scree_arrivals_{}", process)).string();
  if (g_comm->rank() == 0) std::filesystem::create_directories(folder);
  End alone;
  for (const int ranks : {1, 2, 4}) {
    End end;
    on_ranks(ranks, [&](const mpi::Communicator& comm) {
      TestRun run(scene, comm);
      run.start();
      advance_to(run, kRestart);
      if (ranks == 2) write_checkpoint(comm, *run.simulation, folder, {}, {});
      advance_to(run, kLast);
      end = end_of(run);
    });
    if (g_comm->rank() != 0) continue;
    if (ranks == 1) {
      alone = end;
      EXPECT_EQ(end.arrived, 20);
      EXPECT_GT(end.removed, 3);
      EXPECT_EQ(end.bodies + static_cast<std::int64_t>(end.removed), static_cast<std::int64_t>(scene.bodies.size()) + end.arrived);
      EXPECT_GT(end.dissipated, 0);
    }
    EXPECT_EQ(end.hash, alone.hash) << ranks << " ranks";
    EXPECT_TRUE(end == alone) << ranks << " ranks";
  }
  for (const int ranks : {1, 4}) {
    End end;
    on_ranks(ranks, [&](const mpi::Communicator& comm) {
      TestRun run(scene, comm);
      run.make();
      start_from_checkpoint(comm, *run.simulation, read_latest_checkpoint(comm, folder), Vec3{});
      EXPECT_EQ(run.simulation->step(), kRestart);
      EXPECT_GE(run.simulation->state().largest_id, kFirstArrival);
      advance_to(run, kLast);
      end = end_of(run);
    });
    if (g_comm->rank() == 0) {
      EXPECT_EQ(end.hash, alone.hash) << ranks << " ranks after a restart";
      EXPECT_TRUE(end == alone) << ranks << " ranks after a restart";
    }
  }
  if (g_comm->rank() == 0) std::filesystem::remove_all(folder);
}

TEST(Arrivals, have_the_place_and_velocity_they_are_given_and_bring_their_energy) {
  for (const bool wet : {false, true}) {
    TestRun run(wet ? in_water(rock_scene()) : rock_scene());
    run.scene.settings.step = 2e-5;
    add_body(run.scene, 0, {0, 0, 0});
    run.start();
    const double start = energies_of(run.simulation->state()).balance();
    for (int n = 0; n < 10; ++n) run.simulation->advance();
    std::vector<ParticleRecord> mine;
    if (g_comm->rank() == 0) mine.push_back(make_record(*run.prepared, rock(kFirstArrival, 1, {1, 2, 3})));
    run.simulation->add_bodies(mine);
    EXPECT_EQ(body_count(run.simulation->state()), 1);
    run.simulation->advance();
    EXPECT_EQ(body_count(run.simulation->state()), 2);
    const Vec3 x = run.position(kFirstArrival), v = run.velocity(kFirstArrival);
    EXPECT_EQ(x, (Vec3{1, 2, 3}));
    // drag of half a step in water: the rate of a rock of 4 cm at 3 m/s is some 30 / s
    EXPECT_LE(length(v - kVelocity), wet ? 100 * run.simulation->state().clock.dt : 1e-15);
    for (int n = 0; n < 300; ++n) run.simulation->advance();
    const Energies end = energies_of(run.simulation->state());
    EXPECT_GT(end.arrived, 0);
    EXPECT_NEAR(end.balance(), start, (wet ? 2e-4 : 1e-12) * end.arrived) << wet;
  }
}

/// The error with which a body is refused, "" when it is taken.
std::string refusal(TestRun& run, const BodyAtStart& body, ExitCode code) {
  std::vector<ParticleRecord> mine;
  if (g_comm->rank() == 0) mine.push_back(make_record(*run.prepared, body));
  try {
    run.simulation->add_bodies(mine);
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), code) << e.what();
    return e.what();
  }
  return "";
}

TEST(Arrivals, that_the_step_or_an_id_does_not_allow_are_refused_and_the_run_goes_on) {
  TestRun run(table_with_an_edge());
  run.start();
  const std::int64_t bodies = body_count(run.simulation->state());
  const std::string small = refusal(run, rock(kFirstArrival, 0.1, {0, 0, 0.5}), ExitCode::run_invalid);
  EXPECT_NE(small.find("body 1000"), std::string::npos) << small;
  EXPECT_NE(small.find("give time.step"), std::string::npos) << small;
  const std::string taken = refusal(run, rock(3, 1, {0, 0, 0.5}), ExitCode::bad_data);
  EXPECT_NE(taken.find("body 3"), std::string::npos) << taken;
  EXPECT_EQ(refusal(run, rock(kFirstArrival, 1, {0, 0, 0.5}), ExitCode::done), "");
  EXPECT_NE(refusal(run, rock(kFirstArrival, 1, {0, 0.2, 0.5}), ExitCode::bad_data), "");
  run.simulation->advance();
  run.simulation->agree_on_failures();
  EXPECT_EQ(body_count(run.simulation->state()), bodies + 1);
}

// A lighter body than all before has a shorter contact: a given step that is short enough takes it, and it is as stable as the others.
TEST(Arrivals, that_are_lighter_than_all_before_are_stable_where_the_step_allows_them) {
  TestRun run(rock_scene());
  run.scene.settings.step = 1e-5;
  add_plane(run.scene, {0, 0, 0}, {0, 0, 1});
  add_body(run.scene, 0, {0, 0, 0.1});
  run.start();
  const double radius = run.simulation->state().facts.smallest_radius, contact_time = run.simulation->state().clock.size.contact_time;
  EXPECT_EQ(refusal(run, rock(kFirstArrival, 0.3, {0.2, 0, 0.03}), ExitCode::done), "");
  run.simulation->advance();
  EXPECT_LT(run.simulation->state().facts.smallest_radius, 0.5 * radius);
  EXPECT_LT(run.simulation->state().clock.size.contact_time, 0.5 * contact_time);
  for (int n = 0; n < 20000; ++n) run.simulation->advance();
  run.simulation->agree_on_failures();
  const Energies e = energies_of(run.simulation->state());
  EXPECT_GT(e.dissipated, 0);
  EXPECT_LT(e.translational + e.rotational, e.arrived + e.dissipated);
  EXPECT_GT(contact_count(run.simulation->state()), 0);
}

}  // namespace
}  // namespace scree
