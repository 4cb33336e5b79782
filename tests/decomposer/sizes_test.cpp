// Size distributions against their closed forms, and the random numbers behind them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/placing/random_numbers.hpp"
#include "core/storage/size_distribution.hpp"

namespace scree {
namespace {

using Kind = SizeDistribution::Kind;
constexpr int kCount = 20000;

struct Moments {
  double mean = 0, deviation = 0;
};

Moments sampled(const SizeDistribution& d) {
  double sum = 0, square = 0;
  for (int i = 0; i < kCount; ++i) {
    const double x = d.quantile(RandomNumbers(11, i, 0).uniform(0));
    EXPECT_GE(x, d.min);
    EXPECT_LE(x, d.max);
    sum += x;
    square += x * x;
  }
  const double mean = sum / kCount;
  return {mean, std::sqrt(square / kCount - mean * mean)};
}

/// Four standard errors: one test in 16000 would fail by chance, and the seed is fixed.
void expect_mean(const SizeDistribution& d, double mean) {
  const Moments m = sampled(d);
  EXPECT_NEAR(m.mean, mean, 4 * m.deviation / std::sqrt(kCount));
}

double density(double z) { return std::exp(-0.5 * z * z) / std::sqrt(2 * std::numbers::pi); }
double phi(double z) { return 0.5 * std::erfc(-z / std::numbers::sqrt2); }

TEST(Sizes, a_uniform_distribution_has_its_mean_and_deviation) {
  const SizeDistribution d{Kind::uniform, 0, 0, 0.008, 0.02};
  expect_mean(d, 0.014);
  EXPECT_NEAR(sampled(d).deviation, 0.012 / std::sqrt(12.0), 5e-5);
}

TEST(Sizes, a_truncated_normal_has_its_mean) {
  const SizeDistribution d{Kind::normal, 0.012, 0.004, 0.008, 0.024};
  const double a = -1, b = 3;
  expect_mean(d, 0.012 + 0.004 * (density(a) - density(b)) / (phi(b) - phi(a)));
}

TEST(Sizes, a_truncated_lognormal_has_its_mean) {
  const double median = 0.012, sigma = 0.2;
  const SizeDistribution d{Kind::lognormal, median, sigma, 0.008, 0.02};
  const double a = std::log(0.008 / median) / sigma, b = std::log(0.02 / median) / sigma;
  expect_mean(d, median * std::exp(0.5 * sigma * sigma) * (phi(b - sigma) - phi(a - sigma)) / (phi(b) - phi(a)));
}

TEST(Sizes, a_wide_lognormal_has_its_median) {
  const SizeDistribution d{Kind::lognormal, 0.012, 0.2, 1e-6, 10};
  EXPECT_NEAR(d.quantile(0.5), 0.012, 1e-12);
  EXPECT_NEAR(d.quantile(0.975), 0.012 * std::exp(0.2 * 1.959963984540054), 1e-10);
}

TEST(Sizes, a_weibull_distribution_inverts_its_closed_form) {
  const SizeDistribution d{Kind::weibull, 0.01, 2.5, 1e-9, 1};
  for (const double u : {0.1, 0.5, 0.9}) EXPECT_NEAR(d.quantile(u), 0.01 * std::pow(-std::log1p(-u), 1 / 2.5), 1e-9);
}

TEST(Sizes, a_power_law_has_its_mean_also_at_exponent_one) {
  const double low = 0.005, high = 0.05;
  const SizeDistribution fractal{Kind::power, 2.5, 0, low, high};  // f ~ d^-2.5
  const auto integral = [&](double power) { return (std::pow(high, power) - std::pow(low, power)) / power; };
  expect_mean(fractal, integral(-0.5) / integral(-1.5));
  const SizeDistribution harmonic{Kind::power, 1, 0, low, high};
  expect_mean(harmonic, (high - low) / std::log(high / low));
}

TEST(Sizes, the_ends_of_a_distribution_are_its_bounds) {
  for (const Kind kind : {Kind::uniform, Kind::normal, Kind::lognormal, Kind::weibull, Kind::power}) {
    const SizeDistribution d{kind, 0.01, 0.5, 0.008, 0.02};
    EXPECT_NEAR(d.quantile(0), 0.008, 1e-12);
    EXPECT_NEAR(d.quantile(1 - 1e-12), 0.02, 1e-9);
  }
}

/// Largest difference between the distribution function of a sample and a closed form, written again here.
template <class Cdf>
double distance_to(std::vector<double> sample, bool by_mass, Cdf&& cdf) {
  std::sort(sample.begin(), sample.end());
  double total = 0, below = 0, worst = 0;
  for (const double d : sample) total += by_mass ? d * d * d : 1;
  for (const double d : sample) {
    const double above = below + (by_mass ? d * d * d : 1) / total;
    worst = std::max({worst, std::abs(above - cdf(d)), std::abs(below - cdf(d))});
    below = above;
  }
  return worst;
}

std::vector<double> evenly_sampled(const SizeDistribution& d, int count) {
  const SizeSampler sampler(d);
  std::vector<double> sample;
  for (int i = 0; i < count; ++i) sample.push_back(sampler.diameter((i + 0.5) / count));
  return sample;
}

TEST(Sizes, shares_by_mass_follow_their_closed_forms) {
  // what even numbers leave: half a step of 1e-5 by number, times the mass of the largest over the mean
  constexpr double kStep = 2e-4;
  SizeDistribution uniform{Kind::uniform, 0, 0, 1, 3};
  uniform.by_mass = true;
  EXPECT_LT(distance_to(evenly_sampled(uniform, 100000), true, [](double d) { return (d - 1) / 2; }), kStep);
  SizeDistribution normal{Kind::lognormal, 2, 0.4, 1e-1, 20};
  normal.by_mass = true;
  // Hatch and Choate (1929): by number the median is less by exp(-3 sigma^2), with the same sigma
  const std::vector<double> sample = evenly_sampled(normal, 100000);
  EXPECT_LT(distance_to(sample, false, [](double d) { return phi((std::log(d / 2) + 3 * 0.16) / 0.4); }), 1e-4);
}

TEST(Sizes, a_sieve_curve_is_met_by_mass) {
  SizeDistribution sieve;
  sieve.kind = Kind::sieve;
  sieve.by_mass = true;
  sieve.sieve = {0.063, 0.125, 0.5, 1, 2};
  sieve.passing = {0, 0.1, 0.1, 0.7, 1};  // nothing between 0.125 and 0.5
  sieve.min = 0.063;
  sieve.max = 2;
  const std::vector<double> sample = evenly_sampled(sieve, 100000);
  double mass = 0, fine = 0, middle = 0;
  for (const double d : sample) {
    mass += d * d * d;
    fine += d < 0.3 ? d * d * d : 0;
    middle += d < 1 ? d * d * d : 0;
    EXPECT_FALSE(d > 0.1251 && d < 0.4999);
  }
  EXPECT_NEAR(fine / mass, 0.1, 2e-3);
  EXPECT_NEAR(middle / mass, 0.7, 2e-3);
  EXPECT_NEAR(sieve.share(std::sqrt(0.5)), 0.4, 1e-12);  // half way in log d
  EXPECT_NEAR(sieve.quantile(0.4), std::sqrt(0.5), 1e-12);
}

TEST(Sizes, a_comparison_finds_a_sample_that_does_not_follow) {
  const SizeDistribution d{Kind::uniform, 0, 0, 1, 2};
  const SizeComparison same = compare_sizes(d, evenly_sampled(d, 1000));
  EXPECT_LT(same.kolmogorov_smirnov, 1e-3);
  EXPECT_NEAR(same.got[1], 1.5, 2e-3);
  // everything shifted by a tenth of the range
  std::vector<double> shifted = evenly_sampled(d, 1000);
  for (double& x : shifted) x += 0.1;
  EXPECT_NEAR(compare_sizes(d, shifted).kolmogorov_smirnov, 0.1, 1e-3);
}

TEST(RandomNumbers, are_a_function_of_seed_id_and_attempt) {
  EXPECT_EQ(RandomNumbers(1, 2, 3).uniform(4), RandomNumbers(1, 2, 3).uniform(4));
  EXPECT_NE(RandomNumbers(1, 2, 3).uniform(4), RandomNumbers(2, 2, 3).uniform(4));
  EXPECT_NE(RandomNumbers(1, 2, 3).uniform(4), RandomNumbers(1, 3, 3).uniform(4));
  EXPECT_NE(RandomNumbers(1, 2, 3).uniform(4), RandomNumbers(1, 2, 4).uniform(4));
  EXPECT_NE(RandomNumbers(1, 2, 3).uniform(4), RandomNumbers(1, 2, 3).uniform(5));
}

TEST(RandomNumbers, are_uniform_and_uncorrelated_between_neighbours) {
  double sum = 0, square = 0, product = 0, last = 0.5;
  for (int i = 0; i < kCount; ++i) {
    const double u = RandomNumbers(3, i, 1).uniform(0);
    ASSERT_GE(u, 0);
    ASSERT_LT(u, 1);
    sum += u - 0.5;
    square += (u - 0.5) * (u - 0.5);
    product += (u - 0.5) * (last - 0.5);
    last = u;
  }
  EXPECT_NEAR(sum / kCount, 0, 4 * std::sqrt(1.0 / 12 / kCount));
  EXPECT_NEAR(square / kCount, 1.0 / 12, 4 * std::sqrt(1.0 / 180 / kCount));
  EXPECT_NEAR(product / kCount, 0, 4.0 / 12 / std::sqrt(kCount));
}

TEST(RandomNumbers, orientations_favour_no_direction) {
  // of a uniformly turned unit vector every component has mean 0 and mean square 1/3
  for (const Vec3& axis : {Vec3{1, 0, 0}, Vec3{0, 0, 1}}) {
    Vec3 mean, square;
    for (int i = 0; i < kCount; ++i) {
      const Quat q = RandomNumbers(5, i, 1).orientation(0);
      ASSERT_NEAR(norm(q), 1, 1e-15);
      const Vec3 v = rotate(q, axis);
      mean += (1.0 / kCount) * v;
      square += (1.0 / kCount) * Vec3{v.x * v.x, v.y * v.y, v.z * v.z};
    }
    for (int k = 0; k < 3; ++k) {
      EXPECT_NEAR(mean[k], 0, 4 * std::sqrt(1.0 / 3 / kCount));
      EXPECT_NEAR(square[k], 1.0 / 3, 4 * std::sqrt(4.0 / 45 / kCount));
    }
  }
}

}  // namespace
}  // namespace scree
