#include "core/storage/domain_side.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/base/units.hpp"

namespace scree {

std::string beyond_side(const Domain& domain, const Vec3& point, bool of_periodic) {
  double most = 0;
  std::string text;
  for (int k = 0; domain.bounded && k < 3; ++k) {
    if (domain.periodic[static_cast<std::size_t>(k)] && !of_periodic) continue;
    const double below = domain.lower[k] - point[k], above = point[k] - domain.upper[k], by = std::max(below, above);
    if (!(by > most)) continue;
    most = by;
    text = fmt::format("{} beyond domain.{} {}", format_quantity(by, Dimension::length), below > above ? "min" : "max", "xyz"[k]);
  }
  return text;
}

}  // namespace scree
