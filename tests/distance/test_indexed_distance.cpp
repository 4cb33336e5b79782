// Distances from indices into placed shapes, against the same triangles placed one by one in double precision.
#include <gtest/gtest.h>

#include "tests/benchmarks/distance/methods/indexed_distance.hpp"
#include "tests/distance/triangle_pairs.hpp"

namespace scree {
namespace {

TriangleMesh random_soup(Random& r, std::int32_t count) {
  TriangleMesh mesh;
  for (std::int32_t t = 0; t < count; ++t) {
    const Vec3 centre{r.uniform(-1, 1), r.uniform(-1, 1), r.uniform(-1, 1)};
    for (int k = 0; k < 3; ++k) mesh.vertices.push_back(centre + 0.3 * r.direction());
    mesh.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
  }
  return mesh;
}

TEST(IndexedDistance, is_that_of_the_placed_triangles_for_any_number_of_pairs) {
  Random r(1);
  const TriangleMesh a = random_soup(r, 50), b = random_soup(r, 70);
  const TriangleRows rows_a(a), rows_b(b);
  Placement place;
  const Quat q = r.rotation();
  place.rotation = matrix_of(q);
  place.translation = {0.3, -0.7, 1.1};
  place.scale = 1.5;
  for (const std::size_t count : {std::size_t{1}, std::size_t{7}, std::size_t{128}, std::size_t{1003}}) {
    std::vector<TrianglePair> pairs;
    for (std::size_t i = 0; i < count; ++i) pairs.push_back({r.integer(0, 49), r.integer(0, 69)});
    const std::size_t padded = count + 16;
    std::vector<float> distance(padded), points(6 * padded), code(padded);
    triangle_distances(rows_a, rows_b, place, pairs, {distance.data(), points.data(), code.data(), static_cast<std::int64_t>(padded)});
    for (std::size_t i = 0; i < count; ++i) {
      Vec3 p[3], f[3];
      for (int k = 0; k < 3; ++k) {
        p[k] = a.corner(pairs[i].a, k);
        f[k] = place.scale * rotate(q, b.corner(pairs[i].b, k)) + place.translation;
      }
      const TriangleDistance truth = triangle_distance(p, f);
      // 5 roundoffs of the distance, 1 and 6 of corners whose coordinates are below 4
      const double allowed = 6e-8 * (5 * std::max(1.0, truth.distance) + 7 * 4);
      EXPECT_NEAR(static_cast<double>(distance[i]), truth.distance, allowed) << "pair " << i << " of " << count;
      Vec3 on_a, on_b;
      for (int c = 0; c < 3; ++c) {
        on_a[c] = static_cast<double>(points[static_cast<std::size_t>(c) * padded + i]);
        on_b[c] = static_cast<double>(points[static_cast<std::size_t>(3 + c) * padded + i]);
      }
      EXPECT_NEAR(length(on_a - on_b), static_cast<double>(distance[i]), allowed);
      const Vec3 here[3] = {on_a, on_a, on_a}, there[3] = {on_b, on_b, on_b};
      EXPECT_LE(triangle_distance(p, here).distance, allowed);
      EXPECT_LE(triangle_distance(f, there).distance, allowed);
    }
  }
}

TEST(IndexedDistance, has_the_same_bits_on_every_target_with_fused_multiply_add) {
  Random r(2);
  const TriangleMesh a = random_soup(r, 20), b = random_soup(r, 20);
  const TriangleRows rows_a(a), rows_b(b);
  Placement place;
  place.rotation = matrix_of(r.rotation());
  std::vector<TrianglePair> pairs;
  for (std::int32_t i = 0; i < 20; ++i)
    for (std::int32_t j = 0; j < 20; ++j) pairs.push_back({i, j});
  std::vector<float> reference;
  for (const char* name : {"avx512", "avx2"}) {
    try {
      limit_simd(name);
    } catch (const std::exception&) {
      continue;  // not on this processor
    }
    std::vector<float> distance(400), points(2400), code(400);
    triangle_distances(rows_a, rows_b, place, pairs, {distance.data(), points.data(), code.data(), 400});
    limit_simd("best");
    if (reference.empty()) reference = distance;
    EXPECT_EQ(distance, reference) << name;
  }
}

}  // namespace
}  // namespace scree
