// Candidates that wait (solver/features/candidate_slack.hpp) change nothing: lists that are kept while two bodies move about each other
// give in every step the features of lists made in that step, to the bit.
#include "solver/features/candidate_slack.hpp"

#include <gtest/gtest.h>

#include <cstring>

#include "tests/solver/two_bodies.hpp"

namespace scree {
namespace {

using namespace test;

struct Counts {
  int features = 0, edges = 0, renewed = 0, quiet = 0;
};

/// Bit for bit, but for what a constructor may leave unset.
bool same(const ContactFeature& l, const ContactFeature& r) {
  return l.key == r.key && l.x == r.x && l.n == r.n && l.overlap == r.overlap && l.weight == r.weight && l.cluster == r.cluster &&
         l.faded == r.faded && l.weight_gradient.force == r.weight_gradient.force && l.weight_gradient.couple == r.weight_gradient.couple;
}

/// Lets A wander about where it touches B, by steps of about `stride`, and compares.
void wander(TwoBodies& pair, double margin, double skin, double stride, int steps, std::mt19937& g, Counts& counts) {
  std::normal_distribution<double> n;
  const MeshDistanceScratchPtr scratch = make_mesh_distance_scratch();
  PairBody &a = pair.body[0], &b = pair.body[1];
  const double size = std::min(pair.radius(0), pair.radius(1));
  const auto list = [&](CandidateLists& lists) {
    return list_mesh_pair(a, b, margin, kSharingOfVertices * margin, skin, pair.radius(0), pair.radius(1), *scratch, lists);
  };
  CandidateLists kept;
  std::vector<ContactFeature> features, expected;
  Vec3 drift, turn;
  for (int step = 0; step < steps; ++step) {
    const RelativePose pose(a, b);
    if (kept.skin < 0 || follow_motion(kept, pose, pair.radius(0), pair.radius(1)) > kept.skin) {
      ASSERT_TRUE(list(kept));
      ++counts.renewed;
    }
    const double way = kept.way;
    mesh_pair_features(a, b, pose, margin, kSharingOfVertices * margin, size, kept, features);
    CandidateLists fresh;
    ASSERT_TRUE(list(fresh));
    mesh_pair_features(a, b, pose, margin, kSharingOfVertices * margin, size, fresh, expected);
    ASSERT_EQ(features.size(), expected.size()) << "step " << step;
    for (std::size_t j = 0; j < features.size(); ++j) {
      ASSERT_TRUE(same(features[j], expected[j])) << "step " << step << ", feature " << j;
      counts.edges += indices_of_key(features[j].key).kind == kEdgeEdge ? 1 : 0;
    }
    counts.features += static_cast<int>(features.size());
    if (features.empty() && kept.next_examination > way) ++counts.quiet;
    // a smooth way, pulled back to where the two touch and pushed away from deep overlap
    double deepest = 0;
    Vec3 out;
    for (const ContactFeature& f : features) {
      deepest = std::max(deepest, f.overlap);
      out += f.overlap * rotate(a.q, f.n);
    }
    const Vec3 apart = a.x - b.x;
    drift = 0.9 * drift + (0.3 * stride) * Vec3{n(g), n(g), n(g)};
    if (deepest > 0.3 * margin) drift += (2 * stride / length(out)) * out;
    if (features.empty()) drift -= (0.2 * stride / length(apart)) * apart;
    turn = 0.9 * turn + (0.3 * stride / size) * Vec3{n(g), n(g), n(g)};
    a.x += drift;
    if (const double angle = length(turn); angle > 0) a.q = normalised(quaternion_of((1 / angle) * turn, angle) * a.q);
    if (deepest > 0.7 * margin) {  // too deep: away, and new lists
      a.x += (margin / length(out)) * out;
      drift = {};
      kept = {};
    }
  }
}

void wander_from_touch(const TriangleMesh& a, const TriangleMesh& b, double skin, double stride, unsigned seed, int steps, Counts& counts) {
  std::mt19937 g(seed);
  TwoBodies pair(a, b, kStiffness, kMargin, 1, 0);
  place_at_random(pair, g);
  if (!pair.approach(2.2)) return;
  wander(pair, kMargin, skin, stride, steps, g, counts);
}

TEST(CandidateSlack, of_rocks_that_wander_about_each_other) {
  Counts counts;
  for (unsigned seed = 1; seed <= 6; ++seed) {
    for (const double stride : {1e-5, 2e-4, 2e-3})
      wander_from_touch(scaled(rock(seed, 2), .5), scaled(rock(seed + 10, 2), .5), .02, stride, seed, 300, counts);
  }
  EXPECT_GT(counts.features, 5000);
  EXPECT_GT(counts.edges, 1000);
  EXPECT_GT(counts.renewed, 50);
  EXPECT_GT(counts.quiet, 50);
}

TEST(CandidateSlack, of_bodies_with_flat_faces_parallel_edges_and_thin_wedges) {
  Counts counts;
  for (unsigned seed = 1; seed <= 6; ++seed) {
    for (const double stride : {2e-4, 2e-3}) {
      wander_from_touch(grid_box(1, {1, .2, .2}), grid_box(2, {1, .6, .4}), .02, stride, seed, 300, counts);
      wander_from_touch(rock(seed, 0), scaled(rock(seed + 3, 1), .3), .02, stride, seed, 300, counts);
    }
  }
  EXPECT_GT(counts.features, 3000);
  EXPECT_GT(counts.edges, 500);
}

TEST(CandidateSlack, of_a_small_body_on_a_large_one) {
  Counts counts;
  for (unsigned seed = 1; seed <= 4; ++seed)
    wander_from_touch(scaled(rock(seed, 2), .15), rock(seed + 5, 3), .015, 5e-4, seed, 300, counts);
  EXPECT_GT(counts.features, 500);
}

}  // namespace
}  // namespace scree
