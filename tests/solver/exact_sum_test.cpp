// Sums in any order: against rational arithmetic (GMP's doubles are exact) and against themselves in another order.
#include <gmpxx.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>

#include "solver/ranks/exact_sum.hpp"

namespace scree {
namespace {

std::vector<double> wild_terms(unsigned seed, int count) {
  std::mt19937_64 g(seed);
  std::uniform_real_distribution<double> mantissa(-1, 1);
  std::uniform_int_distribution<int> exponent(-300, 300);
  std::vector<double> terms;
  for (int i = 0; i < count; ++i) terms.push_back(std::ldexp(mantissa(g), exponent(g)));
  return terms;
}

TEST(ExactSum, agrees_with_rational_numbers_to_one_unit_in_the_last_place) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    std::vector<double> terms = wild_terms(seed, 500);
    // most of it cancels: what is left is far smaller than the terms
    for (std::size_t i = 0; i + 1 < terms.size() / 2; ++i) terms.push_back(-terms[i]);
    ExactSum sum;
    mpq_class exact = 0;
    for (const double t : terms) {
      sum.add(t);
      exact += mpq_class(t);
    }
    const double value = sum.value();
    const double below = std::nextafter(value, -std::numeric_limits<double>::infinity());
    const double above = std::nextafter(value, std::numeric_limits<double>::infinity());
    EXPECT_GE(exact, mpq_class(below));
    EXPECT_LE(exact, mpq_class(above));
  }
}

TEST(ExactSum, has_the_same_words_in_any_order_and_in_any_parts) {
  std::vector<double> terms = wild_terms(3, 2000);
  ExactSum forward;
  for (const double t : terms) forward.add(t);
  std::shuffle(terms.begin(), terms.end(), std::mt19937(5));
  ExactSum shuffled;
  for (const double t : terms) shuffled.add(t);
  EXPECT_EQ(forward.words(), shuffled.words());

  ExactSum parts[3];  // as threads add up
  for (std::size_t i = 0; i < terms.size(); ++i) parts[i % 3].add(terms[i]);
  for (const int other : {2, 1}) parts[0].add(parts[other]);
  EXPECT_EQ(forward.words(), parts[0].words());

  ExactSum first, second;  // as two ranks would, or a run and its restart
  for (std::size_t i = 0; i < terms.size(); ++i) (i % 3 == 0 ? first : second).add(terms[i]);
  ExactSum::Words both = first.words();
  for (std::size_t i = 0; i < both.size(); ++i) both[i] += second.words()[i];
  ExactSum joined;
  joined.set_words(both);
  EXPECT_EQ(forward.words(), joined.words());
}

void expect_many_as_one_by_one(const std::vector<double>& terms, const char* what) {
  for (std::size_t count = 0; count <= terms.size(); ++count) {
    ExactSum one_by_one, together;
    for (std::size_t i = 0; i < count; ++i) one_by_one.add(terms[i]);
    ManyTerms some;
    some.fill(7);  // what lies beyond is not a term
    std::copy_n(terms.begin(), count, some.begin());
    together.add_many(some, count);
    ASSERT_EQ(one_by_one.words(), together.words()) << what << ", " << count << " terms";
  }
}

TEST(ExactSum, many_terms_at_once_have_the_words_of_one_after_the_other) {
  constexpr double kMost = std::numeric_limits<double>::max(), kLeast = std::numeric_limits<double>::denorm_min();
  constexpr double kInfinite = std::numeric_limits<double>::infinity(), kNone = std::numeric_limits<double>::quiet_NaN();
  std::mt19937_64 g(11);
  std::normal_distribution<double> near(1e-7, 1e-8);
  std::vector<double> alike(64), edges = {1, -1, 0, -0.0, 0x1p-53, -0x1p-52, 3, kLeast, -0x1p-1022, 0x1p-900, 0x1p-899, -0x1p900, 1e-160};
  for (double& t : alike) t = near(g);
  std::vector<double> powers;
  for (int k = 0; k < 64; ++k) powers.push_back(std::ldexp(k % 3 == 0 ? -1.0 : 1.0, 3 * k - 90));
  const auto with = [&](double odd) {
    std::vector<double> terms = alike;
    terms[17] = odd;
    return terms;
  };
  for (unsigned seed = 1; seed <= 5; ++seed) {
    expect_many_as_one_by_one(wild_terms(seed, 64), "wild");
  }
  for (const double odd : {0.0, kLeast, 0x1p-108, -0x1p-107, 0x1p-106, 1e-40, 1e25, kMost, kInfinite, kNone}) {
    expect_many_as_one_by_one(with(odd), "alike");
  }
  expect_many_as_one_by_one(edges, "edges");
  expect_many_as_one_by_one(powers, "powers of two");
}

TEST(ExactSum, holds_the_smallest_and_the_largest_double_and_tells_what_is_no_number) {
  using Limits = std::numeric_limits<double>;
  ExactSum sum;
  for (const double t : {Limits::max(), Limits::denorm_min(), -Limits::max()}) sum.add(t);
  EXPECT_EQ(sum.value(), Limits::denorm_min());
  sum.add(-Limits::denorm_min());
  EXPECT_EQ(sum.value(), 0.0);
  sum.add(Limits::quiet_NaN());
  EXPECT_TRUE(std::isnan(sum.value()));
}

TEST(ShortSum, has_the_same_words_in_any_order_and_the_value_of_the_exact_sum) {
  std::mt19937_64 g(7);
  std::uniform_real_distribution<double> mantissa(-1, 1);
  std::uniform_int_distribution<int> exponent(-100, 60);
  std::vector<double> terms;
  for (int i = 0; i < 3000; ++i) terms.push_back(std::ldexp(mantissa(g), exponent(g)));
  ShortSum forward, shuffled;
  ExactSum exact;
  for (const double t : terms) {
    forward.add(t);
    exact.add(t);
  }
  EXPECT_EQ(forward.value(), exact.value());
  std::shuffle(terms.begin(), terms.end(), std::mt19937(5));
  for (const double t : terms) shuffled.add(t);
  EXPECT_EQ(forward.words(), shuffled.words());
}

TEST(ShortSum, cuts_off_what_is_below_its_last_bit_and_tells_what_is_too_large) {
  ShortSum sum;
  sum.add(std::ldexp(1.0, -160));
  EXPECT_EQ(sum.value(), std::ldexp(1.0, -160));
  sum.add(std::ldexp(1.9, -161));  // nothing of it reaches 2^-160
  sum.add(-std::ldexp(1.9, -161));
  sum.add(std::ldexp(1.0, -1074));
  EXPECT_EQ(sum.value(), std::ldexp(1.0, -160));
  sum.add(std::ldexp(1.75, -160));  // the fraction of the last bit goes
  EXPECT_EQ(sum.value(), std::ldexp(2.0, -160));
  sum.add(1e20);
  sum.add(-1e20);
  EXPECT_EQ(sum.value(), std::ldexp(2.0, -160));
  sum.add(1e40);
  EXPECT_TRUE(std::isnan(sum.value()));
}

}  // namespace
}  // namespace scree
