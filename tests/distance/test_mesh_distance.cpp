// Mesh against mesh: every query against all pairs of triangles, one by one.
#include <gtest/gtest.h>

#include "core/base/error.hpp"
#include "core/distance/mesh_distance.hpp"
#include "tests/distance/rocks.hpp"

extern long allocation_count;  // of this executable: allocation_counter.cpp

namespace scree {
namespace {

struct Shape {
  TriangleMesh mesh;
  Bvh bvh;
  explicit Shape(TriangleMesh m) : mesh(std::move(m)), bvh(build_bvh(mesh)) {}
  MeshView view() const { return {&mesh, &bvh}; }
};

Pair18 placed_pair(const Shape& a, std::int32_t i, const Shape& b, std::int32_t j, const Placement& p) {
  Pair18 pair;
  for (int k = 0; k < 3; ++k) {
    const Vec3 u = a.mesh.corner(i, k), v = p.scale * (p.rotation * b.mesh.corner(j, k)) + p.translation;
    for (int c = 0; c < 3; ++c) {
      pair[static_cast<std::size_t>(3 * k + c)] = u[c];
      pair[static_cast<std::size_t>(9 + 3 * k + c)] = v[c];
    }
  }
  return pair;
}

/// Distances of all pairs, row by row.
std::vector<double> all_distances(const Shape& a, const Shape& b, const Placement& p) {
  std::vector<Pair18> pairs;
  for (std::int32_t i = 0; i < a.mesh.triangle_count(); ++i)
    for (std::int32_t j = 0; j < b.mesh.triangle_count(); ++j) pairs.push_back(placed_pair(a, i, b, j, p));
  return solve_distances(pairs);
}

/// Checks the smallest distance for one placement.
void check_distance(const Shape& a, const Shape& b, const Placement& p, const std::vector<double>& all, MeshDistanceScratch& scratch,
                    const std::string& what) {
  const double size = std::max(length(bounding_box(a.mesh).extent()), p.scale * length(bounding_box(b.mesh).extent()));
  const double least = *std::min_element(all.begin(), all.end());
  EXPECT_NEAR(mesh_distance(a.view(), b.view(), p, 1e308, scratch), least, 1e-14 * size) << what;
  TrianglePair none{-1, -1};
  const double plain = reproducible_mesh_distance(a.view(), b.view(), p, 1e308, scratch, none);
  EXPECT_NEAR(plain, least, 1e-14 * size) << what;
  // where it starts does not matter, and it tells which pair it was
  for (const TrianglePair start : {TrianglePair{-1, -1}, TrianglePair{0, b.mesh.triangle_count() - 1}, TrianglePair{1 << 30, 0}}) {
    TrianglePair nearest = start;
    EXPECT_NEAR(mesh_distance(a.view(), b.view(), p, 1e308, scratch, &nearest), least, 1e-14 * size) << what;
    ASSERT_TRUE(nearest.a >= 0 && nearest.b >= 0) << what;
    EXPECT_NEAR(all[static_cast<std::size_t>(nearest.a * b.mesh.triangle_count() + nearest.b)], least, 1e-14 * size) << what;
    nearest = start;
    EXPECT_EQ(reproducible_mesh_distance(a.view(), b.view(), p, 1e308, scratch, nearest), plain) << what;
  }
  // an upper bound below the distance is returned as it is
  if (least > 0) {
    EXPECT_EQ(mesh_distance(a.view(), b.view(), p, 0.5 * least, scratch), 0.5 * least) << what;
    EXPECT_NEAR(mesh_distance(a.view(), b.view(), p, 2 * least, scratch), least, 1e-14 * size) << what;
  }
}

/// Checks both queries for one placement; returns how many pairs were within reach.
std::size_t check_placement(const Shape& a, const Shape& b, const Placement& p, double reach, MeshDistanceScratch& scratch,
                            const std::string& what) {
  const std::vector<double> all = all_distances(a, b, p);
  const double least = *std::min_element(all.begin(), all.end());
  std::vector<TrianglePair> pairs;
  const bool intersecting = triangle_pairs_within(a.view(), b.view(), p, reach, scratch, pairs);
  EXPECT_EQ(intersecting, least == 0) << what;
  EXPECT_TRUE(std::is_sorted(pairs.begin(), pairs.end(),
                             [](const TrianglePair& s, const TrianglePair& t) { return s.a != t.a ? s.a < t.a : s.b < t.b; }));
  // nothing missed; nothing beyond what the single-precision filter may let through
  const double size = std::max(length(bounding_box(a.mesh).extent()), p.scale * length(bounding_box(b.mesh).extent()));
  std::size_t next = 0, within = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const TrianglePair pair{static_cast<std::int32_t>(i) / b.mesh.triangle_count(), static_cast<std::int32_t>(i) % b.mesh.triangle_count()};
    const bool reported = next < pairs.size() && pairs[next] == pair;
    if (reported) ++next;
    if (all[i] < reach * (1 - 1e-14) || all[i] == 0) {
      ++within;
      EXPECT_TRUE(reported) << what << ": missed a pair at " << all[i] << " of " << reach;
    } else if (all[i] > reach + 1e-6 * size) {
      EXPECT_FALSE(reported) << what << ": reported a pair at " << all[i];
    }
  }
  EXPECT_EQ(next, pairs.size()) << what;
  check_distance(a, b, p, all, scratch, what);
  return within;
}

TEST(MeshDistance, misses_no_pair_of_concave_rocks_in_random_poses_and_sizes) {
  const MeshDistanceScratchPtr scratch = make_mesh_distance_scratch();
  Random random(21);
  std::vector<Shape> rocks;
  for (int level = 0; level < 3; ++level)
    for (int k = 0; k < 2; ++k) rocks.emplace_back(make_rock(level, static_cast<std::uint64_t>(10 * level + k), 0.15));
  std::size_t within = 0;
  for (int trial = 0; trial < 120; ++trial) {
    const Shape& a = rocks[static_cast<std::size_t>(random.integer(0, 5))];
    const Shape& b = rocks[static_cast<std::size_t>(random.integer(0, 5))];
    const double scale_a = random.uniform(0.5, 2), scale_b = scale_a * std::pow(10, random.uniform(-2, 1));
    const Vec3 x_a = 1000.0 * random.direction();
    const Vec3 x_b = x_a + (random.uniform(0, 1.3) * (scale_a + scale_b)) * random.direction();
    const Placement p = relative_placement(x_a, random.rotation(), scale_a, x_b, random.rotation(), scale_b);
    within += check_placement(a, b, p, random.uniform(0, 0.3), *scratch, "trial " + std::to_string(trial));
  }
  EXPECT_GT(within, 10000u);
}

TEST(MeshDistance, finds_only_intersections_when_the_reach_is_zero) {
  const MeshDistanceScratchPtr scratch = make_mesh_distance_scratch();
  const Shape a(make_rock(2, 1, 0.1)), b(make_rock(2, 2, 0.1));
  for (const double gap : {0.5, 1.5, 1.9, 3.0}) {
    Placement p;
    p.translation = {gap, 0.1, 0.2};
    check_placement(a, b, p, 0, *scratch, "gap " + std::to_string(gap));
  }
}

TEST(MeshDistance, of_a_rock_inside_a_larger_shell_is_that_of_the_surfaces) {
  const MeshDistanceScratchPtr scratch = make_mesh_distance_scratch();
  const Shape shell(make_rock(2, 3, 0.02)), rock(make_rock(1, 4, 0.1));
  Placement p;
  p.scale = 0.25;
  p.translation = {0.3, -0.2, 0.1};
  check_placement(shell, rock, p, 0.4, *scratch, "inside");
  EXPECT_GT(mesh_distance(shell.view(), rock.view(), p, 1e308, *scratch), 0.1);
}

TEST(MeshDistance, of_two_faceted_spheres_lies_between_those_of_their_inner_and_outer_balls) {
  const MeshDistanceScratchPtr scratch = make_mesh_distance_scratch();
  const Shape sphere(make_rock(3, 0, 0));
  // the faces of a 1280-triangle icosphere lie within this of the sphere: computed from the mesh, not assumed
  double inner = 1;
  for (std::int32_t t = 0; t < sphere.mesh.triangle_count(); ++t) {
    const Vec3 a = sphere.mesh.corner(t, 0);
    const Vec3 n = normalised(cross(sphere.mesh.corner(t, 1) - a, sphere.mesh.corner(t, 2) - a));
    inner = std::min(inner, dot(n, a));
  }
  Random random(9);
  for (int trial = 0; trial < 20; ++trial) {
    const double ratio = random.uniform(0.1, 3), gap = random.uniform(0.01, 1);
    const Vec3 x_a = 50.0 * random.direction(), x_b = x_a + (1 + ratio + gap) * random.direction();
    const Placement p = relative_placement(x_a, random.rotation(), 1, x_b, random.rotation(), ratio);
    const double d = mesh_distance(sphere.view(), sphere.view(), p, 1e308, *scratch);
    EXPECT_GE(d, gap * (1 - 1e-12));
    EXPECT_LE(d, gap + (1 - inner) * (1 + ratio) + 1e-12);
  }
}

TEST(MeshDistance, handles_open_sheets_single_triangles_and_empty_meshes) {
  const MeshDistanceScratchPtr scratch = make_mesh_distance_scratch();
  TriangleMesh sheet;
  for (int i = 0; i <= 8; ++i)
    for (int j = 0; j <= 8; ++j) sheet.vertices.push_back({i - 4.0, j - 4.0, 0.1 * ((i * j) % 3)});
  for (std::int32_t i = 0; i < 8; ++i)
    for (std::int32_t j = 0; j < 8; ++j) {
      sheet.triangles.push_back({9 * i + j, 9 * (i + 1) + j, 9 * i + j + 1});
      sheet.triangles.push_back({9 * i + j + 1, 9 * (i + 1) + j, 9 * (i + 1) + j + 1});
    }
  const Shape floor(sheet), rock(make_rock(1, 7, 0.2));
  TriangleMesh single;
  single.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  single.triangles = {{0, 1, 2}};
  const Shape one(single), none(TriangleMesh{});
  Placement p;
  p.translation = {0.3, 0.4, 1.3};
  check_placement(floor, rock, p, 0.5, *scratch, "sheet and rock");
  check_placement(one, rock, p, 0.5, *scratch, "triangle and rock");
  check_placement(rock, one, p, 0.5, *scratch, "rock and triangle");
  std::vector<TrianglePair> pairs = {{1, 2}};
  EXPECT_FALSE(triangle_pairs_within(none.view(), rock.view(), p, 1, *scratch, pairs));
  EXPECT_TRUE(pairs.empty());
  EXPECT_EQ(mesh_distance(rock.view(), none.view(), p, 7, *scratch), 7);
}

TEST(MeshDistance, counts_identical_triangles_once_each) {
  // 64 copies of one triangle: boxes that no cut separates
  const MeshDistanceScratchPtr scratch = make_mesh_distance_scratch();
  TriangleMesh stack;
  stack.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  stack.triangles.assign(64, {0, 1, 2});
  const Shape a(stack);
  Placement p;
  p.translation = {0, 0, 1};
  std::vector<TrianglePair> pairs;
  EXPECT_FALSE(triangle_pairs_within(a.view(), a.view(), p, 1.5, *scratch, pairs));
  EXPECT_EQ(pairs.size(), 64u * 64u);
  EXPECT_EQ(std::unique(pairs.begin(), pairs.end()), pairs.end());
}

TEST(MeshDistance, relative_placement_maps_through_the_world) {
  Random random(31);
  for (int trial = 0; trial < 50; ++trial) {
    const Vec3 x_a = 3.0 * random.direction(), x_b = 3.0 * random.direction(), x = random.direction();
    const Quat q_a = random.rotation(), q_b = random.rotation();
    const double s_a = random.uniform(0.1, 5), s_b = random.uniform(0.1, 5);
    const Placement p = relative_placement(x_a, q_a, s_a, x_b, q_b, s_b);
    const Vec3 world = x_b + s_b * rotate(q_b, x);
    const Vec3 in_a = (1 / s_a) * rotate_inverse(q_a, world - x_a);
    EXPECT_LE(length(p.scale * (p.rotation * x) + p.translation - in_a), 1e-13 * (1 + length(in_a)) / s_a);
  }
}

TEST(MeshDistance, that_is_reproducible_has_the_same_bits_on_every_simd_target_and_from_every_start) {
  struct BestTarget {
    ~BestTarget() { limit_simd("best"); }
  } restore;
  const MeshDistanceScratchPtr scratch = make_mesh_distance_scratch();
  const Shape rock(make_rock(2, 7, 0.15)), box(box_mesh({1, 2, 3}));
  const std::vector<const Shape*> shapes{&rock, &box};
  std::vector<std::vector<double>> answers;
  for (const char* name : {"avx512", "avx2", "sse4", "scalar"}) {
    try {
      limit_simd(name);
    } catch (const UsageError&) {
      continue;  // not on this processor
    }
    answers.emplace_back();
    Random random(27);
    for (int trial = 0; trial < 400; ++trial) {
      const Shape &a = *shapes[static_cast<std::size_t>(trial % 2)], &b = *shapes[static_cast<std::size_t>(trial / 2 % 2)];
      // every other turn about z alone: faces of boxes are parallel, and many pairs are equally near but for rounding
      const Quat turn = trial % 4 == 3 ? quaternion_of({0, 0, 1}, random.uniform(0, 6)) : random.rotation();
      const Vec3 away = trial % 4 == 3 ? Vec3{random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5), 3.1} : 3.2 * random.direction();
      const Placement p = relative_placement({}, turn, 1, rotate(turn, away), trial % 8 == 7 ? turn : random.rotation(), 0.9);
      for (const TrianglePair start : {TrianglePair{-1, -1}, TrianglePair{0, b.mesh.triangle_count() - 1}}) {
        TrianglePair nearest = start;
        answers.back().push_back(reproducible_mesh_distance(a.view(), b.view(), p, 10, *scratch, nearest));
      }
      answers.back().push_back(reproducible_point_distance(a.view(), away, 10));
    }
    for (std::size_t i = 0; i < answers[0].size(); i += 3) EXPECT_EQ(answers.back()[i], answers.back()[i + 1]) << name << " " << i;
    EXPECT_EQ(answers.back(), answers[0]) << name;
  }
}

TEST(PointDistance, to_a_box_is_the_closed_form) {
  const Shape box(box_mesh({2, 4, 6}));
  Random random(41);
  for (int trial = 0; trial < 300; ++trial) {
    const Vec3 p{random.uniform(-4, 4), random.uniform(-6, 6), random.uniform(-8, 8)};
    const Vec3 q{std::abs(p.x) - 1, std::abs(p.y) - 2, std::abs(p.z) - 3};
    const double outside = length(component_max(q, {0, 0, 0})), inside = -std::max({q.x, q.y, q.z});
    const double truth = outside > 0 ? outside : inside;
    Vec3 nearest;
    std::int32_t triangle = -1;
    const double d = point_mesh_distance(box.view(), p, 1e308, nearest, triangle);
    EXPECT_NEAR(d, truth, 1e-14);
    EXPECT_NEAR(length(nearest - p), d, 1e-14);
    EXPECT_GE(triangle, 0);
    EXPECT_NEAR(reproducible_point_distance(box.view(), p, 1e308), truth, 1e-14);
    EXPECT_EQ(reproducible_point_distance(box.view(), p, 0.5 * truth), 0.5 * truth);
    EXPECT_EQ(point_mesh_distance(box.view(), p, 0.5 * truth, nearest, triangle), 0.5 * truth);
    EXPECT_EQ(triangle, -1);
    EXPECT_EQ(is_inside(box.mesh, p), outside == 0);
  }
}

TEST(PointDistance, to_a_rock_is_the_least_over_its_triangles) {
  const Shape rock(make_rock(2, 5, 0.2));
  Random random(42);
  for (int trial = 0; trial < 50; ++trial) {
    const Vec3 p = random.uniform(0, 2) * random.direction(), here[3] = {p, p, p};
    double least = 1e308;
    for (std::int32_t t = 0; t < rock.mesh.triangle_count(); ++t) {
      const Vec3 face[3] = {rock.mesh.corner(t, 0), rock.mesh.corner(t, 1), rock.mesh.corner(t, 2)};
      least = std::min(least, triangle_distance(face, here).distance);
    }
    Vec3 nearest;
    std::int32_t triangle = -1;
    EXPECT_EQ(point_mesh_distance(rock.view(), p, 1e308, nearest, triangle), least);
  }
}

TEST(Bvh, holds_every_triangle_once_inside_boxes_that_were_rounded_outward) {
  for (const int level : {0, 1, 3}) {
    const Shape rock(make_rock(level, 17, 0.2));
    const Bvh& tree = rock.bvh;
    std::vector<int> seen(static_cast<std::size_t>(rock.mesh.triangle_count()), 0);
    const auto below = [&](const auto& self, std::int32_t code) -> std::vector<std::int32_t> {
      std::vector<std::int32_t> triangles;
      if (code < 0) {
        const BvhLeaf& leaf = tree.leaves[static_cast<std::size_t>(~code)];
        EXPECT_GE(leaf.count, 1);
        EXPECT_LE(leaf.count, kBvhWidth);
        for (std::int32_t k = 0; k < leaf.count; ++k) {
          triangles.push_back(leaf.triangle[k]);
          ++seen[static_cast<std::size_t>(leaf.triangle[k])];
        }
        return triangles;
      }
      const BvhNode& node = tree.nodes[static_cast<std::size_t>(code)];
      for (std::int32_t k = 0; k < node.count; ++k) {
        const std::vector<std::int32_t> child = self(self, node.child[k]);
        for (const std::int32_t t : child)
          for (int v = 0; v < 3; ++v)
            for (int c = 0; c < 3; ++c) {
              EXPECT_LE(static_cast<double>(node.lower[c][k]), (rock.mesh.corner(t, v) - tree.middle)[c]);
              EXPECT_GE(static_cast<double>(node.upper[c][k]), (rock.mesh.corner(t, v) - tree.middle)[c]);
            }
        triangles.insert(triangles.end(), child.begin(), child.end());
      }
      return triangles;
    };
    below(below, 0);
    EXPECT_EQ(seen, std::vector<int>(seen.size(), 1));
    // the promise of the header
    if (level == 3) {
      EXPECT_LE(tree.memory(), 52 * seen.size());
    }
  }
}

TEST(MeshDistance, allocates_nothing_once_its_scratch_is_warm) {
  const MeshDistanceScratchPtr scratch = make_mesh_distance_scratch();
  const Shape a(make_rock(2, 1, 0.1)), b(make_rock(2, 2, 0.1));
  Placement p;
  p.translation = {1.9, 0.3, 0.1};
  std::vector<TrianglePair> pairs;
  const auto query = [&] {
    triangle_pairs_within(a.view(), b.view(), p, 0.2, *scratch, pairs);
    mesh_distance(a.view(), b.view(), p, 1e308, *scratch);
  };
  query();
  const long before = allocation_count;
  for (int k = 0; k < 10; ++k) query();
  EXPECT_EQ(allocation_count, before);
  EXPECT_GT(pairs.size(), 0u);
}

}  // namespace
}  // namespace scree
