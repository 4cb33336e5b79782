// What no packing can do, found out before any body is placed.
#pragma once

#include "decomposer/case/case_file.hpp"
#include "decomposer/packing/scene_parts.hpp"

namespace scree {

/// Throws InputError for a population whose region lies outside the domain or behind a wall, which has a body that its region cannot
/// hold in any orientation, or whose solid fraction its method cannot reach; says what can be done.
void check_feasible(const Case& c, const SceneParts& parts, const Scene& scene);

}  // namespace scree
