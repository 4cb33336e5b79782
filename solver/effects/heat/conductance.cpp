#include "solver/effects/heat/conductance.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace scree {

namespace {

/// A wall without conductivity does not resist.
double conductivity_of(const Material& a, const Material& b) {
  if (!(b.conductivity > 0)) return 2 * a.conductivity;
  if (!(a.conductivity > 0)) return 2 * b.conductivity;
  return 2 * a.conductivity * b.conductivity / (a.conductivity + b.conductivity);
}

double real_modulus_of(const Material& a, const Material& b) {
  if (!(a.real_young > 0) || !(b.real_young > 0)) return 0;
  return 1 / ((1 - a.poisson * a.poisson) / a.real_young + (1 - b.poisson * b.poisson) / b.real_young);
}

double area_of(const AreaContact& layer) {
  double area = 0;
  for (const AreaPoint& point : layer.points) area += point.area;
  return area;
}

}  // namespace

ContactConductance::ContactConductance(const Scene& scene)
    : scene_(scene), materials_(scene.materials.size()), of_pair_(materials_ * materials_) {
  for (const MaterialPair& pair : scene.pairs) {
    const auto a = static_cast<std::size_t>(pair.a), b = static_cast<std::size_t>(pair.b);
    const Material &of_a = scene.materials[a], &of_b = scene.materials[b];
    const Materials both{conductivity_of(of_a, of_b), real_modulus_of(of_a, of_b),
                         pair.contact_conductance > 0 ? 1 / pair.contact_conductance : 0};
    of_pair_[a * materials_ + b] = of_pair_[b * materials_ + a] = both;
  }
}

double ContactConductance::of(const PairContact& c, const ParticleSet& p) const {
  const auto a = static_cast<std::size_t>(c.pair.a);
  double resistance = 0, smaller = p.equivalent_radius[a];
  std::size_t material_b = 0;
  if (c.view.zone == nullptr) {
    const auto b = static_cast<std::size_t>(c.pair.b);
    material_b = static_cast<std::size_t>(p.material[b]);
    smaller = std::min(smaller, p.equivalent_radius[b]);
  } else {
    const Wall& wall = scene_.walls[static_cast<std::size_t>(c.view.zone->wall)];
    if (wall.heat.kind == WallHeatKind::adiabatic) return 0;
    if (wall.heat.kind == WallHeatKind::exchange) resistance = 1 / wall.heat.coefficient;
    material_b = static_cast<std::size_t>(wall.material);
  }
  const Materials& both = of_pair(static_cast<std::size_t>(p.material[a]), material_b);
  double radius = 0;
  if (c.features.has_layer) {
    radius = std::sqrt(area_of(c.features.layer) / std::numbers::pi);
  } else {
    const double effective = c.law.radius > 0 ? c.law.radius : contact_radius(c.view);
    radius = both.real_modulus > 0 ? std::cbrt(0.75 * length(c.force.push) * effective / both.real_modulus)
                                   : std::sqrt(effective * std::max(0.0, c.force.largest_overlap));
  }
  radius = std::min(radius, smaller);
  if (!(radius > 0)) return 0;
  resistance += both.resistance;
  // 2 k a in series with pi a^2 / resistance
  return 2 * both.conductivity * radius / (1 + 2 * both.conductivity * resistance / (std::numbers::pi * radius));
}

}  // namespace scree
