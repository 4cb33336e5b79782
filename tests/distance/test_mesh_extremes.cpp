// Meshes that trees find hard, every query against all pairs: shells, slivers, one place, far away, a million triangles.
#include <gtest/gtest.h>

#include <cstdlib>

#include "tests/benchmarks/candidates/all_pairs.hpp"
#include "tests/benchmarks/candidates/trajectories.hpp"
#include "tests/benchmarks/distance/methods/kept_pairs.hpp"

namespace scree {
namespace {

struct Found {
  std::int64_t close = 0, intersecting = 0;
};

/// All queries of a list of placements; `rounding` is what placing a corner may cost [units of A].
Found check_queries(const BenchShape& a, const BenchShape& b, const std::vector<Placement>& placements, double reach, double rounding,
                    const std::string& what) {
  const MeshDistanceScratchPtr scratch = make_mesh_distance_scratch();
  const KeptPairsScratchPtr kept_scratch = make_kept_pairs_scratch();
  AllPairs reference;
  KeptPairs kept;
  std::vector<TrianglePair> pairs;
  std::vector<ClosePair> close;
  TrianglePair nearest{-1, -1};
  Found found;
  for (std::size_t k = 0; k < placements.size(); ++k) {
    const Placement& p = placements[k];
    const std::string where = what + ", placement " + std::to_string(k);
    double least = 0;
    const std::vector<ClosePair> expected = reference.below(a.view(), b.view(), p, reach, least);
    // pairs on the verge of intersecting may go either way
    const bool sure = least == 0 || least > rounding;
    const bool intersecting = triangle_pairs_within(a.view(), b.view(), p, reach, *scratch, pairs);
    if (sure) {
      EXPECT_EQ(intersecting, least == 0) << where;
      EXPECT_EQ(meshes_intersect(a.view(), b.view(), p, *scratch), least == 0) << where;
    }
    std::size_t next = 0;
    for (const ClosePair& c : expected) {
      while (next < pairs.size() && (pairs[next].a < c.pair.a || (pairs[next].a == c.pair.a && pairs[next].b < c.pair.b))) ++next;
      EXPECT_TRUE(c.distance > reach - rounding || (next < pairs.size() && pairs[next] == c.pair))
          << where << ": missed a pair at " << c.distance;
    }
    EXPECT_NEAR(mesh_distance(a.view(), b.view(), p, 1e308, *scratch), least, rounding) << where;
    EXPECT_NEAR(mesh_distance(a.view(), b.view(), p, 1e308, *scratch, &nearest), least, rounding)
        << where << ", from the last nearest pair";
    kept.update(a.view(), b.view(), p, reach, *kept_scratch, close);
    EXPECT_EQ(count_differences(close, expected, reach, rounding), 0) << where << ", kept";
    found.close += static_cast<std::int64_t>(expected.size());
    found.intersecting += least == 0;
  }
  return found;
}

/// Placements of bodies of radii about 1 and `ratio`, from deep inside one another to apart.
std::vector<Placement> random_placements(int count, double ratio, std::uint64_t seed) {
  Random random(seed);
  std::vector<Placement> placements;
  for (int k = 0; k < count; ++k)
    placements.push_back(
        relative_placement({}, random.rotation(), 1, random.uniform(0, 1.4) * (1 + ratio) * random.direction(), random.rotation(), ratio));
  return placements;
}

/// A closed box with walls of a thickness: an outer and an inner box, the inner one turned inside out.
TriangleMesh shell_mesh(const Vec3& size, double thickness) {
  TriangleMesh shell = box_mesh(size);
  TriangleMesh inner = box_mesh(size - Vec3{2 * thickness, 2 * thickness, 2 * thickness});
  const std::int32_t first = shell.vertex_count();
  shell.vertices.insert(shell.vertices.end(), inner.vertices.begin(), inner.vertices.end());
  for (const Triangle& t : inner.triangles) shell.triangles.push_back({t[0] + first, t[2] + first, t[1] + first});
  return shell;
}

TEST(MeshExtremes, thin_shells_and_concave_cups_are_as_all_pairs) {
  TriangleMesh fine = shell_mesh({2, 2, 2}, 1e-3);
  for (int k = 0; k < 2; ++k) fine = test::subdivide(fine, false);
  // a cup: the shell without its lid
  TriangleMesh cup = fine;
  std::erase_if(cup.triangles, [&](const Triangle& t) {
    return std::all_of(t.begin(), t.end(), [&](std::int32_t v) { return cup.vertices[static_cast<std::size_t>(v)].z > 0.99; });
  });
  const BenchShape shell(std::move(fine)), open(std::move(cup)), rock(test::rock(5, 2, 0.3));
  for (const double ratio : {1.0, 0.3}) {
    for (const BenchShape* other : {&rock, &shell, &open}) {
      const Found found = check_queries(shell, *other, random_placements(12, ratio, 3), 0.02, 1e-14, "shell");
      EXPECT_GT(found.close, 0);
      EXPECT_GT(found.intersecting, 0);
      check_queries(open, *other, random_placements(12, ratio, 4), 0.02, 1e-14, "cup");
    }
  }
  // inside the cup, touching nothing: a positive distance, no intersection
  Placement inside;
  inside.scale = 0.3;
  const Found found = check_queries(shell, rock, {inside}, 0.8, 1e-14, "inside");
  EXPECT_EQ(found.intersecting, 0);
  EXPECT_GT(found.close, 0);
}

TEST(MeshExtremes, one_triangle_and_all_triangles_at_one_place_are_as_all_pairs) {
  TriangleMesh single;
  single.vertices = {{0.1, 0, 0}, {1, 0.2, 0}, {0, 1, 0.3}};
  single.triangles = {{0, 1, 2}};
  TriangleMesh heap = single;
  heap.triangles.assign(1500, {0, 1, 2});
  TriangleMesh points = single;  // triangles that are points, all at one place, and one segment
  points.triangles.assign(300, {0, 0, 0});
  points.triangles.push_back({0, 1, 1});
  const BenchShape one(std::move(single)), many(std::move(heap)), dust(std::move(points)), rock(test::rock(6, 1, 0.22));
  for (const BenchShape* a : {&one, &many, &dust, &rock})
    for (const BenchShape* b : {&one, &dust, &rock}) check_queries(*a, *b, random_placements(6, 0.7, 5), 0.05, 1e-14, "heap");
}

TEST(MeshExtremes, slivers_of_aspect_a_million_are_as_all_pairs) {
  // a fan of needles, each as long as the body and 1e-6 wide
  TriangleMesh fan;
  Random random(9);
  for (std::int32_t k = 0; k < 400; ++k) {
    const Vec3 from = 0.3 * random.direction(), along = random.direction();
    fan.vertices.insert(fan.vertices.end(), {from, from + along, from + 0.5 * along + 1e-6 * random.direction()});
    fan.triangles.push_back({3 * k, 3 * k + 1, 3 * k + 2});
  }
  const BenchShape needles(std::move(fan)), rock(test::rock(7, 2, 0.22));
  // Whether a needle is pierced is decided to aspect * roundoff of its length (docs/reference/candidates.md section 3.2).
  EXPECT_GT(check_queries(needles, rock, random_placements(20, 1, 6), 0.01, 1e-9, "needles and rock").close, 0);
  EXPECT_GT(check_queries(needles, needles, random_placements(10, 1, 7), 0.01, 1e-9, "needles").close, 0);
}

TEST(MeshExtremes, sizes_ten_thousand_to_one_are_as_all_pairs) {
  const BenchShape large(test::rock(8, 3, 0.22)), small(test::rock(9, 1, 0.22));
  Random random(10);
  std::vector<Placement> on_small, on_large;
  for (int k = 0; k < 25; ++k) {
    // next to a vertex of the large one, closer than the small one is wide
    const Vec3& vertex = large.mesh.vertices[static_cast<std::size_t>(random.integer(0, large.mesh.vertex_count() - 1))];
    Placement p = relative_placement({}, random.rotation(), 1, {}, random.rotation(), 1e-4);
    p.translation = vertex + random.uniform(0, 3e-4) * random.direction();
    on_large.push_back(p);
    // the other way round: lengths in units of the small one
    Placement q;
    q.scale = 1e4;
    q.rotation = transpose(p.rotation);
    q.translation = -1e4 * (q.rotation * p.translation);
    on_small.push_back(q);
  }
  EXPECT_GT(check_queries(large, small, on_large, 1e-5, 1e-14, "small on large").close, 50);
  EXPECT_GT(check_queries(small, large, on_small, 0.1, 1e-10, "large on small").close, 50);
}

TEST(MeshExtremes, shapes_a_million_sizes_from_their_own_origin_are_as_all_pairs) {
  // single-precision coordinates from there are worth nothing: 1e6 * 2^-24 = 0.06 of the size
  const Vec3 offset{1e6, -7e5, 3e5};
  TriangleMesh moved = test::rock(11, 2, 0.22);
  for (Vec3& v : moved.vertices) v += offset;
  const BenchShape far(std::move(moved)), near(test::rock(12, 1, 0.22));
  std::vector<Placement> placements = random_placements(15, 1, 8);
  for (Placement& p : placements) p.translation += offset;
  const double rounding = 1e-16 * 1e6 * 16;
  EXPECT_GT(check_queries(far, near, placements, 0.02, rounding, "far, near").close, 0);
  placements = random_placements(15, 1, 9);
  for (Placement& p : placements) {
    p.rotation = matrix_of(quaternion_of(Vec3{0, 0, 1}, 0.3));
    p.translation -= p.rotation * offset;
  }
  EXPECT_GT(check_queries(near, far, placements, 0.02, rounding, "near, far").close, 0);
  // and the lists are no longer than at home: nothing is searched with the precision of the offset
  KeptPairs here, there;
  here.fix_skin(0.05);  // the tuned one depends on how far a point at the far side moves when the shape turns
  there.fix_skin(0.05);
  const KeptPairsScratchPtr scratch = make_kept_pairs_scratch();
  std::vector<ClosePair> close;
  const BenchShape home(test::rock(11, 2, 0.22));
  for (Placement p : random_placements(15, 1, 8)) {
    here.update(home.view(), near.view(), p, 0.02, *scratch, close);
    p.translation += offset;
    there.update(far.view(), near.view(), p, 0.02, *scratch, close);
  }
  EXPECT_GT(here.counts().listed, 0);
  EXPECT_NEAR(static_cast<double>(there.counts().listed) / static_cast<double>(here.counts().listed), 1, 0.01);
}

TEST(MeshExtremes, the_distance_of_a_sphere_is_that_of_its_centre_for_all_of_these) {
  // an analytic sphere is never triangulated: its distance is that of its centre less its radius
  TriangleMesh cup = shell_mesh({2, 2, 2}, 1e-3);
  TriangleMesh heap;
  heap.vertices = {{0.1, 0, 0}, {1, 0.2, 0}, {0, 1, 0.3}};
  heap.triangles.assign(500, {0, 1, 2});
  TriangleMesh far = test::rock(11, 2, 0.22);
  for (Vec3& v : far.vertices) v += Vec3{1e6, 0, 0};
  Random random(12);
  for (const TriangleMesh& mesh : {cup, heap, far, test::rock(13, 3, 0.3)}) {
    const BenchShape shape(mesh);
    const Vec3 middle = bounding_box(mesh).centre();
    for (int trial = 0; trial < 60; ++trial) {
      const Vec3 centre = middle + random.uniform(0, 2.5) * random.direction(), here[3] = {centre, centre, centre};
      double least = 1e308;
      for (std::int32_t t = 0; t < mesh.triangle_count(); ++t) {
        const Vec3 face[3] = {mesh.corner(t, 0), mesh.corner(t, 1), mesh.corner(t, 2)};
        least = std::min(least, triangle_distance(face, here).distance);
      }
      Vec3 nearest;
      std::int32_t triangle = -1;
      EXPECT_EQ(point_mesh_distance(shape.view(), centre, 1e308, nearest, triangle), least);
      EXPECT_NEAR(length(nearest - centre), least, 1e-15 * (1 + length(middle)));
    }
  }
}

TEST(MeshExtremes, a_mesh_of_very_many_triangles_is_as_all_pairs) {
  const int level = std::getenv("SCREE_SLOW_TESTS") != nullptr ? 8 : 5;  // 1.3e6 or 2e4 triangles
  const BenchShape large(test::rock(14, level, 0.22)), small(test::rock(15, 0, 0.22));
  Random random(16);
  std::vector<Placement> placements;
  for (int k = 0; k < 4; ++k) {
    const Vec3& vertex = large.mesh.vertices[static_cast<std::size_t>(random.integer(0, large.mesh.vertex_count() - 1))];
    Placement p = relative_placement({}, random.rotation(), 1, {}, random.rotation(), 0.05);
    p.translation = vertex + random.uniform(0.05, 0.1) * normalised(vertex);
    placements.push_back(p);
  }
  EXPECT_GT(check_queries(large, small, placements, 0.05, 1e-14, "many").close, 100);
}

}  // namespace
}  // namespace scree
