// Poses of pairs of meshes in lanes (solver/lanes/mesh_poses.hpp) against RelativePose and follow_motion(): the same bits on every
// instruction set, however many pairs share a vector.
#include "solver/lanes/mesh_poses.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <memory>
#include <random>

#include "core/base/error.hpp"
#include "core/distance/triangle_distance.hpp"
#include "solver/pairs/pair_evaluation.hpp"

namespace scree {
namespace {

constexpr std::size_t kBodies = 9;

enum class Domain { open, periodic, sheared };

/// Bodies on both sides of a periodic cell, of several sizes.
ParticleSet random_bodies(std::mt19937& random, Domain domain) {
  std::uniform_real_distribution<double> uniform(-1, 1);
  const auto vector = [&] { return Vec3{uniform(random), uniform(random), uniform(random)}; };
  ParticleSet p;
  for (std::size_t i = 0; i < kBodies; ++i) {
    p.x.push_back(vector());
    p.v.push_back(vector());
    p.w.push_back(4.0 * vector());
    p.q.push_back(normalised(Quat{uniform(random), uniform(random), uniform(random), uniform(random)}));
    p.radius.push_back(i % 4 == 0 ? 1.5 : 2 + uniform(random));
  }
  if (domain == Domain::periodic) p.cell = Cell(Periodicity({-1, -1, -1}, {1, 1, 1}, {true, true, false}));
  if (domain == Domain::sheared) p.cell = Cell(Periodicity::at_corner({-1, -1, -1}, {2, 2, 2}, {0.3, -0.5, 0.7}));
  return p;
}

/// What of two bodies the plain code needs.
PairView view_of_rows(const ParticleSet& p, std::size_t i, std::size_t j) {
  PairView view;
  view.a = {nullptr, 1, p.x[i], p.q[i]};
  view.b = {nullptr, 1, p.x[j], p.q[j]};
  if (p.cell.periodicity().any()) view.b.x = p.x[i] + p.cell.periodicity().nearest(p.x[j] - p.x[i]);
  view.radius_a = p.radius[i];
  view.radius_b = p.radius[j];
  view.pose = RelativePose(view.a, view.b);
  return view;
}

/// Lists that were made at another pose, and were looked at since.
CandidateLists random_lists(std::mt19937& random) {
  std::uniform_real_distribution<double> uniform(-1, 1);
  const auto vector = [&] { return Vec3{uniform(random), uniform(random), uniform(random)}; };
  const auto turn = [&] { return normalised(Quat{uniform(random), uniform(random), uniform(random), uniform(random)}); };
  CandidateLists lists;
  lists.skin = 1;
  lists.centre = vector();
  lists.turn = turn();
  lists.last_centre = vector();
  lists.last_turn = turn();
  lists.way = 1 + uniform(random);
  return lists;
}

bool same_bits(const auto& l, const auto& r) { return std::memcmp(&l, &r, sizeof(l)) == 0; }

void expect_the_bits_of_plain_code(std::size_t count, Domain domain, std::mt19937& random) {
  const ParticleSet p = random_bodies(random, domain);
  const auto poses = std::make_unique<MeshPoses>();
  std::vector<CandidateLists> lists, expected;
  for (std::size_t n = 0; n < count; ++n) lists.push_back(random_lists(random));
  expected = lists;
  for (std::size_t n = 0; n < count; ++n) {
    poses->a[n] = static_cast<std::int64_t>(n);
    poses->b[n] = static_cast<std::int64_t>((n + 1) % kBodies);
    poses->lists[n] = &lists[n];
  }
  poses->count = count;
  find_mesh_poses(p, *poses);
  for (std::size_t n = 0; n < count; ++n) {
    const std::size_t j = (n + 1) % kBodies;
    const PairView view = view_of_rows(p, n, j);
    EXPECT_TRUE(same_bits(poses->pose[n], view.pose)) << n;
    EXPECT_EQ(poses->moved[n], follow_motion(expected[n], view.pose, view.radius_a, view.radius_b)) << n;
    EXPECT_EQ(lists[n].way, expected[n].way) << n;
    EXPECT_TRUE(same_bits(lists[n].last_centre, expected[n].last_centre)) << n;
    EXPECT_TRUE(same_bits(lists[n].last_turn, expected[n].last_turn)) << n;
    EXPECT_TRUE(same_bits(lists[n].turn, expected[n].turn) && lists[n].skin == 1) << n;
    const double speed = squared_speed_of(view, {p.v[n], p.w[n], p.v[j], p.w[j], view.b.x, p.v[j]});
    EXPECT_NEAR(poses->squared_speed[n], speed, 1e-14 * speed) << n;  // both of them are rounded
    EXPECT_GT(speed, 0);
  }
}

TEST(MeshPoses, have_the_bits_of_plain_code) {
  std::mt19937 random(3);
  for (const char* name : {"best", "avx512", "avx2", "sse4", "scalar"}) {
    try {
      limit_simd(name);
    } catch (const UsageError&) {
      continue;
    }
    SCOPED_TRACE(name);
    for (const Domain domain : {Domain::open, Domain::periodic, Domain::sheared}) {
      for (std::size_t count = 1; count <= MeshPoses::kPairs; ++count) expect_the_bits_of_plain_code(count, domain, random);
    }
  }
  limit_simd("best");
}

}  // namespace
}  // namespace scree
