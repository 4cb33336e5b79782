// Walls of triangles at the seams of a periodic domain. They are not repeated along a periodic axis, so that a body meets one only
// where it stands. Decomposer and solver refuse the same walls.
#pragma once

#include <string>
#include <vector>

#include "core/storage/scene_file.hpp"

namespace scree {

/// Whether every mesh wall is met as a repeated one would be, all the time: it stays out of a body's reach of the seam, or goes on
/// beyond both ends of the cell by that reach. It may move along the axis as long as that holds, and turn about the axis.
///
/// How: by the range along the axis that its vertices take up while it moves; of a wall that turns about another axis, that of full turns.
/// in   reach   of a body: bounding radius of the largest and two margins [m]
/// Returns a line with numbers for each wall that stands still and leaves a gap at a seam.
/// Fails: UsageError naming wall and axis for one that moves along a periodic axis and breaks the rule, and for one that goes on
/// beyond one end of the cell only: what lies there is not met from the other side.
std::vector<std::string> check_meshes_at_seams(const std::vector<Wall>& walls, const std::vector<Shape>& shapes, const Domain& domain,
                                               double reach, double duration);

}  // namespace scree
