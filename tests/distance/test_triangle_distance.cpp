// The triangle-triangle distance against exact arithmetic. Bounds: 5 roundoffs of max(L, d), L the longest edge.
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>

#include "core/base/error.hpp"
#include "tests/distance/exact_oracle.hpp"
#include "tests/distance/families.hpp"

namespace scree {
namespace {

constexpr double kDoubleBound = 5 * 1.1102230246251565e-16, kSingleBound = 5 * 5.9604645e-8;

/// Members of each test: 1e4 a family and 1e6 integer pairs in the slow run, a tenth of that otherwise.
int members(int fast, int slow) { return std::getenv("SCREE_SLOW_TESTS") != nullptr ? slow : fast; }

Pair18 rounded_to_single(const Pair18& p) {
  Pair18 q;
  for (std::size_t i = 0; i < 18; ++i) {
    // volatile: GCC 12 at -O3 drops the conversion to float and back in the last two turns of the loop
    const volatile float rounded = static_cast<float>(p[i]);
    q[i] = rounded;
  }
  return q;
}

bool has_number(const TriangleDistance& d) {
  return d.distance >= 0 && is_finite(d.point_a) && is_finite(d.point_b) && is_finite(d.normal);
}

/// Checks one answer against the truth; returns the error in units of max(L, d).
double check(const Pair18& p, const TriangleDistance& answer, long double truth, const std::string& what) {
  const double size = std::max(longest_edge(p), static_cast<double>(truth));
  EXPECT_TRUE(has_number(answer)) << what;
  if (size == 0) {
    EXPECT_EQ(answer.distance, 0) << what;
    return 0;
  }
  const double error = static_cast<double>(std::abs(answer.distance - truth)) / size;
  // a pierced sliver may keep a distance of the width of its own rounding; nothing else may be wrong about meeting
  const double allowed = truth == 0 && aspect(p) > 100 ? 4 * 1.2e-16 * aspect(p) : kDoubleBound;
  EXPECT_LE(error, allowed) << what << ": " << answer.distance << " for " << static_cast<double>(truth);
  if (answer.intersecting || allowed == kDoubleBound) {
    EXPECT_EQ(answer.intersecting, truth == 0) << what << ": distance " << static_cast<double>(truth);
  }
  EXPECT_EQ(answer.intersecting, answer.distance == 0) << what;
  if (answer.intersecting) {
    EXPECT_EQ(answer.normal, Vec3{}) << what;
  } else {
    EXPECT_NEAR(length(answer.normal), 1, 1e-15) << what;
  }
  return error;
}

/// Distance of a point to a triangle by the kernel's own answer for a degenerate triangle, checked elsewhere.
double off_triangle(const Pair18& p, int side, const Vec3& point) {
  const Vec3 face[3] = {corner(p, side), corner(p, side + 1), corner(p, side + 2)}, here[3] = {point, point, point};
  return triangle_distance(face, here).distance;
}

TEST(TriangleDistance, agrees_with_all_named_cases) {
  std::ifstream file(SCREE_TEST_DATA "/ttd_cases.json");
  ASSERT_TRUE(file.good());
  const nlohmann::json cases = nlohmann::json::parse(file);
  ASSERT_EQ(cases.size(), 40u);
  for (const nlohmann::json& c : cases) {
    const std::string name = c["name"];
    Pair18 p;
    for (std::size_t k = 0; k < 18; ++k) {
      const std::string text = c[k < 9 ? "A" : "B"][k % 9 / 3][k % 3];
      p[k] = std::strtod(text.c_str(), nullptr);
    }
    const std::string squared = c["d2"];
    const mpq_class d2(squared);
    const long double truth = oracle::root(oracle::Fraction<mpz_class>{d2.get_num(), d2.get_den()});
    // the case file and the oracle agree: they were written apart
    EXPECT_NEAR(static_cast<double>(oracle::distance(p.data())), static_cast<double>(truth), 1e-18 + 1e-18 * static_cast<double>(truth))
        << name;
    const TriangleDistance answer = solve({p})[0];
    check(p, answer, truth, name);
    if (c["unique"] && !answer.intersecting) {
      for (int k = 0; k < 3; ++k) {
        const auto i = static_cast<std::size_t>(k);
        const double tolerance = 1e-9 * std::max(longest_edge(p), static_cast<double>(truth));
        EXPECT_NEAR(answer.point_a[k], mpq_class(std::string(c["pA"][i])).get_d(), tolerance) << name;
        EXPECT_NEAR(answer.point_b[k], mpq_class(std::string(c["pB"][i])).get_d(), tolerance) << name;
      }
    }
  }
}

TEST(TriangleDistance, agrees_with_exact_arithmetic_on_random_integer_pairs) {
  Random random(11);
  for (const int range : {1, 2, 8}) {
    std::vector<Pair18> pairs(static_cast<std::size_t>(members(40000, 350000)));
    for (Pair18& p : pairs) p = random_integer_pair(random, -range, range);
    const std::vector<TriangleDistance> answers = solve(pairs);
    const std::vector<double> distances = solve_distances(pairs);
    const std::vector<float> single = solve_single(pairs);
    int intersecting = 0;
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      oracle::Point<oracle::Int128> a[3], b[3];
      for (std::size_t k = 0; k < 9; ++k) {
        a[k / 3][k % 3] = static_cast<int>(pairs[i][k]);
        b[k / 3][k % 3] = static_cast<int>(pairs[i][9 + k]);
      }
      const long double truth = oracle::root(oracle::SquaredDistance<oracle::Int128>::of(a, b));
      check(pairs[i], answers[i], truth, "integers, pair " + std::to_string(i));
      EXPECT_EQ(distances[i], answers[i].distance);
      EXPECT_LE(static_cast<double>(std::abs(single[i] - truth)),
                kSingleBound * std::max(longest_edge(pairs[i]), static_cast<double>(truth)));
      EXPECT_EQ(single[i] == 0, truth == 0);
      intersecting += truth == 0 ? 1 : 0;
    }
    EXPECT_GT(intersecting, static_cast<int>(pairs.size()) / 5);
  }
}

/// Thin triangles on both sides of the aspect (2^9) at which the kernel gives up its short cuts, one edge of each nearly
/// parallel to one of the other, a small or a large gap between them, sizes that differ.
Pair18 thin_pair(Random& r) {
  Vec3 t[2][3];
  const auto power = [&](double low, double high) { return std::exp2(r.uniform(low, high)); };
  for (Vec3* p : {t[0], t[1]}) {
    const double height = power(-11, 0), at = r.integer(0, 1) == 1 ? r.uniform(-0.5, 1.5) : r.integer(0, 1) + r.uniform(-1, 1) * height;
    p[0] = {0, 0, 0};
    p[1] = {1, 0, 0};
    p[2] = {at, height, 0};
  }
  const double angle = power(-40, 0), tilt = power(-40, 0), size = r.integer(0, 1) == 1 ? 1 : power(-12, 0);
  const Vec3 gap{r.uniform(-1, 1), power(-40, 0) - power(-40, 0), power(-34, 0)};
  for (Vec3& v : t[1]) {
    v = {v.x * std::cos(angle) - v.y * std::sin(angle), v.x * std::sin(angle) + v.y * std::cos(angle), v.z + tilt * (v.y + v.x)};
    v = size * v + gap;
  }
  const Quat q = r.rotation();
  Pair18 pair;
  for (std::size_t k = 0; k < 6; ++k) {
    const Vec3 v = rotate(q, t[k / 3][k % 3]);
    for (std::size_t c = 0; c < 3; ++c) pair[3 * k + c] = v[static_cast<int>(c)];
  }
  return permuted(pair, r.integer(0, 35));
}

TEST(TriangleDistance, agrees_with_exact_arithmetic_on_thin_nearly_parallel_pairs) {
  Random random(21);
  std::vector<Pair18> pairs(static_cast<std::size_t>(members(5000, 200000)));
  for (Pair18& p : pairs) p = thin_pair(random);
  const std::vector<TriangleDistance> answers = solve(pairs);
  const std::vector<float> single = solve_single(pairs);
  double worst = 0, worst_single = 0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const std::string what = "thin, pair " + std::to_string(i);
    worst = std::max(worst, check(pairs[i], answers[i], oracle::distance(pairs[i].data()), what));
    const Pair18 rounded = rounded_to_single(pairs[i]);
    const long double truth = oracle::distance(rounded.data());
    if (truth == 0) continue;
    const double error = static_cast<double>(std::abs(single[i] - truth)) / std::max(longest_edge(rounded), static_cast<double>(truth));
    EXPECT_LE(error, kSingleBound) << what << " in single precision";
    worst_single = std::max(worst_single, error);
  }
  RecordProperty("worst_roundoffs_double", std::to_string(worst / 1.1102230246251565e-16));
  RecordProperty("worst_roundoffs_single", std::to_string(worst_single / 5.9604645e-8));
}

class Families : public testing::TestWithParam<int> {};

TEST_P(Families, agree_with_exact_arithmetic) {
  const int family = GetParam();
  Random random(100 + static_cast<std::uint64_t>(family));
  std::vector<Pair18> pairs(static_cast<std::size_t>(members(500, 10000))), singles;
  for (Pair18& p : pairs) {
    p = family_member(family, random);
    singles.push_back(rounded_to_single(p));
  }
  const std::vector<TriangleDistance> answers = solve(pairs);
  const std::vector<float> single = solve_single(pairs);
  double worst = 0, worst_single = 0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const std::string what = family_name(family) + ", member " + std::to_string(i);
    const long double truth = oracle::distance(pairs[i].data());
    worst = std::max(worst, check(pairs[i], answers[i], truth, what));
    // closest points lie on their triangles and are as far apart as the distance says
    if (answers[i].distance > 0) {
      double coordinate = static_cast<double>(truth);
      for (const double x : pairs[i]) coordinate = std::max(coordinate, std::abs(x));
      EXPECT_LE(off_triangle(pairs[i], 0, answers[i].point_a), 8 * 1.2e-16 * coordinate) << what;
      EXPECT_LE(off_triangle(pairs[i], 3, answers[i].point_b), 8 * 1.2e-16 * coordinate) << what;
      EXPECT_NEAR(length(answers[i].point_a - answers[i].point_b), answers[i].distance, 8 * 1.2e-16 * coordinate) << what;
    }
    // single precision, against the truth of the rounded coordinates
    const long double single_truth = oracle::distance(singles[i].data());
    const double size = std::max(longest_edge(singles[i]), static_cast<double>(single_truth));
    const double error = size > 0 ? static_cast<double>(std::abs(single[i] - single_truth)) / size : std::abs(single[i]);
    const double allowed = single_truth == 0 && aspect(singles[i]) > 100 ? 4 * 6e-8 * aspect(singles[i]) : kSingleBound;
    EXPECT_LE(error, allowed) << what << " in single precision: " << single[i] << " for " << static_cast<double>(single_truth);
    if (single[i] == 0 || allowed == kSingleBound) {
      EXPECT_EQ(single[i] == 0, single_truth == 0) << what << " in single precision: distance " << static_cast<double>(single_truth);
    }
    worst_single = std::max(worst_single, error);
  }
  RecordProperty("worst_roundoffs_double", std::to_string(worst / 1.1102230246251565e-16));
  RecordProperty("worst_roundoffs_single", std::to_string(worst_single / 5.9604645e-8));
}
INSTANTIATE_TEST_SUITE_P(TriangleDistance, Families, testing::Range(1, kFamilyCount + 1));

TEST(TriangleDistance, is_the_same_in_every_bit_when_both_triangles_are_scaled_by_a_power_of_two) {
  Random random(5);
  std::vector<Pair18> pairs;
  for (int i = 0; i < 4000; ++i) pairs.push_back(family_member(1 + i % kFamilyCount, random));
  for (int i = 0; i < 4000; ++i) {
    Pair18 p;
    for (double& x : p) x = random.uniform(-1, 1);
    pairs.push_back(p);
  }
  const std::vector<TriangleDistance> reference = solve(pairs);
  for (const int exponent : {-400, -200, -60, -7, 1, 13, 60, 200, 400}) {
    const double s = std::ldexp(1.0, exponent);
    std::vector<Pair18> larger;
    for (const Pair18& p : pairs) larger.push_back(scaled(p, s));
    const std::vector<TriangleDistance> answers = solve(larger);
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      ASSERT_EQ(answers[i].distance, s * reference[i].distance) << "2^" << exponent << ", pair " << i;
      ASSERT_EQ(answers[i].point_a, s * reference[i].point_a) << "2^" << exponent << ", pair " << i;
      ASSERT_EQ(answers[i].point_b, s * reference[i].point_b);
      ASSERT_EQ(answers[i].normal, reference[i].normal);
      ASSERT_EQ(answers[i].feature_a, reference[i].feature_a);
    }
  }
}

TEST(TriangleDistance, does_not_depend_on_the_order_of_triangles_and_vertices_beyond_rounding) {
  Random random(6);
  for (int trial = 0; trial < 400; ++trial) {
    Pair18 p = trial % 2 == 0 ? random_integer_pair(random, -8, 8) : family_member(1 + trial / 2 % kFamilyCount, random);
    std::vector<Pair18> pairs;
    for (int order = 0; order < 36; ++order) {
      pairs.push_back(permuted(p, order));
      pairs.push_back(swapped(pairs.back()));
    }
    const std::vector<TriangleDistance> answers = solve(pairs);
    const double size = std::max(longest_edge(p), answers[0].distance);
    const double allowed = answers[0].distance < 1e-6 * size && aspect(p) > 100 ? 8 * 1.2e-16 * aspect(p) : kDoubleBound;
    for (std::size_t i = 1; i < pairs.size(); ++i) {
      EXPECT_NEAR(answers[i].distance, answers[0].distance, allowed * size);
    }
  }
}

TEST(TriangleDistance, of_a_pair_does_not_depend_on_its_neighbours_in_the_batch) {
  Random random(7);
  std::vector<Pair18> pairs;
  for (int i = 0; i < 1003; ++i)
    pairs.push_back(i % 3 == 0 ? random_integer_pair(random, -2, 2) : family_member(1 + i % kFamilyCount, random));
  const std::vector<TriangleDistance> together = solve(pairs);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const TriangleDistance alone = solve({pairs[i]})[0];
    ASSERT_EQ(alone.distance, together[i].distance) << i;
    ASSERT_EQ(alone.point_a, together[i].point_a) << i;
    ASSERT_EQ(alone.normal, together[i].normal) << i;
    ASSERT_EQ(alone.feature_b, together[i].feature_b) << i;
  }
}

/// Restores the best target when a test ends.
struct BestTarget {
  ~BestTarget() { limit_simd("best"); }
};

TEST(TriangleDistance, is_the_same_on_every_simd_target_and_bitwise_with_fused_multiply_add) {
  const BestTarget restore;
  Random random(8);
  std::vector<Pair18> pairs;
  for (int i = 0; i < 6000; ++i) {
    Pair18 p;
    for (double& x : p) x = random.uniform(-1, 1);
    pairs.push_back(i % 2 == 0 ? p : family_member(1 + i / 2 % kFamilyCount, random));
  }
  std::vector<TriangleDistance> best, widest;
  std::vector<float> widest_single;
  int targets = 0;
  for (const char* name : {"avx512", "avx2", "sse4", "scalar"}) {
    try {
      limit_simd(name);
    } catch (const UsageError&) {
      continue;  // not on this processor
    }
    ++targets;
    const std::vector<TriangleDistance> answers = solve(pairs);
    const std::vector<float> single = solve_single(pairs);
    if (best.empty()) best = answers;
    const bool fused = simd_target().starts_with("AVX");
    if (fused && widest.empty()) {
      widest = answers;
      widest_single = single;
    }
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      const double size = std::max(longest_edge(pairs[i]), best[i].distance);
      const double allowed = aspect(pairs[i]) > 100 ? 8 * 1.2e-16 * std::min(aspect(pairs[i]), 1e6) : kDoubleBound;
      EXPECT_NEAR(answers[i].distance, best[i].distance, allowed * size) << name << ", pair " << i;
      if (!fused) continue;
      ASSERT_EQ(answers[i].distance, widest[i].distance) << name << ", pair " << i;
      ASSERT_EQ(answers[i].point_a, widest[i].point_a) << name << ", pair " << i;
      ASSERT_EQ(answers[i].point_b, widest[i].point_b) << name << ", pair " << i;
      ASSERT_EQ(answers[i].normal, widest[i].normal) << name << ", pair " << i;
      ASSERT_EQ(single[i], widest_single[i]) << name << ", pair " << i;
    }
  }
  EXPECT_GE(targets, 1);
}

TEST(TriangleDistance, refuses_an_unknown_simd_target) {
  const BestTarget restore;
  EXPECT_THROW(limit_simd("avx1024"), UsageError);
}

TEST(TriangleDistance, gives_the_feature_normal_when_a_vertex_all_but_touches_a_face) {
  // height 2^-40 over a face that is tilted in all axes: the difference of the points alone would be off by 1e-4
  const Quat q = normalised(Quat{0.3, 0.5, -0.2, 0.7});
  const Vec3 normal = rotate(q, {0, 0, 1});
  for (const double height : {0x1p-30, 0x1p-40, 0x1p-44}) {
    const Vec3 a[3] = {rotate(q, {-1, -1, 0}), rotate(q, {2, -1, 0}), rotate(q, {0, 2, 0})};
    const Vec3 b[3] = {rotate(q, {0.1, 0.2, height}), rotate(q, {1, 0, 2}), rotate(q, {0, 1, 2})};
    const TriangleDistance d = triangle_distance(a, b);
    EXPECT_FALSE(d.intersecting);
    EXPECT_EQ(d.feature_a, Feature::face);
    EXPECT_EQ(d.feature_b, Feature::vertex0);
    EXPECT_LE(length(d.normal + normal), 1e-15);
  }
}

TEST(TriangleDistance, gives_the_common_normal_when_edges_all_but_touch) {
  for (const double height : {0x1p-30, 0x1p-40, 0x1p-44}) {
    const Vec3 a[3] = {{-1, 0, 0}, {1, 0, 0}, {0, 0, -1}}, b[3] = {{0.25, -1, height}, {0.25, 2, height}, {0, 0, 2}};
    const TriangleDistance d = triangle_distance(a, b);
    EXPECT_EQ(d.feature_a, Feature::edge0);
    EXPECT_EQ(d.feature_b, Feature::edge0);
    EXPECT_LE(length(d.normal - Vec3{0, 0, -1}), 1e-15);
    EXPECT_NEAR(d.distance, height, kDoubleBound * 3);
  }
}

TEST(TriangleDistance, says_not_a_number_for_coordinates_that_are_none) {
  Pair18 p = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 0, 1, 0, 1, 1};
  for (std::size_t i = 0; i < 18; ++i) {
    Pair18 q = p;
    q[i] = std::nan("");
    EXPECT_TRUE(std::isnan(solve_distances({q})[0])) << "coordinate " << i;
  }
}

}  // namespace
}  // namespace scree
