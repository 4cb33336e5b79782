// What the decomposer makes of the inlets of a case, and what it refuses.
#pragma once

#include <string>
#include <vector>

#include "decomposer/packing/scene_parts.hpp"

namespace scree {

/// An inlet as the solver takes it. Shares of the mass become shares of the number.
Inlet make_inlet(const CaseInlet& asked, const SceneParts& parts, const RegionShape& region);

/// Tries places for the largest body of each shape, with the walls as they stand at the start, and looks where they are.
/// out  notices   an inlet that will find its region full sooner or later
/// Fails: InputError where a body is larger than the region or no place is free of the walls, UsageError where an outlet would take bodies
/// out as they come in.   Needs the margin.
void check_inlets(const Case& c, const SceneParts& parts, const Scene& scene, std::vector<std::string>& notices);

}  // namespace scree
