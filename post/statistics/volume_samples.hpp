// Points that stand for the volume of a shape, so that the solid in any part of space can be counted.
#pragma once

#include <vector>

#include "core/storage/shape_file.hpp"

namespace scree {

/// Points spread evenly through a shape of scale 1, in its own axes; each stands for the same share of its volume.
///
/// How: columns along z on a square grid, shifted from one to the next by the golden ratio so that no layer of points lines up
/// with a plane; in each column points at equal distance between where it enters and leaves the shape.
/// in   count   about how many (at least 1); what comes differs by some per cent
/// Cost: O(columns x triangles), once per shape.   Limits: a mesh that is not closed gives what lies between pairs of hits.
std::vector<Vec3> volume_samples(const Shape& shape, std::size_t count);

}  // namespace scree
