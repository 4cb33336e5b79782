// Sizes of particles: equivalent-sphere diameters drawn by inverting the distribution function.
#pragma once

#include <string>

namespace scree {

/// A distribution of diameters, truncated to [min, max]: one random number gives one size, none is rejected.
struct SizeDistribution {
  enum class Kind { fixed, uniform, normal, lognormal, weibull, power };
  Kind kind = Kind::fixed;
  double first = 0;        ///< fixed: diameter; normal: mean; lognormal: median; weibull: scale [m]; power: exponent [-]
  double second = 0;       ///< normal: sigma [m]; lognormal: sigma of ln d [-]; weibull: shape [-]
  double min = 0, max = 0; ///< [m]; equal for `fixed`

  /// Diameter [m] at which the truncated distribution function by number is u, 0 <= u < 1.
  double quantile(double u) const;
};

}  // namespace scree
