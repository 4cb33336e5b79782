// The bed: where the solid lies in its container, with its own surface, however that is inclined.
#pragma once

#include <vector>

#include "post/statistics/frame_view.hpp"

namespace scree {

/// How much of a bed is solid, and of what.
struct BedSolid {
  double fraction = 0;  ///< of the inner part of the bed; NaN without particles
  double of_container =
      0;  ///< of the container from the lowest to the highest point of the particles; of a cell periodic there, of it all; NaN without
};

/// Solid fraction of the inner part of the bed by its own surface: column by column over the plan, 80 % of a column's solid over the
/// container between the heights below which 10 % and 90 % of it lie. Neither the floor's layer nor the free surface enters much, and
/// a bed that lies in one half of a drum is not thinned by the other half.
///
/// How: columns are two mean diameters wide, so that each holds layers of several particles across. Columns that hold less than half
/// of what the middle column by solid holds per area are the rim of a heap, or grains that lie about, and are left out.
/// Solid by the sample points; the container by its exact shape (Container::volume_in).
BedSolid bed_solid(const FrameView& view);

}  // namespace scree
