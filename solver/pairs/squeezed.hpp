// A body that is pressed too deep because a wall that moves leaves it no room: no stiffness holds against that.
#pragma once

#include <cstdint>
#include <string>

#include "solver/pairs/pair_pass.hpp"

namespace scree {

/// What a user is told of a pair that touches too deep, or intersects, where its bodies lie between two walls of which one moves: both
/// walls, the room that they leave there, and what can be done. Empty where they do not.
/// in   k   index of the pair
std::string squeezed_between_walls(const PairPass& pass, std::int32_t k);

}  // namespace scree
