// Where bodies are at first, for checks that need examples only.
#pragma once

#include <vector>

#include "decomposer/packing/scene_parts.hpp"

namespace scree {

/// Centres of at most some fifty moving bodies, spread over all of them, and of the boxes of all inlets [m].
std::vector<Vec3> start_points(const SceneParts& parts, const Scene& scene);

}  // namespace scree
