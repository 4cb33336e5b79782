// The margin of a case that gives none, and a warning for one that gives too little.
#pragma once

#include "decomposer/packing/packing_report.hpp"
#include "decomposer/packing/scene_parts.hpp"

namespace scree {

/// Margin from size, speed and stiffness: the depth v sqrt(m/k) of the worst impact may use up kOverlapShare of the margin
/// sum. Source: design rule of docs/reference/validation-plan.md section 2, k >= m (v / (f e))^2. Sets scene.settings.margin where the case
/// leaves it open, and the impact estimates and notices of the report.
/// Throws UsageError when no sensible margin exists, with the stiffness that would help.
void choose_margin(const Case& c, const SceneParts& parts, Scene& scene, PackingReport& report);

}  // namespace scree
