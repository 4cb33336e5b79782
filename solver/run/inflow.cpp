#include "solver/run/inflow.hpp"

#include <algorithm>
#include <cmath>

namespace scree {

double mean_mass(const Scene& scene, const Inlet& inlet) {
  double mass = 0, shares = 0;
  for (const Inlet::Share& share : inlet.shares) {
    const Shape& shape = scene.shapes[static_cast<std::size_t>(share.shape)];
    double volume = 1;
    if (inlet.size) {
      constexpr int kSamples = 1000;
      const SizeSampler sizes(*inlet.size);
      volume = 0;
      for (int n = 0; n < kSamples; ++n)
        volume += std::pow(sizes.diameter((n + 0.5) / kSamples) / shape.equivalent_diameter(), 3) / kSamples;
    }
    mass += share.share * volume * scene.mass(share.shape, inlet.material, 1);
    shares += share.share;
  }
  return mass / shares;
}

double inflow_by(const Inlet& inlet, double mean, double time) {
  const double owed = inlet.owed(time), number = inlet.rate.by_number ? owed : owed / mean;
  return std::min({number, inlet.limit / mean, inlet.count >= 0 ? static_cast<double>(inlet.count) : 1e300});
}

}  // namespace scree
