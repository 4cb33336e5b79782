// The same bits on any number of ranks and threads, whatever way the ranks work together. Runs on five ranks; smaller numbers
// are groups of them.
#include <gtest/gtest.h>
#include <unistd.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <filesystem>

#include "solver/run/checkpoint.hpp"
#include "tests/solver/cut_contacts.hpp"
#include "tests/solver/rank_groups.hpp"
#include "tests/support/parallel_scenes.hpp"

namespace scree {
namespace {

using namespace test;

void expect_same_bits_everywhere(const Scene& scene, int steps, bool demand_migration) {
  const Outcome alone = outcome_of(scene, 1, 1, steps);
  if (g_comm->rank() == 0) {
    EXPECT_GT(alone.contacts, 0);
  }
  for (const int ranks : {1, 2, 3, 4, 5}) {
    for (const int threads : {1, 2}) {
      const Outcome o = outcome_of(scene, ranks, threads, steps);
      if (g_comm->rank() != 0) continue;
      EXPECT_EQ(o.hash, alone.hash) << ranks << " ranks x " << threads << " threads";
      EXPECT_EQ(o.contacts, alone.contacts) << ranks << " ranks x " << threads << " threads";
      if (ranks > 1) {
        EXPECT_GT(o.ghosts, 0);
      }
      if (ranks > 1 && demand_migration) {
        EXPECT_GT(o.migrated, 0) << ranks << " ranks";
      }
    }
  }
}

TEST(SameBits, of_a_dense_heap_with_friction) { expect_same_bits_everywhere(dense_heap(), 900, false); }

TEST(SameBits, of_a_rotating_drum_whose_bodies_cross_ranks_while_they_touch) { expect_same_bits_everywhere(rotating_drum(), 1500, true); }

TEST(SameBits, of_a_body_larger_than_three_parts_and_long_thin_bodies) { expect_same_bits_everywhere(slab_and_rods(), 800, false); }

TEST(SameBits, of_bodies_that_cross_ranks_and_the_seams_of_periodic_axes) { expect_same_bits_everywhere(periodic_bed(), 800, true); }

TEST(SameBits, of_an_elastic_layer_with_friction) { expect_same_bits_everywhere(layered_heap(), 900, false); }

TEST(SameBits, of_a_heap_that_settles_in_a_stream) { expect_same_bits_everywhere(in_water(dense_heap(2, 2, 3)), 700, false); }

TEST(SameBits, of_a_heap_that_sticks) { expect_same_bits_everywhere(sticky(dense_heap(2, 2, 3)), 900, false); }

TEST(SameBits, of_a_heap_with_liquid_bridges) { expect_same_bits_everywhere(wet(dense_heap(2, 2, 3)), 900, false); }

TEST(SameBits, of_a_heap_whose_contacts_yield) { expect_same_bits_everywhere(plastic(dense_heap(2, 2, 3)), 900, false); }

TEST(SameBits, of_balls_that_stick_by_necks) { expect_same_bits_everywhere(necked_heap(), 900, false); }

TEST(SameBits, of_an_elastic_layer_that_sticks) { expect_same_bits_everywhere(sticky_layers(), 500, false); }

TEST(SameBits, with_ranks_that_own_nothing) {
  const Scene scene = three_rocks();
  const Outcome alone = outcome_of(scene, 1, 1, 1500), five = outcome_of(scene, 5, 1, 1500);
  if (g_comm->rank() != 0) return;
  EXPECT_GT(alone.contacts, 0);
  EXPECT_EQ(five.hash, alone.hash);
  EXPECT_EQ(five.owned_least, 0);
}

TEST(SameBits, whatever_is_sent_when_and_however_bodies_are_shared_out) {
  const Scene scene = rotating_drum();
  const int steps = 1000;
  const Outcome alone = outcome_of(scene, 1, 1, steps);
  std::int64_t ghosts_selected = 0;
  for (const HaloStrategy strategy : {HaloStrategy::overlap, HaloStrategy::blocking}) {
    for (const HaloSelection selection : {HaloSelection::selected, HaloSelection::all}) {
      const Outcome o = outcome_of(scene, 3, 1, steps, {strategy, selection, CutMethod::rcb});
      if (g_comm->rank() != 0) continue;
      EXPECT_EQ(o.hash, alone.hash);
      if (selection == HaloSelection::selected) ghosts_selected = o.ghosts;
      if (selection == HaloSelection::all) {
        EXPECT_GT(o.ghosts, ghosts_selected);
      }
    }
  }
  for (const CutMethod cut : {CutMethod::rib, CutMethod::hsfc, CutMethod::body}) {
    const Outcome o = outcome_of(scene, 4, 1, steps, {HaloStrategy::overlap, HaloSelection::selected, cut});
    if (g_comm->rank() == 0) {
      EXPECT_EQ(o.hash, alone.hash) << cut_method_name(cut);
    }
  }
}

// docs/reference/validation-plan.md P2: rows in another order, the same ids.
TEST(SameBits, for_bodies_in_another_order) {
  const Scene scene = dense_heap(2, 2, 3);
  Scene shuffled = scene;
  BodyTable& b = shuffled.bodies;
  for (std::size_t i = 0; i < b.size() / 2; ++i) {
    const std::size_t j = b.size() - 1 - i;
    std::swap(b.id[i], b.id[j]);
    std::swap(b.shape[i], b.shape[j]);
    std::swap(b.position[i], b.position[j]);
    std::swap(b.orientation[i], b.orientation[j]);
    std::swap(b.velocity[i], b.velocity[j]);
    std::swap(b.angular_velocity[i], b.angular_velocity[j]);
  }
  for (const int ranks : {1, 2}) {
    const Outcome one = outcome_of(scene, ranks, 1, 600), other = outcome_of(shuffled, ranks, 1, 600);
    if (g_comm->rank() != 0) continue;
    EXPECT_GT(one.contacts, 0);
    EXPECT_EQ(one.hash, other.hash);
  }
}

// docs/reference/validation-plan.md P3, on another number of ranks: state, springs, and what was added up since the start.
TEST(SameBits, after_a_restart_on_another_number_of_ranks) {
  int process = static_cast<int>(getpid());
  MPI_Bcast(&process, 1, MPI_INT, 0, g_comm->get());
  constexpr int kStepsBefore = 770;  // by then there are springs in every scene
  const std::string folder = (std::filesystem::temp_directory_path() / fmt::format("scree_restart_{}", process)).string();
  for (const auto& [before, after] : {std::pair{1, 4}, {2, 3}, {3, 2}, {5, 1}}) {
    const Scene drum = before == 2   ? wet(rotating_drum())
                       : before == 3 ? in_water(rotating_drum())
                       : before == 5 ? sticky(rotating_drum())
                                     : rotating_drum();
    if (g_comm->rank() == 0) std::filesystem::create_directories(folder);
    std::string whole, continued;
    Vec3 whole_impulse, continued_impulse;
    const auto finish = [](TestRun& run, std::string& hash, Vec3& impulse) {
      for (int n = 0; n < 500; ++n) run.simulation->advance();
      hash = state_hash(run.simulation->state());
      impulse = wall_loads_of(run.simulation->state())[0].impulse;
    };
    on_ranks(before, [&](const mpi::Communicator& comm) {
      TestRun run(drum, comm);
      run.start();
      for (int n = 0; n < kStepsBefore; ++n) run.simulation->advance();
      write_checkpoint(comm, *run.simulation, folder, {}, {});
      finish(run, whole, whole_impulse);
    });
    on_ranks(after, [&](const mpi::Communicator& comm) {
      TestRun run(drum, comm);
      run.make();
      Checkpoint checkpoint = read_latest_checkpoint(comm, folder);
      const std::int64_t springs = comm.sum(static_cast<std::int64_t>(checkpoint.states.size()));
      if (comm.rank() == 0) {
        EXPECT_GT(springs, 0);
      }
      start_from_checkpoint(comm, *run.simulation, std::move(checkpoint), Vec3{});
      EXPECT_EQ(run.simulation->step(), kStepsBefore);
      finish(run, continued, continued_impulse);
    });
    if (g_comm->rank() == 0) {
      EXPECT_EQ(continued, whole) << before << " ranks, then " << after;
      EXPECT_EQ(continued_impulse, whole_impulse) << before << " ranks, then " << after;
      std::filesystem::remove_all(folder);
    }
  }
}

// docs/reference/validation-plan.md P4: blocks that friction alone holds on a tilted belt ride through the cuts. The first cut stays,
// and posts next to the belt put it in the way of the blocks. A block that lost its springs there would slip by their stretch,
// m g_x / k_t = 4e-5 m.
TEST(Migration, keeps_the_springs_of_blocks_that_friction_holds) {
  const double margin = 0.002, stiffness = 2e5, speed = 0.5, side = 0.1;
  Scene scene = empty_scene(stiffness, 0.2, 0.5, margin);
  scene.settings.gravity = {-3, 0, -9};  // a slope of 18 degrees; friction holds up to 27
  scene.settings.steps_per_contact = 30;
  scene.shapes = {make_solid("block", grid_box(1, {side, side, side})), make_solid("post", grid_box(1, {0.02, 0.02, 0.02}))};
  add_plane(scene, {0, 0, 0}, {0, 0, 1});
  scene.walls[0].motion.kind = Translate{.axis = {1, 0, 0}, .rate = speed};
  scene.walls[0].motion.stop = 1e300;
  const double mass = 1000 * side * side * side, overlap = mass * 9 / (std::sqrt(2.0) * stiffness);
  constexpr int kBlocks = 3;
  for (int i = 0; i < kBlocks; ++i) add_body(scene, 0, {0.3 * i, 0, side / 2 + 2 * margin - overlap}, {}, {speed, 0, 0});
  for (int i = 0; i < 12; ++i) {
    add_body(scene, 1, {0.2 * i, 1, 0.1});
    scene.bodies.fixed.back() = 1;
  }
  std::string alone;
  for (const int ranks : {1, 2, 4}) {
    std::string hash;
    std::int64_t migrated = 0;
    on_ranks(ranks, [&](const mpi::Communicator& comm) {
      ParallelOptions first_cut_only;
      first_cut_only.cuts_again = false;
      TestRun run(scene, comm);
      run.start(first_cut_only);
      const auto on_belt = [&](int block) { return run.position(scene.bodies.id[block]).x - speed * run.simulation->time(); };
      run.run_for(0.5);  // the load comes at once, so they rock and creep a little first
      std::vector<double> before;
      for (int i = 0; i < kBlocks; ++i) before.push_back(on_belt(i));
      const std::int64_t until_here = comm.sum(run.simulation->decomposition().migrated());
      run.run_for(1.0);
      for (int i = 0; i < kBlocks; ++i) {
        EXPECT_NEAR(on_belt(i), before[i], 1e-9) << "block " << i << " slipped on " << ranks << " ranks";
      }
      migrated = comm.sum(run.simulation->decomposition().migrated()) - until_here;
      hash = state_hash(run.simulation->state());
    });
    if (g_comm->rank() != 0) continue;
    if (ranks == 1) alone = hash;
    EXPECT_EQ(hash, alone) << ranks << " ranks";
    if (ranks > 1) {
      EXPECT_GE(migrated, 1) << ranks << " ranks";
    }
  }
}

// At length: parallel_slow_test.cpp.
TEST(Contacts, of_every_step_at_cuts_and_their_edges_are_those_of_one_rank) {
  expect_contacts_of_one_rank(tumbling_box(4), 500, {2, 3, 4, 5});
}

// docs/reference/validation-plan.md P5: forces between bodies cancel, also where both owners compute a pair. No wall, no gravity.
TEST(Forces, between_bodies_cancel_across_ranks) {
  Scene scene = rock_scene();
  scene.settings.gravity = {};
  fill_lattice(scene, 4, 4, 4, {-0.21, -0.21, -0.21}, 0.105, {});
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) scene.bodies.velocity[i] = -3.0 * scene.bodies.position[i];  // inwards
  on_ranks(5, [&](const mpi::Communicator& comm) {
    TestRun run(scene, comm);
    run.start();
    double largest = 0;
    for (int n = 0; n < 800; ++n) {
      run.simulation->advance();
      if (n % 10 != 0) continue;
      const Vec3 sum = run.total([](const ParticleSet& p, std::size_t i) { return p.force[i]; });
      const double scale = run.total([](const ParticleSet& p, std::size_t i) { return Vec3{length(p.force[i]), 0, 0}; }).x;
      if (scale > 0) largest = std::max(largest, length(sum) / scale);
    }
    EXPECT_GT(largest, 0) << "no contact";
    EXPECT_LE(largest, 1e-13);
  });
}

}  // namespace
}  // namespace scree
