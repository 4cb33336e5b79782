// Points that stand for the volume of a shape, so that the solid in any part of space can be counted.
#pragma once

#include <vector>

#include "core/storage/shape_file.hpp"

namespace scree {

/// Points spread evenly through a shape of scale 1, in its own axes; each stands for the same share of its volume.
///
/// How: columns along z at the points of an even sequence of the plane (Roberts 2018), so that no wall of the shape lines up with
/// them; one point for each equal share of the length that lies in the shape, at a height in its column from an even sequence.
/// in   count   how many; 1 where the shape has no volume
/// Cost: O(columns log columns + columns below triangles), once per shape; 8 columns a point, 4096 at least.   Limits: a mesh that is not
/// closed gives what lies between pairs of hits.
std::vector<Vec3> volume_samples(const Shape& shape, std::size_t count);

}  // namespace scree
