// The periodic cell that a run has reached, where bodies of another case begin in it ([start]).
#pragma once

#include <optional>

#include "core/geometry/triangle_mesh.hpp"
#include "core/storage/frame_file.hpp"
#include "core/storage/h5.hpp"
#include "decomposer/case/case.hpp"

namespace scree {

struct CellOfRun {
  Box3 box;    ///< that its bodies lie in [m]
  Vec3 shear;  ///< h_yz, h_xz, h_xy [m]
};

// At the time of a frame, or of a checkpoint of the run of `scene`; none where the domain of the run stays as it is.
// in   c   that begins there. Throws UsageError where it has no [cell]: the bodies fit into no other domain; and where it
//          adds bodies to a cell that is sheared.
std::optional<CellOfRun> cell_of(const Frame& frame, const Case& c);
std::optional<CellOfRun> cell_of(const h5::Group& checkpoint, const Scene& scene, const Case& c);

}  // namespace scree
