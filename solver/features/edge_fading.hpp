// Where the feature of two edges fades: at the ends of an edge, where two edges are parallel, across the wedge between the faces of an
// edge. Source: docs/reference/contact-law.md sections 3.1 and 3.2.
#pragma once

#include "core/geometry/vec3.hpp"

namespace scree {

/// Fading widths: at the ends of an edge, in the parallel limit and across the wedge. Results change by less than a factor 2 in error for
/// end widths from 0.03 to 0.5.
inline constexpr double kFadeEnd = 0.15;
inline constexpr double kFadeParallel = 0.01;
inline constexpr double kFadeWedge = 0.2;
/// Squared sine below which the fade S(sine2 / kFadeParallel) is under 1e-11 of a contact: nothing is lost by leaving it out.
inline constexpr double kParallelCutoff = 1e-8;
/// A weight this small adds less than rounding to the eighth-power sum.
inline constexpr double kWeightCutoff = 1e-12;

/// Cosine between the conormals of an edge of a wall below which its fold is so shallow that a normal from the concave side leans over
/// neither face by kFadeWedge: the sum of its leans tells the sides apart there. Where the fold is steeper one of the leans is larger. From
/// one side to the other a normal passes the plane across the fold, where it leans over a face by more than 0.97: the weight is 0 long
/// before.
inline constexpr double kShallowFold = -(1 - 2 * kFadeWedge * kFadeWedge);

/// Whether a direction that leans so little over both faces of an edge looks at it from its concave side.
/// in   away  from the edge; any frame of the conormals
inline bool is_in_fold(const Vec3& conormal_0, const Vec3& conormal_1, const Vec3& away) {
  return dot(conormal_0, conormal_1) < kShallowFold && dot(away, conormal_0) + dot(away, conormal_1) > 0;
}

}  // namespace scree
