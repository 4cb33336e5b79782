// The same bits on any number of ranks and threads, whatever way the ranks work together. Runs on five ranks; smaller numbers
// are groups of them.
#include <gtest/gtest.h>
#include <cmath>

#include "tests/solver/rank_groups.hpp"
#include "tests/support/parallel_scenes.hpp"

namespace scree {
namespace {

using namespace test;

void expect_same_bits_everywhere(const Scene& scene, int steps, bool demand_migration) {
  const Outcome alone = outcome_of(scene, 1, 1, steps);
  if (g_comm->rank() == 0) { EXPECT_GT(alone.contacts, 0); }
  for (const int ranks : {1, 2, 3, 4, 5}) {
    for (const int threads : {1, 2}) {
      const Outcome o = outcome_of(scene, ranks, threads, steps);
      if (g_comm->rank() != 0) continue;
      EXPECT_EQ(o.hash, alone.hash) << ranks << " ranks x " << threads << " threads";
      EXPECT_EQ(o.contacts, alone.contacts) << ranks << " ranks x " << threads << " threads";
      if (ranks > 1) { EXPECT_GT(o.ghosts, 0); }
      if (ranks > 1 && demand_migration) { EXPECT_GT(o.migrated, 0) << ranks << " ranks"; }
    }
  }
}

TEST(SameBits, of_a_dense_heap_with_friction) { expect_same_bits_everywhere(dense_heap(), 900, false); }

TEST(SameBits, of_a_rotating_drum_whose_bodies_cross_ranks_while_they_touch) {
  expect_same_bits_everywhere(rotating_drum(), 1500, true);
}

TEST(SameBits, of_a_body_larger_than_three_parts_and_long_thin_bodies) { expect_same_bits_everywhere(slab_and_rods(), 800, false); }

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
      if (selection == HaloSelection::all) { EXPECT_GT(o.ghosts, ghosts_selected); }
    }
  }
  for (const CutMethod cut : {CutMethod::rib, CutMethod::hsfc, CutMethod::body}) {
    const Outcome o = outcome_of(scene, 4, 1, steps, {HaloStrategy::overlap, HaloSelection::selected, cut});
    if (g_comm->rank() == 0) { EXPECT_EQ(o.hash, alone.hash) << cut_method_name(cut); }
  }
}

// VALIDATION.md P2: rows in another order, the same ids.
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

// VALIDATION.md P3, on another number of ranks: everything that a checkpoint keeps, handed over in memory.
TEST(SameBits, after_a_restart_on_another_number_of_ranks) {
  for (const auto& [before, after] : {std::pair{1, 4}, {3, 2}, {5, 1}}) {
    std::vector<ParticleRecord> records;
    std::vector<PendingSprings> springs;
    std::vector<Vec3> impulse;
    double wall_work = 0, wall_dissipated = 0;
    std::int64_t step = 0;
    std::string whole, continued;
    on_ranks(before, [&](const mpi::Communicator& comm) {
      TestRun run(rotating_drum(), comm);
      run.start();
      for (int n = 0; n < 700; ++n) run.simulation->advance();
      std::vector<std::vector<ParticleRecord>> all(static_cast<std::size_t>(comm.size()));
      const ParticleSet& p = run.simulation->particles();
      for (std::size_t i = 0; i < p.owned; ++i) all[0].push_back(record_of(p, i));
      for (const auto& block : comm.exchange(all)) records.insert(records.end(), block.begin(), block.end());
      struct Spring {
        PairKey key;
        FrictionSpring spring;
      };
      std::vector<std::vector<Spring>> sent(static_cast<std::size_t>(comm.size()));
      for (const BodyPair& pair : run.simulation->pairs().pairs()) {
        if (!counts_here(pair, p)) continue;
        for (const FrictionSpring& s : pair.springs) sent[0].push_back({pair.key, s});
      }
      for (const auto& block : comm.exchange(sent)) {
        for (const Spring& s : block) {
          if (springs.empty() || springs.back().key != s.key) springs.push_back({s.key, {}});
          springs.back().springs.push_back(s.spring);
        }
      }
      step = run.simulation->step();
      for (int n = 0; n < 500; ++n) run.simulation->advance();
      whole = run.simulation->state_hash();
    });
    if (g_comm->rank() == 0) { EXPECT_FALSE(springs.empty()); }
    on_ranks(after, [&](const mpi::Communicator& comm) {
      // rank 0 holds all bodies; springs wait on every rank for the pairs that need them
      std::vector<std::int64_t> sizes{static_cast<std::int64_t>(springs.size()), step};
      MPI_Bcast(sizes.data(), 2, MPI_INT64_T, 0, comm.get());
      step = sizes[1];
      springs.resize(static_cast<std::size_t>(sizes[0]));
      for (PendingSprings& s : springs) {
        std::int64_t count = static_cast<std::int64_t>(s.springs.size());
        MPI_Bcast(&s.key, sizeof s.key, MPI_BYTE, 0, comm.get());
        MPI_Bcast(&count, 1, MPI_INT64_T, 0, comm.get());
        s.springs.resize(static_cast<std::size_t>(count));
        MPI_Bcast(s.springs.data(), static_cast<int>(s.springs.size() * sizeof(FrictionSpring)), MPI_BYTE, 0, comm.get());
      }
      TestRun run(rotating_drum(), comm);
      run.make();
      if (comm.rank() != 0) records.clear();
      run.simulation->start_from_records(records, springs, step, wall_work, wall_dissipated, impulse);
      for (int n = 0; n < 500; ++n) run.simulation->advance();
      continued = run.simulation->state_hash();
    });
    if (g_comm->rank() == 0) { EXPECT_EQ(continued, whole) << before << " ranks, then " << after; }
  }
}

// VALIDATION.md P5: forces between bodies cancel, also where both owners compute a pair. No wall, no gravity.
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
