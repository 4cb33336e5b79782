// Sizes of particles: equivalent-sphere diameters drawn by inverting the distribution function.
#pragma once

#include <vector>

#include "core/base/words.hpp"

namespace scree {

/// A distribution of diameters, truncated to [min, max], by number or by mass.
struct SizeDistribution {
  enum class Kind { fixed, uniform, normal, lognormal, weibull, power, sieve };
  Kind kind = Kind::fixed;
  double first = 0;                        ///< fixed: diameter; normal: mean; lognormal: median; weibull: scale [m]; power: exponent [-]
  double second = 0;                       ///< normal: sigma [m]; lognormal: sigma of ln d [-]; weibull: shape [-]
  double min = 0, max = 0;                 ///< [m]; equal for `fixed`
  bool by_mass = false;                    ///< shares are of the mass, not of the number; always so for `sieve`
  std::vector<double> sieve{}, passing{};  ///< sieve: diameters [m] and the share of the mass that is finer, 0 to 1, straight in log d

  /// Share of the number (of the mass when by_mass) that is finer than a diameter, 0 to 1.
  double share(double diameter) const;
  /// Diameter [m] at which that share is u.
  double quantile(double u) const;
};

template <>
inline constexpr auto kWordsOf<SizeDistribution::Kind> =
    std::to_array<Word<SizeDistribution::Kind>>({{SizeDistribution::Kind::fixed, "fixed"},
                                                 {SizeDistribution::Kind::uniform, "uniform"},
                                                 {SizeDistribution::Kind::normal, "normal"},
                                                 {SizeDistribution::Kind::lognormal, "lognormal"},
                                                 {SizeDistribution::Kind::weibull, "weibull"},
                                                 {SizeDistribution::Kind::power, "power"},
                                                 {SizeDistribution::Kind::sieve, "sieve"}});

/// What shares are shares of.
enum class ShareOf { number, mass };
template <>
inline constexpr auto kWordsOf<ShareOf> = std::to_array<Word<ShareOf>>({{ShareOf::number, "number"}, {ShareOf::mass, "mass"}});

/// Draws diameters: one random number gives one size, none is rejected.
class SizeSampler {
 public:
  explicit SizeSampler(const SizeDistribution& distribution);
  /// Diameter [m] at which the share by number is u, 0 <= u < 1, also when the distribution is by mass.
  double diameter(double u) const;

 private:
  SizeDistribution distribution_;
  std::vector<double> edge_, number_;  // by mass: steps of the diameter, and the share by number below each
};

/// How well a sample follows what was asked, in the measure in which it was asked.
struct SizeComparison {
  double kolmogorov_smirnov = 0;                    ///< largest difference of the two distribution functions
  double largest_share = 0;                         ///< of one body: no sample can be closer than half of it
  double asked[3] = {0, 0, 0}, got[3] = {0, 0, 0};  ///< diameters at 10, 50 and 90 % [m]
};
/// in   diameters   of all bodies [m], in any order, at least one
SizeComparison compare_sizes(const SizeDistribution& asked, std::vector<double> diameters);

/// Share of a sorted sample that is finer than or as fine as each of its diameters, by number or by mass.
std::vector<double> shares_of(const std::vector<double>& sorted, bool by_mass);

}  // namespace scree
