#include "decomposer/size_distribution.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace scree {

namespace {

double normal_cdf(double z) { return 0.5 * std::erfc(-z / std::numbers::sqrt2); }

/// Distribution function before truncation, for the kinds that are inverted by search.
double cdf(const SizeDistribution& d, double x) {
  switch (d.kind) {
    case SizeDistribution::Kind::normal: return normal_cdf((x - d.first) / d.second);
    case SizeDistribution::Kind::lognormal: return normal_cdf(std::log(x / d.first) / d.second);
    case SizeDistribution::Kind::weibull: return -std::expm1(-std::pow(x / d.first, d.second));
    default: return 0;
  }
}

}  // namespace

double SizeDistribution::quantile(double u) const {
  switch (kind) {
    case Kind::fixed: return first;
    case Kind::uniform: return min + u * (max - min);
    case Kind::power: {
      // number density proportional to d^-a; a = 1 is the logarithm
      const double a = 1 - first;
      if (std::abs(a) < 1e-9) return min * std::pow(max / min, u);
      return min * std::pow(1 + u * (std::pow(max / min, a) - 1), 1 / a);
    }
    default: break;
  }
  // bisection on the distribution function: monotone, no special cases in the tails, and sizes are drawn once
  const double low_share = cdf(*this, min), high_share = cdf(*this, max);
  const double wanted = low_share + u * (high_share - low_share);
  double low = min, high = max;
  while (true) {
    const double middle = 0.5 * (low + high);
    if (!(middle > low && middle < high)) return std::clamp(middle, min, max);
    (cdf(*this, middle) < wanted ? low : high) = middle;
  }
}

}  // namespace scree
