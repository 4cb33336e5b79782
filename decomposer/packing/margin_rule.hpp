// The margin of a case that gives none, and a warning for one that gives too little.
#pragma once

#include "decomposer/packing/packing_report.hpp"
#include "decomposer/packing/scene_parts.hpp"

namespace scree {

/// Volume over area of a shape, over the radius of the ball of its volume: of a plate half of its thickness. With wider margins most of the
/// shape cannot be moved in by one, and touches outside of its drawn surface.
double half_thickness(const Shape& shape);
/// So much of that is a margin that leaves a body to the shape.
inline constexpr double kThinShare = 0.8;

/// Margin from size, speed and stiffness: the depth v sqrt(m/k) of the worst impact may use up kOverlapShare of the margin
/// sum. Source: design rule of docs/reference/validation-plan.md section 2, k >= m (v / (f e))^2. Sets scene.settings.margin where the case
/// leaves it open, and the impact estimates and notices of the report.
/// Throws UsageError when no sensible margin exists, with the stiffness that would help.
void choose_margin(const Case& c, const SceneParts& parts, Scene& scene, PackingReport& report);

}  // namespace scree
