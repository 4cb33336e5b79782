// The three methods against exact arithmetic, over all families and random pairs.
#include <gtest/gtest.h>

#include <cstdlib>
#include <limits>

#include "core/base/error.hpp"
#include "tests/benchmarks/distance/methods/distance_methods.hpp"
#include "tests/distance/exact_oracle.hpp"
#include "tests/distance/families.hpp"

namespace scree {
namespace {

template <class Real>
struct Answers {
  std::vector<Real> distance, points, code;
  std::int64_t stride;
  Vec3 point(int side, std::size_t i) const {
    Vec3 p;
    for (int c = 0; c < 3; ++c) p[c] = static_cast<double>(points[static_cast<std::size_t>((3 * side + c) * stride) + i]);
    return p;
  }
};

template <class Real>
Answers<Real> solve_with(DistanceMethod method, const std::vector<Pair18>& pairs) {
  Answers<Real> out;
  const std::vector<double> values = structure_of_arrays(pairs, out.stride);
  const std::vector<Real> rounded(values.begin(), values.end());
  const auto n = static_cast<std::size_t>(out.stride);
  out.distance.resize(n);
  out.points.resize(6 * n);
  out.code.resize(n);
  triangle_distances(method, PairBatch<Real>{rounded.data(), out.stride, static_cast<std::int64_t>(pairs.size())},
                     AnswerBatch<Real>{out.distance.data(), out.points.data(), out.code.data(), out.stride});
  return out;
}

/// Every family, and random pairs of which many intersect. Coordinates that single precision holds.
std::vector<Pair18> sample(int of_each) {
  Random random(77);
  std::vector<Pair18> pairs;
  for (int family = 1; family <= kFamilyCount; ++family)
    for (int i = 0; i < of_each; ++i) pairs.push_back(family_member(family, random));
  for (int i = 0; i < 4 * of_each; ++i) {
    Pair18 p;
    for (double& x : p) x = random.uniform(-1, 1);
    pairs.push_back(i % 2 == 0 ? random_integer_pair(random, -8, 8) : p);
  }
  for (Pair18& p : pairs)
    for (double& x : p) {
      const volatile float rounded = static_cast<float>(x);
      x = rounded;
    }
  return pairs;
}

TEST(DistanceMethods, brute_force_gives_the_bits_and_features_of_the_plain_interface) {
  const std::vector<Pair18> pairs = sample(60);
  const std::vector<TriangleDistance> plain = solve(pairs);
  const Answers<double> answers = solve_with<double>(DistanceMethod::brute_force, pairs);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    ASSERT_EQ(answers.distance[i], plain[i].distance);
    ASSERT_EQ(answers.point(0, i), plain[i].point_a);
    ASSERT_EQ(answers.point(1, i), plain[i].point_b);
    ASSERT_EQ(features_of(answers.code[i]), std::pair(plain[i].feature_a, plain[i].feature_b));
    ASSERT_FALSE(is_uncertified(answers.code[i]));
  }
}

template <class Real>
void check_methods(double roundoff, double penalty_tolerance) {
  const std::vector<Pair18> pairs = sample(std::getenv("SCREE_SLOW_TESTS") != nullptr ? 4000 : 150);
  const Answers<Real> hybrid = solve_with<Real>(DistanceMethod::hybrid, pairs);
  const Answers<Real> penalty = solve_with<Real>(DistanceMethod::penalty, pairs);
  std::size_t fallbacks = 0, certified = 0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const long double truth = oracle::distance(pairs[i].data());
    const double size = std::max(longest_edge(pairs[i]), static_cast<double>(truth));
    const double pierced_sliver = truth == 0 && aspect(pairs[i]) > 100 ? 4 * roundoff * aspect(pairs[i]) : 0;
    EXPECT_LE(static_cast<double>(std::abs(static_cast<long double>(hybrid.distance[i]) - truth)),
              std::max(5 * roundoff, pierced_sliver) * size)
        << "hybrid, pair " << i << ": " << hybrid.distance[i] << " for " << static_cast<double>(truth);
    EXPECT_FALSE(is_uncertified(hybrid.code[i]));
    fallbacks += fell_back(hybrid.code[i]) ? 1 : 0;
    EXPECT_GE(penalty.distance[i], 0) << "no number, pair " << i;
    EXPECT_TRUE(is_finite(penalty.point(0, i)) && is_finite(penalty.point(1, i)));
    if (is_uncertified(penalty.code[i])) continue;
    ++certified;
    EXPECT_LE(static_cast<double>(std::abs(static_cast<long double>(penalty.distance[i]) - truth)), penalty_tolerance * size)
        << "penalty said nothing, pair " << i << ": " << penalty.distance[i] << " for " << static_cast<double>(truth);
  }
  // both ways out are taken
  EXPECT_GT(fallbacks, pairs.size() / 20);
  EXPECT_LT(fallbacks, pairs.size() * 19 / 20);
  EXPECT_GT(certified, pairs.size() / 10);
}

TEST(DistanceMethods, hybrid_is_exact_and_penalty_flags_what_it_did_not_reach_in_double) {
  check_methods<double>(1.2e-16, kPenaltyToleranceDouble);
}
TEST(DistanceMethods, hybrid_is_exact_and_penalty_flags_what_it_did_not_reach_in_single) {
  check_methods<float>(6e-8, kPenaltyToleranceSingle);
}

/// Pairs and their copies with another order of the triangles and of their vertices: one distance, up to rounding.
template <class Real>
void check_orders(double roundoff) {
  std::vector<Pair18> pairs, moved;
  Random random(12);
  for (const Pair18& p : sample(60)) {
    const Pair18 q = permuted(p, random.integer(0, 35));
    pairs.push_back(p);
    moved.push_back(random.integer(0, 1) == 1 ? swapped(q) : q);
  }
  for (const DistanceMethod method : {DistanceMethod::brute_force, DistanceMethod::hybrid}) {
    const Answers<Real> one = solve_with<Real>(method, pairs), other = solve_with<Real>(method, moved);
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      const auto d = static_cast<double>(one.distance[i]), e = static_cast<double>(other.distance[i]);
      const double size = std::max(longest_edge(pairs[i]), d);
      const double pierced_sliver = d * e == 0 && aspect(pairs[i]) > 100 ? 4 * roundoff * aspect(pairs[i]) : 0;
      EXPECT_NEAR(d, e, std::max(10 * roundoff, pierced_sliver) * size) << i;
      if (pierced_sliver == 0) {
        EXPECT_EQ(d == 0, e == 0) << i;
      }
    }
  }
}
TEST(DistanceMethods, do_not_depend_on_the_order_of_triangles_and_vertices_beyond_rounding_in_double) { check_orders<double>(1.2e-16); }
TEST(DistanceMethods, do_not_depend_on_the_order_of_triangles_and_vertices_beyond_rounding_in_single) { check_orders<float>(6e-8); }

/// No coordinate and no square of an area, a fourth power of a length, loses bits at the ends of the range of the type.
/// (The kernel scales pairs that are small or large as a whole, but not a speck beside a boulder.)
template <class Real>
bool stays_in_range(const Pair18& p) {
  const double least = static_cast<double>(std::numeric_limits<Real>::min()) / static_cast<double>(std::numeric_limits<Real>::epsilon());
  const auto fits = [&](double x) { return x == 0 || (x > least && x < static_cast<double>(std::numeric_limits<Real>::max()) / 64); };
  for (const double x : p)
    if (!fits(std::abs(x))) return false;
  for (int side = 0; side < 6; side += 3) {
    const double area2 = length(cross(corner(p, side + 1) - corner(p, side), corner(p, side + 2) - corner(p, side)));
    const double size = longest_edge(p);
    if (!fits(area2 / size * area2 / size / size / size)) return false;
  }
  return true;
}

template <class Real>
void check_scales(const std::vector<int>& exponents) {
  const std::vector<Pair18> pairs = sample(60);
  std::size_t compared = 0;
  for (const DistanceMethod method : {DistanceMethod::brute_force, DistanceMethod::hybrid}) {
    const Answers<Real> reference = solve_with<Real>(method, pairs);
    for (const int exponent : exponents) {
      const double s = std::ldexp(1.0, exponent);
      std::vector<Pair18> larger;
      for (const Pair18& p : pairs) larger.push_back(scaled(p, s));
      const Answers<Real> answers = solve_with<Real>(method, larger);
      for (std::size_t i = 0; i < pairs.size(); ++i) {
        if (!stays_in_range<Real>(pairs[i]) || !stays_in_range<Real>(larger[i])) continue;
        ++compared;
        ASSERT_EQ(answers.distance[i], static_cast<Real>(s * static_cast<double>(reference.distance[i])))
            << "method " << static_cast<int>(method) << ", 2^" << exponent << ", pair " << i;
        ASSERT_EQ(answers.point(0, i), s * reference.point(0, i))
            << "method " << static_cast<int>(method) << ", 2^" << exponent << ", pair " << i;
        ASSERT_EQ(answers.point(1, i), s * reference.point(1, i))
            << "method " << static_cast<int>(method) << ", 2^" << exponent << ", pair " << i;
        ASSERT_EQ(features_of(static_cast<double>(answers.code[i])), features_of(static_cast<double>(reference.code[i]))) << i;
      }
    }
  }
  EXPECT_GT(compared, pairs.size() * exponents.size());
}
TEST(DistanceMethods, are_the_same_in_every_bit_under_scaling_by_a_power_of_two_in_double) {
  check_scales<double>({-400, -150, -31, 1, 31, 150, 400});
}
TEST(DistanceMethods, are_the_same_in_every_bit_under_scaling_by_a_power_of_two_in_single) {
  check_scales<float>({-40, -13, -1, 7, 25, 60});
}

template <class Real>
void check_targets(double roundoff) {
  const std::vector<Pair18> pairs = sample(60);
  for (const DistanceMethod method : {DistanceMethod::brute_force, DistanceMethod::hybrid, DistanceMethod::penalty}) {
    std::vector<Answers<Real>> fused, all;
    for (const char* name : {"avx512", "avx2", "sse4", "scalar"}) {
      try {
        limit_simd(name);
      } catch (const UsageError&) {
        continue;  // not on this processor
      }
      all.push_back(solve_with<Real>(method, pairs));
      if (simd_target().starts_with("AVX")) fused.push_back(all.back());
      limit_simd("best");
    }
    for (std::size_t k = 1; k < fused.size(); ++k)
      for (std::size_t i = 0; i < pairs.size(); ++i) {
        ASSERT_EQ(fused[k].distance[i], fused[0].distance[i]) << i;
        ASSERT_EQ(fused[k].code[i], fused[0].code[i]) << i;
        ASSERT_EQ(fused[k].point(0, i), fused[0].point(0, i)) << i;
        ASSERT_EQ(fused[k].point(1, i), fused[0].point(1, i)) << i;
      }
    if (method == DistanceMethod::penalty) continue;  // Newton magnifies a roundoff; its certificate is tested above
    for (std::size_t k = 1; k < all.size(); ++k)
      for (std::size_t i = 0; i < pairs.size(); ++i) {
        const auto d = static_cast<double>(all[0].distance[i]), e = static_cast<double>(all[k].distance[i]);
        const double pierced_sliver = d * e == 0 && aspect(pairs[i]) > 100 ? 4 * roundoff * aspect(pairs[i]) : 0;
        EXPECT_NEAR(d, e, std::max(10 * roundoff, pierced_sliver) * std::max(longest_edge(pairs[i]), d)) << i;
      }
  }
}
TEST(DistanceMethods, are_the_same_on_every_simd_target_and_bitwise_with_fused_multiply_add_in_double) { check_targets<double>(1.2e-16); }
TEST(DistanceMethods, are_the_same_on_every_simd_target_and_bitwise_with_fused_multiply_add_in_single) { check_targets<float>(6e-8); }

TEST(DistanceMethods, penalty_does_not_depend_on_the_unit_of_length) {
  const std::vector<Pair18> pairs = sample(40);
  std::vector<Pair18> larger;
  for (const Pair18& p : pairs) larger.push_back(scaled(p, 128));
  const Answers<double> small = solve_with<double>(DistanceMethod::penalty, pairs),
                        large = solve_with<double>(DistanceMethod::penalty, larger);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    ASSERT_EQ(large.distance[i], 128 * small.distance[i]);
    ASSERT_EQ(large.code[i], small.code[i]);
  }
}

TEST(DistanceMethods, the_features_of_the_penalty_method_are_those_of_brute_force_where_they_are_unique) {
  // a vertex over the inside of a face; an edge over an edge
  const Pair18 over_face = {-1, -1, 0, 2, -1, 0, 0, 2, 0, 0.1, 0.2, 0.5, 1, 0, 2, 0, 1, 2};
  const Pair18 over_edge = {-1, 0, 0, 1, 0, 0, 0, 0, -1, 0.25, -1, 0.5, 0.25, 2, 0.5, 0, 0, 2};
  for (const DistanceMethod method : {DistanceMethod::brute_force, DistanceMethod::penalty, DistanceMethod::hybrid}) {
    const Answers<double> answers = solve_with<double>(method, {over_face, over_edge, swapped(over_face)});
    EXPECT_EQ(features_of(answers.code[0]), std::pair(Feature::face, Feature::vertex0));
    EXPECT_EQ(features_of(answers.code[1]), std::pair(Feature::edge0, Feature::edge0));
    EXPECT_EQ(features_of(answers.code[2]), std::pair(Feature::vertex0, Feature::face));
    EXPECT_NEAR(answers.distance[0], 0.5, 1e-15);
    EXPECT_NEAR(answers.distance[1], 0.5, 1e-15);
  }
}

TEST(DistanceMethods, have_names) {
  EXPECT_EQ(distance_method_of("hybrid"), DistanceMethod::hybrid);
  EXPECT_THROW(distance_method_of("fast"), UsageError);
}

}  // namespace
}  // namespace scree
