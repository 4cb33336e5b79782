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

GapConductance::GapConductance(const Scene& scene)
    : scene_(scene), conductivity_(scene.settings.heat->gas_conductivity), range_(scene.settings.heat->gas_range) {
  constexpr double kAtTouch = 3.9;
  offset_.assign(scene.materials.size() * scene.materials.size(), 0.0);
  for (std::size_t a = 0; a < scene.materials.size(); ++a) {
    for (std::size_t b = 0; b < scene.materials.size(); ++b) {
      const double alpha = conductivity_of(scene.materials[a], scene.materials[b]) / conductivity_;
      offset_[a * scene.materials.size() + b] = 1 / (alpha * alpha * std::exp(-kAtTouch) - 1);
    }
  }
}

double GapConductance::of(const PairView& view, double gap, std::int32_t material_a, std::int32_t material_b, double radius_a,
                          double radius_b) const {
  if (!(gap < range_)) return 0;
  double smaller = radius_a, outside = 0;
  if (view.zone == nullptr) {
    smaller = std::min(smaller, radius_b);
  } else {
    const Wall& wall = scene_.walls[static_cast<std::size_t>(view.zone->wall)];
    if (wall.heat.kind == WallHeatKind::adiabatic) return 0;
    if (wall.heat.kind == WallHeatKind::exchange) outside = 1 / (wall.heat.coefficient * std::numbers::pi * smaller * smaller);
  }
  const double effective = contact_radius(view), area = smaller * smaller;
  const double offset = offset_[static_cast<std::size_t>(material_a) * scene_.materials.size() + static_cast<std::size_t>(material_b)];
  const double h =
      2 * std::numbers::pi * conductivity_ * effective * std::log1p(area / (2 * effective * std::max(0.0, gap) + area * offset));
  return h / (1 + outside * h);
}

}  // namespace scree
