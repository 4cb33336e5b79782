// Whether triangles meet, against exact integer arithmetic, where rounding cannot tell: touching, and off by one bit.
#include <gtest/gtest.h>

#include <cstdlib>
#include <functional>

#include "core/distance/triangle_intersection.hpp"
#include "tests/benchmarks/distance/methods/distance_methods.hpp"
#include "tests/distance/exact_oracle.hpp"
#include "tests/distance/families.hpp"

namespace scree {
namespace {

int members(int fast, int slow) { return std::getenv("SCREE_SLOW_TESTS") != nullptr ? slow : fast; }

bool intersect(const Pair18& p) { return triangles_intersect(p.data(), p.data() + 9); }

Pair18 pair_of(const Vec3 a[3], const Vec3 b[3]) {
  Pair18 p;
  for (std::size_t k = 0; k < 18; ++k) p[k] = (k < 9 ? a : b)[k % 9 / 3][static_cast<int>(k % 3)];
  return p;
}

/// Moves one coordinate by up to two bits.
Pair18 nudged(Pair18 p, Random& r) {
  double& x = p[static_cast<std::size_t>(r.integer(0, 17))];
  const int steps = r.integer(-2, 2);
  for (int k = 0; k < std::abs(steps); ++k) x = std::nextafter(x, steps > 0 ? 1e300 : -1e300);
  return p;
}

Vec3 random_vertex(Random& r) { return {r.uniform(-1, 1), r.uniform(-1, 1), r.uniform(-1, 1)}; }

/// A pair that touches but for rounding: a vertex in a face, edges that cross, vertices that meet, coplanar contact.
Pair18 near_touching(Random& r) {
  Vec3 a[3], b[3];
  for (int k = 0; k < 3; ++k) {
    a[k] = random_vertex(r);
    b[k] = random_vertex(r);
  }
  const double u = r.uniform(0, 1), v = r.uniform(0, 1 - u);
  const Vec3 in_face = a[0] + u * (a[1] - a[0]) + v * (a[2] - a[0]), on_edge = a[0] + u * (a[1] - a[0]);
  switch (r.integer(0, 7)) {
    case 0:
      b[0] = in_face;
      break;
    case 1:
      b[0] = on_edge;
      break;
    case 2:
      b[0] = a[1];
      break;
    case 3: {  // edges that cross
      const Vec3 shift = on_edge - (b[0] + v * (b[1] - b[0]));
      for (Vec3& p : b) p += shift;
      break;
    }
    case 4:  // coplanar: every vertex a combination of a's
      for (Vec3& p : b) p = a[0] + r.uniform(-1, 2) * (a[1] - a[0]) + r.uniform(-1, 2) * (a[2] - a[0]);
      break;
    case 5:  // a shared edge, or the same line
      b[0] = a[0] + r.uniform(-1, 1) * (a[1] - a[0]);
      b[1] = a[0] + r.uniform(0, 2) * (a[1] - a[0]);
      break;
    case 6:  // a point or a segment against the face
      b[0] = in_face;
      b[1] = r.integer(0, 1) == 1 ? in_face : a[0] + v * (a[1] - a[0]);
      b[2] = r.integer(0, 1) == 1 ? b[1] : b[0];
      break;
    default:  // segments on one line
      a[2] = a[1];
      b[0] = on_edge;
      b[1] = b[2] = a[0] + r.uniform(-1, 2) * (a[1] - a[0]);
  }
  return pair_of(a, b);
}

/// Members of a generator, half of them nudged, in a random order of the vertices.
std::vector<Pair18> draw(int count, std::uint64_t seed, const std::function<Pair18(Random&)>& make) {
  Random r(seed);
  std::vector<Pair18> pairs;
  for (int i = 0; i < count; ++i) {
    Pair18 p = make(r);
    if (r.integer(0, 1) == 1) p = nudged(p, r);
    p = permuted(p, r.integer(0, 35));
    pairs.push_back(r.integer(0, 1) == 1 ? swapped(p) : p);
  }
  return pairs;
}

std::vector<Pair18> all_kinds() {
  std::vector<Pair18> pairs = draw(members(6000, 200000), 1, near_touching);
  for (int family = 1; family <= kFamilyCount; ++family)
    for (const Pair18& p :
         draw(members(150, 4000), 10 + static_cast<std::uint64_t>(family), [&](Random& r) { return family_member(family, r); }))
      pairs.push_back(p);
  for (const Pair18& p : draw(members(2000, 40000), 40, [](Random& r) { return random_integer_pair(r, -2, 2); })) pairs.push_back(p);
  return pairs;
}

TEST(TriangleIntersection, is_decided_as_by_exact_arithmetic) {
  int meeting = 0, apart = 0;
  for (const Pair18& p : all_kinds()) {
    const bool truth = oracle::intersect(p.data());
    ASSERT_EQ(intersect(p), truth) << testing::PrintToString(p);
    (truth ? meeting : apart)++;
  }
  EXPECT_GT(meeting, 1000);
  EXPECT_GT(apart, 1000);
}

TEST(TriangleIntersection, does_not_depend_on_order_and_scale) {
  Random r(3);
  for (int i = 0; i < members(300, 5000); ++i) {
    const Pair18 p = i % 2 == 0 ? near_touching(r) : family_member(1 + i / 2 % kFamilyCount, r);
    const bool reference = intersect(p);
    for (int order = 0; order < 36; ++order) {
      ASSERT_EQ(intersect(permuted(p, order)), reference);
      ASSERT_EQ(intersect(swapped(permuted(p, order))), reference);
    }
    for (const int exponent : {-700, -100, 100, 700}) {
      ASSERT_EQ(intersect(scaled(p, std::ldexp(1.0, exponent))), reference) << exponent;
    }
  }
}

TEST(TriangleIntersection, sees_the_last_bit) {
  // a vertex over a face in the plane z = 0, at it and under it
  const Pair18 p = {-1, -1, 0, 2, -1, 0, 0, 2, 0, 0.1, 0.2, 0, 1, 0, 2, 0, 1, 2};
  Pair18 q = p;
  EXPECT_TRUE(intersect(p));
  q[11] = 5e-190;
  EXPECT_FALSE(intersect(q));
  q[11] = -5e-190;
  EXPECT_TRUE(intersect(q));
}

TEST(TriangleIntersection, of_numbers_that_are_none_is_false) {
  Pair18 p = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 1, 0};
  EXPECT_TRUE(intersect(p));
  p[4] = std::nan("");
  EXPECT_FALSE(intersect(p));
}

/// The flag of the kernels: never set for a pair that is apart; missing only for pierced slivers.
template <class Real>
void check_flags(double roundoff) {
  std::vector<Pair18> pairs = all_kinds();
  for (Pair18& p : pairs)
    for (double& x : p) {
      const volatile Real rounded = static_cast<Real>(x);
      x = static_cast<double>(rounded);
    }
  std::int64_t stride = 0;
  const std::vector<double> values = structure_of_arrays(pairs, stride);
  const std::vector<Real> input(values.begin(), values.end());
  const auto n = static_cast<std::size_t>(stride);
  for (const DistanceMethod method : {DistanceMethod::brute_force, DistanceMethod::hybrid}) {
    std::vector<Real> distance(n), points(6 * n), code(n);
    triangle_distances(method, PairBatch<Real>{input.data(), stride, static_cast<std::int64_t>(pairs.size())},
                       AnswerBatch<Real>{distance.data(), points.data(), code.data(), stride});
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      const bool truth = intersect(pairs[i]);
      const auto d = static_cast<double>(distance[i]);
      if (d == 0 || !truth || aspect(pairs[i]) < 100) {
        ASSERT_EQ(d == 0, truth) << i << " at " << d << ": " << testing::PrintToString(pairs[i]);
      }
      if (truth) {
        ASSERT_LE(d, 4 * roundoff * aspect(pairs[i]) * longest_edge(pairs[i])) << i;
      }
    }
  }
}
TEST(TriangleIntersection, is_what_the_flag_of_the_distance_says_in_double) { check_flags<double>(1.2e-16); }
TEST(TriangleIntersection, is_what_the_flag_of_the_distance_says_in_single) { check_flags<float>(6e-8); }

}  // namespace
}  // namespace scree
