#include "solver/laws/restitution.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace scree {

double restitution_of_damping_ratio(double zeta) {
  if (zeta <= 0) return 1;
  if (zeta < 1) {
    const double s = std::sqrt(1 - zeta * zeta);
    return std::exp(-zeta / s * (std::numbers::pi - std::atan2(2 * zeta * s, 1 - 2 * zeta * zeta)));
  }
  // The limit of both branches; within 1e-6 of zeta = 1 they lose digits to s -> 0.
  if (zeta - 1 < 1e-6) return std::exp(-2.0);
  const double s = std::sqrt(zeta * zeta - 1);
  return std::exp(-zeta / s * std::log((zeta + s) / (zeta - s)));
}

double damping_ratio_of_restitution(double restitution) {
  if (restitution >= 1) return 0;
  restitution = std::max(restitution, kMinRestitution);
  double low = 0, high = 1;
  while (restitution_of_damping_ratio(high) > restitution) high *= 2;
  // 200 halvings reach the last bit from any start: the map is monotone.
  for (int i = 0; i < 200 && low < high; ++i) {
    const double middle = 0.5 * (low + high);
    if (middle == low || middle == high) break;
    (restitution_of_damping_ratio(middle) > restitution ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

double hunt_crossley_number_of_restitution(double restitution) {
  const double e = std::max(restitution, kMinRestitution);
  if (e >= 1) return 0;
  // alpha (1 + e) exceeds the logarithm by alpha^2 (1 - e^2) / 2 for small alpha, and the logarithm grows without bound
  // towards 1/e: one root in between.
  double low = 0, high = 1 / e;
  for (int i = 0; i < 200; ++i) {
    const double middle = 0.5 * (low + high);
    if (middle == low || middle == high) break;
    (middle * (1 + e) > std::log1p(middle) - std::log1p(-middle * e) ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

}  // namespace scree
