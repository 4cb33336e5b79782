// docs/reference/validation-plan.md P1 at its full length: 200 rocks, 10^4 steps, up to seven ranks and eight threads, lists dropped at
// random.
#include <gtest/gtest.h>

#include "tests/solver/cut_contacts.hpp"
#include "tests/solver/rank_groups.hpp"
#include "tests/support/parallel_scenes.hpp"

namespace scree {
namespace {

using namespace test;

TEST(SameBits, of_a_pile_of_200_rocks_after_ten_thousand_steps_with_every_contact_found_on_the_way) {
  const Scene scene = dense_heap(5, 5, 8, 0.12);
  constexpr int kSteps = 10000;
  const Outcome alone = outcome_of(scene, 1, 1, kSteps);
  if (g_comm->rank() == 0) {
    EXPECT_GT(alone.contacts, 200 * 100);
  }
  for (const auto& [ranks, threads] : {std::pair{1, 4}, {1, 8}, {2, 2}, {4, 1}, {7, 1}}) {
    const Outcome o = outcome_of(scene, ranks, threads, kSteps);
    if (g_comm->rank() != 0) continue;
    EXPECT_EQ(o.hash, alone.hash) << ranks << " ranks x " << threads << " threads";
    // every 50 steps: a contact missed in between would have changed the state
    EXPECT_EQ(o.contacts, alone.contacts) << ranks << " ranks x " << threads << " threads";
  }
}

// 64 rocks on up to seven ranks: every part is cut faces, edges and corners.
TEST(Contacts, of_ten_thousand_steps_at_cuts_edges_and_corners_are_those_of_one_rank) {
  expect_contacts_of_one_rank(tumbling_box(4), 10000, {2, 3, 4, 5, 7});
}

// A column of rocks at one end of a long, tilted box falls over and slides to the other end. Two ranks: more do not fit the cores of a
// small machine, and processor time would then tell of caches and not of work.
TEST(Balance, is_kept_through_a_dam_break) {
  Scene scene = rock_scene();
  scene.settings.gravity = {7, 0, -7};
  add_box_walls(scene, {0, 0, 0}, {3, 0.4, 1.2});
  fill_lattice(scene, 8, 3, 8, {0.01, 0.01, 0.01}, 0.125, {0, 0, -0.3});
  on_ranks(2, [&](const mpi::Communicator& comm) {
    TestRun run(scene, comm);
    run.start();
    double sum = 0, mean_x_start = 0, mean_x = 0;
    int intervals = 0;
    const auto centre = [&] {
      return run.total([](const ParticleSet& p, std::size_t i) { return p.x[i]; }).x / static_cast<double>(scene.bodies.size());
    };
    mean_x_start = centre();
    run.simulation->decomposition().take_imbalance();
    for (int n = 1; n <= 24000; ++n) {
      run.simulation->advance();
      if (n % 1000 != 0) continue;
      const double imbalance = run.simulation->decomposition().take_imbalance(), x = centre();
      if (comm.rank() == 0)
        std::printf("step %d: mean x %.3f, imbalance %.3f, cuts %lld\n", n, x, imbalance,
                    static_cast<long long>(run.simulation->decomposition().cuts()));
      sum += imbalance;
      ++intervals;
    }
    mean_x = centre();
    if (comm.rank() != 0) return;
    EXPECT_GT(mean_x, mean_x_start + 0.6);
    EXPECT_GT(run.simulation->decomposition().cuts(), 0);
    EXPECT_LE(sum / intervals, 1.1);
  });
}

}  // namespace
}  // namespace scree
