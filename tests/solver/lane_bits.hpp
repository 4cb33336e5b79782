// Pairs side by side in lanes against the general path, which runs where impacts are recorded.
#pragma once

#include <gtest/gtest.h>

#include <cstring>
#include <string>

#include "tests/support/test_run.hpp"

namespace scree::test {

template <class T>
inline bool same_bits(const T& a, const T& b) {
  return std::memcmp(&a, &b, sizeof(T)) == 0;
}

inline void expect_same_bodies(const ParticleSet& a, const ParticleSet& b) {
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (const auto column : {&ParticleSet::x, &ParticleSet::x_remainder, &ParticleSet::v, &ParticleSet::L, &ParticleSet::w,
                              &ParticleSet::force, &ParticleSet::torque, &ParticleSet::dissipative_force, &ParticleSet::dissipative_torque})
      EXPECT_TRUE(same_bits((a.*column)[i], (b.*column)[i])) << i;
    for (const auto column : {&ParticleSet::q, &ParticleSet::q_remainder}) EXPECT_TRUE(same_bits((a.*column)[i], (b.*column)[i])) << i;
  }
}

/// Runs of both ways; gives the hash of the last state.
inline std::string expect_same_bits(const Scene& scene, int steps) {
  Scene recorded = scene;
  recorded.settings.output_impacts = true;
  TestRun lanes(scene), general(recorded);
  lanes.start();
  general.start();
  std::int64_t contacts = 0, springs = 0;
  const bool had_failed = testing::Test::HasFailure();
  for (int n = 1; n <= steps; ++n) {
    lanes.simulation->advance();
    general.simulation->advance();
    if (n % 5 != 0) continue;
    const PairList &mine = lanes.simulation->state().pairs, &other = general.simulation->state().pairs;
    // lists of one may reach further than those of the other
    std::size_t k = 0, j = 0;
    while (k < mine.pairs().size() || j < other.pairs().size()) {
      const bool has_mine = k < mine.pairs().size() && (j == other.pairs().size() || !(other.pairs()[j].key < mine.pairs()[k].key));
      const bool has_other = j < other.pairs().size() && (k == mine.pairs().size() || !(mine.pairs()[k].key < other.pairs()[j].key));
      if (!has_mine || !has_other) {
        const PairList& list = has_mine ? mine : other;
        const std::size_t at = has_mine ? k++ : j++;
        EXPECT_FALSE(list.results()[at].active) << "a pair that one run alone has, in step " << n;
        EXPECT_TRUE(list.pairs()[at].state.springs.empty());
        continue;
      }
      const PairResult &r = mine.results()[k], &s = other.results()[j];
      EXPECT_EQ(r.active, s.active);
      if (r.active && s.active) {
        ++contacts;
        EXPECT_EQ(r.contact_count, s.contact_count);
        EXPECT_EQ(r.overlap_ratio, s.overlap_ratio);
        EXPECT_EQ(r.elastic, s.elastic);
        EXPECT_EQ(r.tangential_elastic, s.tangential_elastic);
        EXPECT_EQ(r.surface_power, s.surface_power);
        for (const auto part : {&PairResult::force_a, &PairResult::torque_a, &PairResult::torque_b, &PairResult::dissipative_force_a,
                                &PairResult::dissipative_torque_a, &PairResult::dissipative_torque_b})
          EXPECT_EQ(r.*part, s.*part) << k << " in step " << n;
      }
      const auto &kept = mine.pairs()[k].state.springs, &wanted = other.pairs()[j].state.springs;
      EXPECT_EQ(kept.size(), wanted.size());
      for (std::size_t m = 0; m < std::min(kept.size(), wanted.size()); ++m) {
        ++springs;
        EXPECT_TRUE(same_bits(kept[m], wanted[m])) << k << " in step " << n;
      }
      ++k;
      ++j;
    }
    if (!had_failed && testing::Test::HasFailure()) break;  // one step's differences say enough
  }
  EXPECT_GT(contacts, 1000);
  if (scene.pairs[0].friction > 0) {
    EXPECT_GT(springs, 1000);
  }
  expect_same_bodies(lanes.simulation->state().particles, general.simulation->state().particles);
  return state_hash(lanes.simulation->state());  // that of the other has what it recorded in it
}

}  // namespace scree::test
