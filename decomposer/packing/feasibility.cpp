#include "decomposer/packing/feasibility.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/error.hpp"
#include "core/base/units.hpp"

namespace scree {

namespace {

/// Whether a box lies wholly where the particles of an analytic wall cannot be.
bool is_behind(const Wall& wall, const Box3& box) {
  double nearest2 = 0;  // squared distance from a point or axis to the box, when that can be told simply
  switch (wall.kind) {
    case WallKind::plane: {
      const Vec3 far{wall.normal.x > 0 ? box.upper.x : box.lower.x, wall.normal.y > 0 ? box.upper.y : box.lower.y,
                     wall.normal.z > 0 ? box.upper.z : box.lower.z};
      return dot(wall.normal, far - wall.point) <= 0;
    }
    case WallKind::box_inside:
      for (int k = 0; k < 3; ++k) {
        if (box.upper[k] <= wall.lower[k] || box.lower[k] >= wall.upper[k]) return true;
      }
      return false;
    case WallKind::sphere_inside: {
      const Vec3 nearest = component_min(component_max(wall.point, box.lower), box.upper);
      nearest2 = squared_length(nearest - wall.point);
      return nearest2 >= wall.radius * wall.radius;
    }
    case WallKind::cylinder_inside: {
      // by the ball about the box: refuses only what is certainly outside
      const Vec3 axis = normalised(wall.axis_end - wall.axis_start), d = box.centre() - wall.axis_start;
      const double along = dot(axis, d), ball = 0.5 * length(box.extent());
      return along <= -ball || along >= length(wall.axis_end - wall.axis_start) + ball || length(d - along * axis) >= wall.radius + ball;
    }
    case WallKind::mesh:
      return false;
  }
  return false;
}

}  // namespace

void check_feasible(const Case& c, const SceneParts& parts, const Scene& scene) {
  const Domain& domain = c.settings.domain;
  for (std::size_t k = 0; k < c.populations.size(); ++k) {
    const CasePopulation& p = c.populations[k];
    const Region& region = parts.regions[k];
    for (int axis = 0; domain.bounded && axis < 3; ++axis) {
      if (region.box.upper[axis] <= domain.lower[axis] || region.box.lower[axis] >= domain.upper[axis]) {
        throw InputError("{}: the region lies outside the domain along {}", p.where, "xyz"[axis]);
      }
    }
    for (std::size_t w = 0; w < scene.walls.size(); ++w) {
      if (is_behind(parts.walls[w], region.box)) {
        throw InputError("{}: the region lies outside {} (wall '{}'); move one of them", p.where, c.walls[w].where, scene.walls[w].name);
      }
    }
    double volume = 0, smallest = 1e300, largest = 0;
    bool spheres = true;
    const Vec3 e = region.box.extent();
    for (const Draw& d : parts.draws) {
      if (d.population != k) continue;
      const PackShape& shape = parts.shape(d.shape);
      volume += d.volume;
      const double diameter = d.scale * shape.shape.equivalent_diameter();
      smallest = std::min(smallest, diameter);
      largest = std::max(largest, diameter);
      spheres = spheres && shape.shape.kind == ShapeKind::sphere;
      const double ball = 2 * d.scale * shape.inner_radius;
      for (int axis = 0; axis < 3; ++axis) {
        const bool around = domain.periodic[static_cast<std::size_t>(axis)] && region.is_box();
        if (around || ball <= e[axis]) continue;
        throw InputError("{}: '{}' of diameter {} is larger than the region, {} along {}; enlarge the region, or make the bodies smaller",
                         p.where, c.shapes[static_cast<std::size_t>(d.shape)].name, format_quantity(diameter, Dimension::length),
                         format_quantity(e[axis], Dimension::length), "xyz"[axis]);
      }
    }
    const double fraction = p.amount == CasePopulation::Amount::fill ? 0 : volume / region.volume;
    // Random sequential addition stops near 0.38 for balls and near 0.42 for cubes side by side; only small bodies in the holes of
    // large ones go far beyond.
    constexpr double kRandomLimit = 0.5, kAlike = 2;
    if (p.method == PackingMethod::random && fraction > kRandomLimit && largest < kAlike * smallest) {
      throw InputError(
          "{}: a solid fraction of {:.3f} cannot be reached by random placement, which ends near 0.38 for bodies of similar size; use "
          "method = \"settle\" or \"compact\", or request less",
          p.where, fraction);
    }
    // the densest packing of equal balls (T. Hales 2005)
    const double kepler = std::numbers::pi / std::sqrt(18.0);
    if (spheres && fraction > kepler && largest < 1.0001 * smallest) {
      throw InputError("{}: a solid fraction of {:.4f} is more than equal balls can have at all, {:.4f}", p.where, fraction, kepler);
    }
  }
}

}  // namespace scree
