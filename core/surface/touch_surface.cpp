#include "core/surface/touch_surface.hpp"

#include "core/surface/inset.hpp"

namespace scree {

double own_margin(const Shape& shape, const Settings& settings) {
  if (settings.surface == TouchAt::outside || shape.kind != ShapeKind::solid) return 0;
  return settings.margin_ratio * 0.5 * shape.equivalent_diameter();
}

TouchSurface touch_surface(const Shape& shape, const Settings& settings) {
  const double margin = own_margin(shape, settings);
  if (!(margin > 0)) return {shape.mesh, 0};
  return {inset(shape.mesh, margin).mesh, margin};
}

}  // namespace scree
