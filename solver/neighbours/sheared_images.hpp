// Which bodies meet in other images of a periodic cell that is sheared.
#pragma once

#include <cmath>

#include "core/geometry/periodic.hpp"
#include "core/search/multilevel_grid.hpp"

namespace scree {

/// Calls visit(j) for the bodies that one touches in other images across y and z, in half of these: of two that meet one finds the other,
/// once. Images across x alone are those of the grid.
/// in   grid       of all bodies, in the box of the lengths of the cell, periodic along x alone
/// in   x, reach   of the body [m]     in   farthest   largest reach of any body [m], of which two fit into each length
/// Cost: four comparisons for a body away from the sides.   Threads: const, safe.
template <class Visit>
void for_each_across_sheared(const MultilevelGrid& grid, const Periodicity& cell, const Vec3& x, double reach, double farthest,
                             const Visit& visit) {
  const Vec3 upper = cell.lower() + cell.period();
  const double both = reach + farthest;
  const auto in_image = [&](double n_y, double n_z) {
    const Vec3 image = x + cell.shift({0, n_y, n_z});
    if (image.y > upper.y + both || image.y < cell.lower().y - both || image.z > upper.z + both) return;
    grid.for_each_touching(image, reach, visit);
  };
  in_image(1, 0);
  if (!cell.is_periodic(2)) return;
  // the shear yz is of any number of periods; back in the box, or up to half a period beyond it, are these three
  const double back = -std::round(cell.shear().x / cell.period().y);
  for (const double n_y : {back - 1, back, back + 1}) in_image(n_y, 1);
}

}  // namespace scree
