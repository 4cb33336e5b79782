// What acts on bodies asleep: their contacts, their weight and forces that are given.
#pragma once

#include <cstddef>
#include <vector>

#include "core/geometry/vec3.hpp"

namespace scree {

struct RunState;

struct BodyLoad {
  Vec3 force, torque;  ///< world [N], about the centre [N m]
};

/// By the present results of the pairs, summed as those of bodies that are awake: the same bits on any number of ranks and threads.
/// in   rows   of owned bodies, ascending
std::vector<BodyLoad> loads_on(RunState& s, const std::vector<std::size_t>& rows);

}  // namespace scree
