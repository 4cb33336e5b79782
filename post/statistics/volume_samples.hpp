// Points that stand for the volume of a shape, so that the solid in any part of space can be counted.
#pragma once

#include <vector>

#include "core/storage/shape_file.hpp"

namespace scree {

/// Points spread evenly through a shape of scale 1, in its own axes; each stands for the same share of its volume.
///
/// How: a grid of cubes over the box of the shape, a random point in each (stratified sampling), those inside kept. A grid alone
/// would miss or double walls that are thinner than its spacing and line up with it.
/// in   count   about how many (at least 1); the number differs by some per cent, and is smaller where a shape fills less than
///              1/500 of its box
/// Cost: O(count / share of its box that the shape fills), each point against the triangles at its x; once per shape.
/// Limits: of a mesh that is not closed, what has an odd number of crossings below it.
std::vector<Vec3> volume_samples(const Shape& shape, std::size_t count);

}  // namespace scree
