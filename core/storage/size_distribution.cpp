#include "core/storage/size_distribution.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace scree {

namespace {

double normal_cdf(double z) { return 0.5 * std::erfc(-z / std::numbers::sqrt2); }

/// Distribution function before truncation.
double cdf(const SizeDistribution& d, double x) {
  switch (d.kind) {
    case SizeDistribution::Kind::uniform:
      return x;
    case SizeDistribution::Kind::normal:
      return normal_cdf((x - d.first) / d.second);
    case SizeDistribution::Kind::lognormal:
      return normal_cdf(std::log(x / d.first) / d.second);
    case SizeDistribution::Kind::weibull:
      return -std::expm1(-std::pow(x / d.first, d.second));
    case SizeDistribution::Kind::power: {
      // density proportional to d^-a; a = 1 is the logarithm. Relative to min, so that no exponent overflows sooner than it must.
      const double a = 1 - d.first;
      return std::abs(a) < 1e-9 ? std::log(x / d.min) : std::expm1(a * std::log(x / d.min)) / a;
    }
    default:
      return 0;
  }
}

/// Between two neighbouring sieves the share is straight in log d.
double sieve_share(const SizeDistribution& d, double x) {
  const auto above = std::upper_bound(d.sieve.begin(), d.sieve.end(), x);
  if (above == d.sieve.begin()) return 0;
  if (above == d.sieve.end()) return 1;
  const auto i = static_cast<std::size_t>(above - d.sieve.begin());
  const double t = std::log(x / d.sieve[i - 1]) / std::log(d.sieve[i] / d.sieve[i - 1]);
  return d.passing[i - 1] + t * (d.passing[i] - d.passing[i - 1]);
}

}  // namespace

double SizeDistribution::share(double diameter) const {
  if (diameter <= min) return kind == Kind::fixed && diameter == min ? 1 : 0;
  if (diameter >= max) return 1;
  if (kind == Kind::sieve) return sieve_share(*this, diameter);
  const double low = cdf(*this, min), high = cdf(*this, max);
  return (cdf(*this, diameter) - low) / (high - low);
}

double SizeDistribution::quantile(double u) const {
  if (!(min < max)) return max;
  if (kind == Kind::uniform) return min + u * (max - min);
  // bisection on the distribution function: monotone, no special cases in the tails, and sizes are drawn once
  double low = min, high = max;
  while (true) {
    const double middle = 0.5 * (low + high);
    if (!(middle > low && middle < high)) return std::clamp(middle, min, max);
    (share(middle) < u ? low : high) = middle;
  }
}

SizeSampler::SizeSampler(const SizeDistribution& distribution) : distribution_(distribution) {
  if (!distribution.by_mass || !(distribution.min < distribution.max)) return;
  // Steps in which the mass is straight in log d: the sieves themselves, or so many that nothing can tell the difference.
  constexpr int kSteps = 4096;
  edge_ = distribution.sieve;
  if (edge_.empty()) {
    for (int i = 0; i <= kSteps; ++i) {
      edge_.push_back(i == kSteps ? distribution.max
                                  : distribution.min * std::pow(distribution.max / distribution.min, static_cast<double>(i) / kSteps));
    }
  }
  // Number per mass goes with d^-3, in units of min: the integral of d^-3 dM with dM = w dln d / ln(b / a).
  number_ = {0};
  for (std::size_t i = 1; i < edge_.size(); ++i) {
    const double a = edge_[i - 1] / distribution.min, b = edge_[i] / distribution.min;
    const double mass = distribution.share(edge_[i]) - distribution.share(edge_[i - 1]);
    number_.push_back(number_.back() + mass / (3 * std::log(b / a)) * (1 / (a * a * a) - 1 / (b * b * b)));
  }
  for (double& n : number_) n /= number_.back();
}

double SizeSampler::diameter(double u) const {
  if (edge_.empty()) return distribution_.quantile(u);
  const auto above = std::upper_bound(number_.begin(), number_.end() - 1, u);
  const auto i = std::max<std::size_t>(1, static_cast<std::size_t>(above - number_.begin()));
  const double t = (u - number_[i - 1]) / (number_[i] - number_[i - 1]);
  const double a = std::pow(edge_[i - 1], -3), b = std::pow(edge_[i], -3);
  return std::clamp(std::pow(a + t * (b - a), -1.0 / 3), edge_[i - 1], edge_[i]);
}

std::vector<double> shares_of(const std::vector<double>& sorted, bool by_mass) {
  std::vector<double> shares;
  double sum = 0;
  for (const double d : sorted) shares.push_back(sum += by_mass ? d * d * d : 1);
  for (double& s : shares) s /= sum;
  return shares;
}

SizeComparison compare_sizes(const SizeDistribution& asked, std::vector<double> diameters) {
  std::sort(diameters.begin(), diameters.end());
  const std::vector<double> shares = shares_of(diameters, asked.by_mass);
  SizeComparison result;
  double below = 0;
  for (std::size_t i = 0; i < diameters.size(); ++i) {
    const double wanted = asked.share(diameters[i]);
    result.largest_share = std::max(result.largest_share, shares[i] - below);
    if (asked.min < asked.max) {
      result.kolmogorov_smirnov = std::max({result.kolmogorov_smirnov, std::abs(shares[i] - wanted), std::abs(below - wanted)});
    }
    below = shares[i];
  }
  constexpr double kLevels[3] = {0.1, 0.5, 0.9};
  for (int k = 0; k < 3; ++k) {
    result.asked[k] = asked.quantile(kLevels[k]);
    result.got[k] = diameters[static_cast<std::size_t>(std::lower_bound(shares.begin(), shares.end() - 1, kLevels[k]) - shares.begin())];
  }
  return result;
}

}  // namespace scree
