// Edges side by side in lanes (solver/lanes/edge_lanes.hpp) against examine_edges(): the same features, to the bit, whatever the pairs
// are that share a vector; and what lanes leave is little.
#include "solver/lanes/edge_lanes.hpp"

#include <gtest/gtest.h>

#include "tests/solver/two_bodies.hpp"

namespace scree {
namespace {

using namespace test;

struct Counts {
  int found = 0, left = 0, faded = 0;
};

bool same(const ContactFeature& l, const ContactFeature& r) {
  return l.x == r.x && l.n == r.n && l.overlap == r.overlap && l.weight == r.weight && l.faded == r.faded &&
         (!l.faded || (l.weight_gradient.force == r.weight_gradient.force && l.weight_gradient.couple == r.weight_gradient.couple));
}

/// A pair near touch, with all edges that are near each other, whether they are features or not.
struct NearPair {
  std::unique_ptr<TwoBodies> bodies;
  RelativePose pose;
  CandidateLists lists;
  double margin;
};

std::vector<NearPair> near_pairs() {
  std::vector<NearPair> pairs;
  std::mt19937 g(11);
  const MeshDistanceScratchPtr scratch = make_mesh_distance_scratch();
  const auto add = [&](const TriangleMesh& a, const TriangleMesh& b, double scale_b, bool in_line) {
    NearPair near;
    near.bodies = std::make_unique<TwoBodies>(a, b, kStiffness, kMargin, 1, 0);
    TwoBodies& pair = *near.bodies;
    pair.body[1].scale = scale_b;
    place_at_random(pair, g);
    // edges of boxes that lie in line are parallel to rounding, or nearly so
    if (in_line) pair.body[0].q = normalised(Quat{1, 0, 0, pairs.size() % 2 == 0 ? 0.0 : 0.03} * pair.body[1].q);
    if (!pair.approach(2.2)) return;
    pair.body[0].x.z -= 0.6 * kMargin;  // deeper, where more edges meet
    near.margin = kMargin;
    near.pose = RelativePose(pair.body[0], pair.body[1]);
    ASSERT_TRUE(list_mesh_pair(pair.body[0], pair.body[1], kMargin, kSharingOfVertices * kMargin, 0.5 * kMargin, pair.radius(0),
                               pair.radius(1), *scratch, near.lists));
    pairs.push_back(std::move(near));
  };
  for (unsigned seed = 1; seed <= 90; ++seed) {
    add(scaled(rock(seed, 0), .5), scaled(rock(seed + 50, 1), .5), 1, false);
    add(scaled(rock(seed, 2), .5), rock(seed + 50, 2), 0.4, false);
    add(grid_box(1, {1, .6, .4}), grid_box(2, {1, .8, .9}), 1, true);
    add(grid_box(1, {1, .6, .4}), rock(seed, 1), 0.3, false);
  }
  return pairs;
}

/// Asks for all edges of all pairs, dealt out in turns so that each vector has edges of many pairs, and compares.
void compare(const std::vector<NearPair>& pairs, Counts& counts) {
  const auto queue = std::make_unique<EdgeQueue>();
  const auto answers = std::make_unique<EdgeAnswers>();
  std::vector<std::pair<std::size_t, std::size_t>> asked;  // pair, candidate
  std::size_t begin = 0, end = 0;
  const auto ask = [&] {
    examine_edges_at_once(*queue, *answers);
    for (std::size_t k = 0; k < asked.size(); ++k) {
      const NearPair& near = pairs[asked[k].first];
      const PairBody &a = near.bodies->body[0], &b = near.bodies->body[1];
      std::vector<ContactFeature> expected;
      examine_edges(a, b, near.pose, near.margin, std::min(near.bodies->radius(0), near.bodies->radius(1)),
                    near.lists.edges[asked[k].second], expected);
      ASSERT_EQ(answers->found(k), !expected.empty()) << asked[k].first << " " << asked[k].second;
      if (expected.empty()) {
        ++counts.left;
        continue;
      }
      const ContactFeature f = answers->feature(k);
      ASSERT_TRUE(same(f, expected[0])) << asked[k].first << " " << asked[k].second;
      ++counts.found;
      counts.faded += f.faded ? 1 : 0;
    }
    asked.clear();
    queue->count = 0;
  };
  for (; begin < pairs.size(); begin = end) {
    end = std::min(begin + kPosesAtOnce, pairs.size());
    for (std::size_t n = begin; n < end; ++n) {
      const NearPair& near = pairs[n];
      queue->poses[n - begin] = EdgePose(near.pose, near.bodies->body[0], near.bodies->body[1], near.margin);
    }
    bool some = true;
    for (std::size_t edge = 0; some; ++edge) {
      some = false;
      for (std::size_t n = begin; n < end; ++n) {
        const NearPair& near = pairs[n];
        if (edge >= near.lists.edges.size()) continue;
        some = true;
        const EdgeCandidate& candidate = near.lists.edges[edge];
        queue->add(n - begin, near.bodies->body[0].shape->edge_rows[static_cast<std::size_t>(candidate.edge_a)],
                   near.bodies->body[1].shape->edge_rows[static_cast<std::size_t>(candidate.edge_b)]);
        asked.emplace_back(n, edge);
        if (queue->count == kEdgesAtOnce) ask();
      }
    }
    ask();
  }
}

TEST(EdgeLanes, find_the_features_that_each_pair_of_edges_is_alone) {
  Counts counts;
  compare(near_pairs(), counts);
  EXPECT_GT(counts.found, 300);
  EXPECT_GT(counts.faded, 200);
  EXPECT_GT(counts.left, 100);
}

// Rows that are made and rows that are worked out at each call (large shapes) are the same.
TEST(EdgeLanes, rows_of_edges_are_what_large_shapes_work_out) {
  const SolverShape shape = make_solver_shape(make_solid("rock", rock(3, 2)));
  SolverShape without = shape;
  without.edge_rows.clear();
  ASSERT_EQ(shape.edge_rows.size(), shape.features.edges.size());
  for (std::int32_t e = 0; e < static_cast<std::int32_t>(shape.features.edges.size()); ++e) {
    EXPECT_EQ(shape.edge(e).start, without.edge(e).start);
    EXPECT_EQ(shape.edge(e).along, without.edge(e).along);
    for (int side = 0; side < 2; ++side) {
      EXPECT_EQ(shape.into_face(e, side), without.into_face(e, side));
      EXPECT_EQ(shape.edge_conormal(e, side), without.edge_conormal(e, side));
      EXPECT_EQ(shape.has_height(e, side), without.has_height(e, side));
      EXPECT_EQ(shape.edge_corner(e, side), without.edge_corner(e, side));
    }
  }
}

}  // namespace
}  // namespace scree
