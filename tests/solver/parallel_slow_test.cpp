// VALIDATION.md P1 at its full length: 200 rocks, 10^4 steps, up to seven ranks and eight threads, lists dropped at random.
#include <gtest/gtest.h>

#include "tests/solver/rank_groups.hpp"
#include "tests/support/parallel_scenes.hpp"

namespace scree {
namespace {

using namespace test;

TEST(SameBits, of_a_pile_of_200_rocks_after_ten_thousand_steps_with_every_contact_found_on_the_way) {
  const Scene scene = dense_heap(5, 5, 8, 0.12);
  constexpr int kSteps = 10000;
  const Outcome alone = outcome_of(scene, 1, 1, kSteps);
  if (g_comm->rank() == 0) { EXPECT_GT(alone.contacts, 200 * 100); }
  for (const auto& [ranks, threads] : {std::pair{1, 4}, {1, 8}, {2, 2}, {4, 1}, {7, 1}}) {
    const Outcome o = outcome_of(scene, ranks, threads, kSteps);
    if (g_comm->rank() != 0) continue;
    EXPECT_EQ(o.hash, alone.hash) << ranks << " ranks x " << threads << " threads";
    // every 50 steps: a contact missed in between would have changed the state
    EXPECT_EQ(o.contacts, alone.contacts) << ranks << " ranks x " << threads << " threads";
  }
}

}  // namespace
}  // namespace scree
