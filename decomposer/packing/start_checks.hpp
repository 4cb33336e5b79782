// What the solver would refuse before its first step, refused before anything is placed: a scene that is written is a scene that starts.
#pragma once

#include "decomposer/packing/scene_parts.hpp"

namespace scree {

/// in   scene   with its margin and impact speed, without bodies
/// out  notices   lines about mesh walls that end near a seam
/// Fails: UsageError for a periodic axis that is too short, a wall that changes or moves along one, and laws or walls that need a margin or
/// a speed which the case does not have.
void check_start(const Case& c, const SceneParts& parts, const Scene& scene, std::vector<std::string>& notices);

}  // namespace scree
