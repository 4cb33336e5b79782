// What is allowed in a case and is mostly a slip: a unit, a forgotten key, a run that ends before anything happens. Each doubt is one
// line with numbers, for stderr; none of them changes a result.
#pragma once

#include <string>
#include <vector>

#include "decomposer/packing/packing_report.hpp"
#include "decomposer/packing/scene_parts.hpp"

namespace scree {

/// What the case alone shows.
std::vector<std::string> warnings_of_case(const Case& c);

/// What shows when bodies, walls and margin are known.
/// in   scene   packed     in   report   of its packing so far
std::vector<std::string> warnings_of_case(const Case& c, const SceneParts& parts, const Scene& scene, const PackingReport& report);

}  // namespace scree
