// Walls are touched from both sides, whatever the winding of their triangles: each fold is an edge on the side on which it is convex, and
// none on the other side (core/geometry/features.hpp, solver/features/edge_features.hpp).
#include <gtest/gtest.h>

#include <random>

#include "solver/features/candidate_slack.hpp"
#include "solver/features/edge_features.hpp"
#include "solver/lanes/edge_lanes.hpp"
#include "tests/solver/two_bodies.hpp"

namespace scree {
namespace {

using namespace test;

enum class Winding { up, down, mixed };

/// A bumpy sheet of 2 x 2 about the origin: folds of up to 20 degrees, convex from above or from below.
TriangleMesh height_field(unsigned seed, int n, double height) {
  std::mt19937 g(seed);
  std::uniform_real_distribution<double> at(-height, height);
  TriangleMesh mesh;
  for (int i = 0; i <= n; ++i) {
    for (int j = 0; j <= n; ++j) mesh.vertices.push_back({2.0 * i / n - 1, 2.0 * j / n - 1, at(g)});
  }
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      const std::int32_t a = i * (n + 1) + j, b = a + n + 1;
      mesh.triangles.push_back({a, b, a + 1});
      mesh.triangles.push_back({a + 1, b, b + 1});
    }
  }
  return mesh;
}

TriangleMesh wound(TriangleMesh mesh, Winding winding) {
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (winding == Winding::down || (winding == Winding::mixed && t * 7 % 5 < 2)) std::swap(mesh.triangles[t][1], mesh.triangles[t][2]);
  }
  return mesh;
}

/// A body about to touch a wall.
struct OnWall {
  SolverShape wall;
  TwoBodies pair;
  OnWall(const TriangleMesh& body, const TriangleMesh& sheet)
      : wall(make_solver_shape(make_surface("wall", sheet))), pair(body, box_mesh({1, 1, 1}), kStiffness, kMargin, 1, 0) {
    pair.body[1].shape = &wall;
    pair.body[1].weights = nullptr;
  }
  double size() const { return std::min(pair.radius(0), pair.radius(1)); }
  bool list(double skin, CandidateLists& lists) {
    return list_mesh_pair(pair.body[0], pair.body[1], kMargin, kSharingOfVertices * kMargin, skin, pair.radius(0), pair.radius(1), *scratch,
                          lists);
  }
  void find(CandidateLists& lists, std::vector<ContactFeature>& features) {
    mesh_pair_features(pair.body[0], pair.body[1], RelativePose(pair.body[0], pair.body[1]), kMargin, kSharingOfVertices * kMargin, size(),
                       lists, features);
  }
  MeshDistanceScratchPtr scratch = make_mesh_distance_scratch();
};

bool is_edge(const ContactFeature& f) { return indices_of_key(f.key).kind == kEdgeEdge; }

/// By place: keys name edges in the order of a mesh.
void sort_by_place(std::vector<ContactFeature>& features) {
  std::sort(features.begin(), features.end(), [](const ContactFeature& l, const ContactFeature& r) {
    return std::tuple(is_edge(l), l.x.x, l.x.y, l.x.z) < std::tuple(is_edge(r), r.x.x, r.x.y, r.x.z);
  });
}

TEST(WallFolds, a_wall_of_any_winding_has_the_same_contacts_on_both_sides) {
  std::mt19937 g(5);
  int edges = 0, touches = 0;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const TriangleMesh body = seed % 2 == 0 ? scaled(rock(seed, 1), .5) : grid_box(1, {.9, .5, .3});
    const Quat turned = random_quaternion(g);
    const Vec3 place{0.3 * std::sin(seed), 0.3 * std::cos(seed), 0};
    for (const bool below : {false, true}) {
      std::vector<ContactFeature> expected;
      double height = 0;
      for (const Winding winding : {Winding::up, Winding::down, Winding::mixed}) {
        OnWall on(body, wound(height_field(seed, 8, 0.03), winding));
        on.pair.body[0].q = turned;
        on.pair.body[0].x = place;
        on.pair.body[1].q = below ? Quat{0, 1, 0, 0} : Quat{};
        if (winding == Winding::up) {
          ASSERT_TRUE(on.pair.approach(0.8));
          height = on.pair.body[0].x.z - 0.9 * kMargin;  // deeper, where more touches
        }
        on.pair.body[0].x.z = height;
        CandidateLists lists;
        if (!on.list(0.5 * kMargin, lists)) break;  // a corner is through
        std::vector<ContactFeature> features;
        on.find(lists, features);
        sort_by_place(features);
        if (winding == Winding::up) {
          expected = features;
          touches += features.empty() ? 0 : 1;
          for (const ContactFeature& f : features) edges += is_edge(f) ? 1 : 0;
          continue;
        }
        ASSERT_EQ(features.size(), expected.size()) << "seed " << seed << (below ? " below" : " above");
        for (std::size_t j = 0; j < features.size(); ++j) {
          EXPECT_LE(length(features[j].x - expected[j].x), 1e-14);
          EXPECT_LE(length(features[j].n - expected[j].n), 1e-12);
          EXPECT_NEAR(features[j].overlap, expected[j].overlap, 1e-14);
          EXPECT_NEAR(features[j].weight, expected[j].weight, 1e-10);
        }
      }
    }
  }
  EXPECT_GT(touches, 30);
  EXPECT_GT(edges, 20);
}

// A bar that lies across a shallow valley is touched by its corners; the edge of the valley has no contact with those of the bar, as that
// of a closed solid has none.
TEST(WallFolds, the_fold_of_a_valley_is_no_edge_and_that_of_a_ridge_is_one) {
  for (const double slope : {0.02, 0.1, 0.19, 0.5}) {
    for (const Winding winding : {Winding::up, Winding::down, Winding::mixed}) {
      for (const double sign : {-1.0, 1.0}) {
        TriangleMesh roof;
        roof.vertices = {{-1, -1, -sign * slope}, {0, -1, 0}, {1, -1, -sign * slope},
                         {-1, 1, -sign * slope},  {0, 1, 0},  {1, 1, -sign * slope}};
        roof.triangles = {{0, 1, 3}, {1, 4, 3}, {1, 2, 4}, {2, 5, 4}};
        OnWall on(grid_box(1, {.4, .2, .2}), wound(roof, winding));
        // half a margin over the ridge, or over the slopes with the outer one of its ends
        on.pair.body[0].x = {0.03, 0.1, 0.1 + 0.5 * kMargin + (sign < 0 ? 0.23 * slope : 0)};
        CandidateLists lists;
        ASSERT_TRUE(on.list(0.5 * kMargin, lists));
        std::vector<ContactFeature> features;
        on.find(lists, features);
        EXPECT_FALSE(features.empty());
        const auto edges = std::count_if(features.begin(), features.end(), is_edge);
        EXPECT_EQ(edges > 0, sign > 0) << "slope " << slope << ", " << edges << " edges";
      }
    }
  }
}

TEST(WallFolds, lanes_find_what_each_pair_of_edges_is_alone) {
  std::mt19937 g(8);
  int found = 0, left_in_folds = 0;
  for (unsigned seed = 1; seed <= 60; ++seed) {
    OnWall on(scaled(rock(seed, 1), .5), wound(height_field(seed, 8, 0.03), Winding::mixed));
    on.pair.body[0].q = random_quaternion(g);
    if (seed % 2 == 0) on.pair.body[1].q = {0, 1, 0, 0};
    ASSERT_TRUE(on.pair.approach(0.8));
    on.pair.body[0].x.z -= 0.7 * kMargin;
    const PairBody &a = on.pair.body[0], &b = on.pair.body[1];
    const RelativePose pose(a, b);
    EdgeQueue queue;
    EdgeAnswers answers;
    queue.poses[0] = EdgePose(pose, a, b, kMargin);
    queue.has_walls = true;
    std::vector<EdgeCandidate> asked;
    const auto ask = [&] {
      if (asked.empty()) return;
      examine_edges_at_once(queue, answers);
      for (std::size_t k = 0; k < asked.size(); ++k) {
        std::vector<ContactFeature> expected;
        examine_edges(a, b, pose, kMargin, on.size(), asked[k], expected);
        ASSERT_EQ(answers.found(k), !expected.empty()) << "seed " << seed;
        if (!expected.empty()) {
          const ContactFeature f = answers.feature(k);
          ASSERT_EQ(f.x, expected[0].x);
          ASSERT_EQ(f.weight, expected[0].weight);
          ++found;
        }
      }
      // without the walls' rule, folds would be taken for edges on their concave side
      queue.has_walls = false;
      EdgeAnswers without;
      examine_edges_at_once(queue, without);
      for (std::size_t k = 0; k < asked.size(); ++k) left_in_folds += without.found(k) && !answers.found(k) ? 1 : 0;
      queue.has_walls = true;
      asked.clear();
      queue.count = 0;
    };
    // all edges of the body against all of the wall
    for (std::int32_t ea = 0; ea < static_cast<std::int32_t>(a.shape->edge_rows.size()); ++ea) {
      for (std::int32_t eb = 0; eb < static_cast<std::int32_t>(b.shape->edge_rows.size()); ++eb) {
        if (EdgeLines(a, b, pose, ea, eb).distance() > kMargin) continue;
        queue.add(0, a.shape->edge_rows[static_cast<std::size_t>(ea)], b.shape->edge_rows[static_cast<std::size_t>(eb)]);
        asked.push_back({ea, eb, 0});
        if (queue.count == kEdgesAtOnce) ask();
      }
    }
    ask();
  }
  EXPECT_GT(found, 30);
  EXPECT_GT(left_in_folds, 10);
}

// Slacks of a wall (candidate_slack.hpp): lists that are kept give the features of lists made in each step, to the bit.
TEST(WallFolds, kept_lists_give_what_new_ones_give) {
  std::mt19937 g(3);
  std::normal_distribution<double> n;
  int edges = 0, renewed = 0;
  for (unsigned seed = 1; seed <= 12; ++seed) {
    OnWall on(seed % 2 == 0 ? scaled(rock(seed, 1), .5) : grid_box(1, {.6, .4, .3}), wound(height_field(seed, 10, 0.03), Winding::mixed));
    on.pair.body[0].q = random_quaternion(g);
    if (seed % 3 == 0) on.pair.body[1].q = {0, 1, 0, 0};
    ASSERT_TRUE(on.pair.approach(0.8));
    PairBody& a = on.pair.body[0];
    CandidateLists kept;
    std::vector<ContactFeature> features, expected;
    constexpr double kStride = 2e-4;
    Vec3 drift;
    for (int step = 0; step < 300; ++step) {
      const RelativePose pose(a, on.pair.body[1]);
      if (kept.skin < 0 || follow_motion(kept, pose, on.pair.radius(0), on.pair.radius(1)) > kept.skin) {
        ASSERT_TRUE(on.list(kMargin, kept));
        ++renewed;
      }
      on.find(kept, features);
      CandidateLists fresh;
      ASSERT_TRUE(on.list(kMargin, fresh));
      on.find(fresh, expected);
      ASSERT_EQ(features.size(), expected.size()) << "seed " << seed << ", step " << step;
      double deepest = 0;
      for (std::size_t j = 0; j < features.size(); ++j) {
        ASSERT_EQ(features[j].key, expected[j].key);
        ASSERT_EQ(features[j].x, expected[j].x);
        ASSERT_EQ(features[j].weight, expected[j].weight);
        edges += is_edge(features[j]) ? 1 : 0;
        deepest = std::max(deepest, features[j].overlap);
      }
      drift = 0.9 * drift + (0.5 * kStride) * Vec3{n(g), n(g), n(g)};
      drift.z += deepest > 0.4 * kMargin ? 2 * kStride : features.empty() ? -0.5 * kStride : 0;
      a.x += drift;
      a.q = normalised(quaternion_of(normalised(Vec3{n(g), n(g), n(g)}), 2 * kStride) * a.q);
    }
  }
  EXPECT_GT(edges, 1000);
  EXPECT_GT(renewed, 20);
}

}  // namespace
}  // namespace scree
