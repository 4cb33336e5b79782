// How a body is turned where it is placed.
#pragma once

#include "core/placing/random_numbers.hpp"
#include "core/storage/body_orientation.hpp"
#include "core/storage/shape_file.hpp"

namespace scree {

/// Random uniform over all orientations, the one given, or aligned: an axis of the body along a direction, tilted about a random
/// axis across it by an angle whose two components are normal with the deviation `scatter`, and turned about itself at random.
/// Uses the random numbers which ... which + 2.
Quat draw_orientation(const BodyOrientation& asked, const Shape& shape, const RandomNumbers& random, std::uint64_t which);

}  // namespace scree
