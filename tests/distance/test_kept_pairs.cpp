// Kept lists of triangle pairs: every step of every path against all pairs of triangles, one by one.
#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>

#include "tests/benchmarks/candidates/all_pairs.hpp"
#include "tests/benchmarks/candidates/trajectories.hpp"
#include "tests/benchmarks/distance/methods/kept_pairs.hpp"

namespace scree {
namespace {

/// Long versions of the tests run where SCREE_SLOW_TESTS is set: at_length in CMakeLists.txt.
bool at_length() { return std::getenv("SCREE_SLOW_TESTS") != nullptr; }

/// A corner placed in a scalar and in a vector differs by a few roundoffs of its coordinates (below 4 here).
constexpr double kRounding = 1e-14;

struct Outcome {
  std::int64_t misses = 0, close = 0;
  KeptPairs::Counts counts;
};

Outcome follow(const BenchShape& a, const BenchShape& b, double ratio, double margin, double speed, Path kind, int steps,
               std::uint64_t seed, double skin = 0) {
  const KeptPairsScratchPtr scratch = make_kept_pairs_scratch();
  Trajectory path(a, b, ratio, margin, speed, kind, seed);
  KeptPairs kept;
  kept.fix_skin(skin);
  AllPairs reference;
  std::vector<ClosePair> close;
  Outcome outcome;
  for (int step = 0; step < steps; ++step) {
    const Placement p = path.placement();
    const bool intersecting = kept.update(a.view(), b.view(), p, margin, *scratch, close);
    double least = 0;
    const std::vector<ClosePair> expected = reference.below_by_balls(a.view(), b.view(), p, margin, least);
    EXPECT_EQ(intersecting, least == 0) << "step " << step;
    outcome.misses += count_differences(close, expected, margin, kRounding);
    outcome.close += static_cast<std::int64_t>(expected.size());
    EXPECT_EQ(kept.memory(), 8 * kept.pair_count());
    path.advance();
  }
  outcome.counts = kept.counts();
  return outcome;
}

TEST(KeptPairs, misses_no_pair_along_paths_of_rolling_spinning_sliding_shaking_and_tumbling_rocks) {
  std::vector<BenchShape> rocks;
  for (int level = 0; level < 3; ++level) rocks.emplace_back(test::rock(static_cast<unsigned>(level + 3), level, 0.22));
  const int steps = at_length() ? 10000 : 150;
  for (const auto& [name, path] : all_paths()) {
    for (const double speed : {1e-3, 1e-2}) {
      Outcome sum;
      for (std::size_t k = 0; k < 2; ++k) {
        const Outcome o = follow(rocks[k], rocks[k + 1], k == 0 ? 1 : 0.4, 0.03, speed, path, steps, 7 * k + 1);
        EXPECT_EQ(o.misses, 0) << name << " at " << speed << ", rocks " << k;
        sum.close += o.close;
        sum.counts.scanned += o.counts.scanned;
        sum.counts.lists += o.counts.lists;
        sum.counts.filtered += o.counts.filtered + o.counts.decided;
      }
      EXPECT_GT(sum.close, steps / 4) << name << ": the bodies must touch for the test to mean something";
      // the list is worth its name: it serves several steps, and most of it is not looked at
      EXPECT_LT(sum.counts.lists, 2 * steps / 3) << name << " at " << speed;
      EXPECT_LT(sum.counts.filtered, sum.counts.scanned) << name << " at " << speed;
    }
  }
}

TEST(KeptPairs, misses_no_pair_with_any_skin) {
  const BenchShape a(test::rock(1, 1, 0.22)), b(test::rock(2, 1, 0.22));
  for (const double skin : {1e-6, 1e-3, 0.03, 0.5, 10.0})
    EXPECT_EQ(follow(a, b, 1, 0.02, 3e-3, Path::tumble, at_length() ? 3000 : 100, 4, skin).misses, 0) << "skin " << skin;
}

TEST(KeptPairs, misses_no_pair_of_bodies_far_apart_in_size_or_without_a_margin) {
  const BenchShape a(test::rock(1, 2, 0.22)), b(test::rock(2, 1, 0.22));
  for (const double ratio : {0.01, 0.1, 10.0})
    EXPECT_EQ(
        follow(a, b, ratio, 0.05 * std::min(1.0, ratio), 1e-2 * std::min(1.0, ratio), Path::tumble, at_length() ? 3000 : 100, 5).misses, 0)
        << "ratio " << ratio;
  EXPECT_EQ(follow(a, b, 1, 0, 1e-2, Path::slide, 100, 6).misses, 0) << "no margin: only pairs that intersect";
}

TEST(KeptPairs, finds_intersecting_pairs_as_such) {
  const BenchShape a(test::rock(1, 2, 0.22)), b(test::rock(2, 2, 0.22));
  const KeptPairsScratchPtr scratch = make_kept_pairs_scratch();
  KeptPairs kept;
  AllPairs reference;
  std::vector<ClosePair> close;
  bool apart = false, through = false;
  for (int step = 0; step < 120; ++step) {
    Placement p;
    p.translation = {3.5 - 0.02 * step, 0.1, 0.2};
    const bool intersecting = kept.update(a.view(), b.view(), p, 0.02, *scratch, close);
    double least = 0;
    EXPECT_EQ(count_differences(close, reference.below(a.view(), b.view(), p, 0.02, least), 0.02, kRounding), 0) << "step " << step;
    EXPECT_EQ(intersecting, least == 0);
    apart = apart || !intersecting;
    through = through || intersecting;
  }
  EXPECT_TRUE(apart && through);
}

TEST(KeptPairs, follows_a_body_that_is_put_elsewhere_and_a_margin_that_changes) {
  const BenchShape a(test::rock(1, 1, 0.22)), b(test::rock(2, 1, 0.22));
  const KeptPairsScratchPtr scratch = make_kept_pairs_scratch();
  KeptPairs kept;
  AllPairs reference;
  std::vector<ClosePair> close;
  Random random(3);
  std::int64_t found = 0;
  for (int step = 0; step < 200; ++step) {
    Placement p = relative_placement({}, random.rotation(), 1, random.uniform(1.6, 2.4) * random.direction(), random.rotation(),
                                     step % 50 < 25 ? 1 : 1.1);
    const double margin = 0.01 * (1 + step / 10 % 5);
    kept.update(a.view(), b.view(), p, margin, *scratch, close);
    double least = 0;
    EXPECT_EQ(count_differences(close, reference.below(a.view(), b.view(), p, margin, least), margin, kRounding), 0) << "step " << step;
    found += static_cast<std::int64_t>(close.size());
  }
  EXPECT_GT(found, 100);
}

TEST(KeptPairs, of_shapes_with_more_than_65536_triangles_take_12_bytes) {
  // an open sheet of 2 * 190^2 triangles, and a rock that slides over its far corner, where indices are large
  TriangleMesh sheet;
  const std::int32_t n = 190;
  for (std::int32_t i = 0; i <= n; ++i)
    for (std::int32_t j = 0; j <= n; ++j) sheet.vertices.push_back({0.05 * (i - n / 2), 0.05 * (j - n / 2), 0.01 * ((7 * i + 3 * j) % 5)});
  for (std::int32_t i = 0; i < n; ++i)
    for (std::int32_t j = 0; j < n; ++j) {
      const std::int32_t v = i * (n + 1) + j;
      sheet.triangles.push_back({v, v + n + 1, v + 1});
      sheet.triangles.push_back({v + 1, v + n + 1, v + n + 2});
    }
  const BenchShape floor(std::move(sheet)), rock(test::rock(2, 0, 0.22));
  ASSERT_GT(floor.mesh.triangle_count(), 65536);
  const KeptPairsScratchPtr scratch = make_kept_pairs_scratch();
  KeptPairs kept;
  AllPairs reference;
  std::vector<ClosePair> close;
  std::int32_t largest = 0;
  for (int step = 0; step < 12; ++step) {
    Placement p;
    p.scale = 0.3;
    p.rotation = matrix_of(quaternion_of(Vec3{0, 1, 0}, 0.01 * step));
    p.translation = {4.3 - 0.005 * step, 4.4, 0.36};
    kept.update(floor.view(), rock.view(), p, 0.05, *scratch, close);
    double least = 0;
    EXPECT_EQ(count_differences(close, reference.below(floor.view(), rock.view(), p, 0.05, least), 0.05, kRounding), 0) << "step " << step;
    for (const ClosePair& c : close) largest = std::max(largest, c.pair.a);
    EXPECT_EQ(kept.memory(), 12 * kept.pair_count());
  }
  EXPECT_GT(largest, 65536);
}

TEST(KeptPairs, takes_a_wider_skin_for_faster_bodies) {
  const BenchShape a(test::rock(1, 2, 0.22)), b(test::rock(2, 2, 0.22));
  const KeptPairsScratchPtr scratch = make_kept_pairs_scratch();
  std::vector<ClosePair> close;
  double last = 0;
  for (const double speed : {1e-4, 1e-3, 1e-2}) {
    Trajectory path(a, b, 1, 0.02, speed, Path::tumble, 8);
    KeptPairs kept;
    for (int step = 0; step < 3000; ++step) {
      kept.update(a.view(), b.view(), path.placement(), 0.02, *scratch, close);
      path.advance();
    }
    EXPECT_GT(kept.skin(), 1.2 * last) << speed;
    last = kept.skin();
  }
}

TEST(KeptPairs, of_an_empty_mesh_are_none) {
  const BenchShape rock(test::rock(1, 0, 0.22)), none(TriangleMesh{});
  const KeptPairsScratchPtr scratch = make_kept_pairs_scratch();
  KeptPairs kept;
  std::vector<ClosePair> close = {{{1, 2}, 3}};
  EXPECT_FALSE(kept.update(none.view(), rock.view(), {}, 1, *scratch, close));
  EXPECT_TRUE(close.empty());
}

TEST(KeptPairs, misses_no_pair_of_rocks_of_1280_triangles) {
  const BenchShape a(test::rock(11, 3, 0.22)), b(test::rock(12, 3, 0.22));
  const int steps = at_length() ? 10000 : 40;
  for (const auto& [name, path] : all_paths()) {
    const Outcome o = follow(a, b, 1, 0.01, 1e-3, path, steps, 5);
    EXPECT_EQ(o.misses, 0) << name;
    EXPECT_GT(o.close, steps / 4) << name;
  }
}

/// Poses of rocks near contact: the descent, the distance and the test for intersections against all pairs.
void compare_poses(int level, int poses, double nearest, double farthest, std::uint64_t seed) {
  std::vector<BenchShape> rocks;
  for (unsigned k = 0; k < 4; ++k) rocks.emplace_back(test::rock(k + 20, level, 0.22));
  const MeshDistanceScratchPtr scratch = make_mesh_distance_scratch();
  AllPairs reference;
  std::vector<TrianglePair> pairs;
  std::vector<ClosePair> found;
  Random random(seed);
  std::int64_t within = 0, apart = 0, through = 0, misses = 0;
  for (int pose = 0; pose < poses; ++pose) {
    const BenchShape &a = rocks[static_cast<std::size_t>(pose % 4)], &b = rocks[static_cast<std::size_t>(pose / 4 % 4)];
    const double reach = random.uniform(0, 0.1);
    Placement near;
    near.rotation = matrix_of(random.rotation());
    near.translation = random.uniform(nearest, farthest) * random.direction();
    double least = 0;
    const std::vector<ClosePair> expected = reference.below_by_balls(a.view(), b.view(), near, reach, least);
    EXPECT_EQ(triangle_pairs_within(a.view(), b.view(), near, reach, *scratch, pairs), least == 0) << "pose " << pose;
    EXPECT_EQ(meshes_intersect(a.view(), b.view(), near, *scratch), least == 0) << "pose " << pose;
    EXPECT_NEAR(mesh_distance(a.view(), b.view(), near, 1e308, *scratch), least, kRounding) << "pose " << pose;
    found.clear();
    for (const TrianglePair& pair : pairs) {
      const auto known = std::find_if(expected.begin(), expected.end(), [&](const ClosePair& c) { return c.pair == pair; });
      found.push_back({pair, known == expected.end() ? reach : known->distance});
    }
    misses += count_differences(found, expected, reach, kRounding);
    within += static_cast<std::int64_t>(expected.size());
    (least == 0 ? through : apart) += 1;
  }
  EXPECT_EQ(misses, 0);
  EXPECT_GT(within, poses);
  EXPECT_GT(apart, poses / 10);
  EXPECT_GT(through, poses / 100);
}

TEST(SearchByDescent, misses_no_pair_in_random_poses) { compare_poses(1, at_length() ? 100000 : 1000, 1.4, 2.6, 77); }

TEST(SearchByDescent, misses_no_pair_of_rocks_of_1280_triangles_in_random_poses) {
  if (!at_length()) return compare_poses(3, 20, 1.8, 2.3, 78);
  for (std::uint64_t piece = 0; piece < 10; ++piece) {  // minutes each
    compare_poses(3, 10000, 1.8, 2.3, 78 + piece);
    std::printf("  %d poses\n", 10000 * (static_cast<int>(piece) + 1));
    std::fflush(stdout);
  }
}

TEST(AllPairs, by_bounding_balls_are_the_same) {
  const BenchShape a(test::rock(1, 2, 0.22)), b(test::rock(2, 1, 0.22));
  AllPairs reference;
  Random random(4);
  std::size_t found = 0;
  for (int pose = 0; pose < 50; ++pose) {
    const Placement p = relative_placement({}, random.rotation(), 1, random.uniform(1.4, 3) * random.direction(), random.rotation(),
                                           random.uniform(0.5, 1.5));
    double least = 0, least_by_balls = 1;
    const std::vector<ClosePair> all = reference.below(a.view(), b.view(), p, 0.05, least),
                                 by_balls = reference.below_by_balls(a.view(), b.view(), p, 0.05, least_by_balls);
    EXPECT_NEAR(least_by_balls, least, kRounding);
    EXPECT_EQ(count_differences(by_balls, all, 0.05, kRounding), 0);
    found += all.size();
  }
  EXPECT_GT(found, 50u);
}

}  // namespace
}  // namespace scree
