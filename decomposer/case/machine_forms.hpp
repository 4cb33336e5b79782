// Turning parts of machines from a few numbers, as triangle meshes: screws, and shafts with paddles.
//
// Bodies meet them from outside, so that their triangles face outwards; they hold nothing (WallForm::inside is empty).
#pragma once

#include <numbers>

#include "core/geometry/blades.hpp"
#include "decomposer/case/wall_forms.hpp"

namespace scree {

/// A screw from start to end. At the middle of the shaft a flight points as across(axis).first.
WallForm screw_form(const Vec3& start, const Vec3& end, const Screw& screw, int segments);

/// Flat blades on a shaft, spread evenly along it. Each begins at the axis, within the shaft, and is a body of its own: the meshes of
/// blades and shaft pass through each other.
struct Paddles {
  double shaft = 0, radius = 0;            ///< of the shaft, and of the circle that the outer corners of the blades reach [m]
  int count = 0;                           ///< blades
  double width = 0, thickness = 0;         ///< of a blade [m]
  double angle = 0.25 * std::numbers::pi;  ///< of a blade's width to the axis [rad]; above 0 as the flight of a right-handed screw
  double turn = 0.5 * std::numbers::pi;    ///< about the axis from a blade to the next [rad]; the first points as across(axis).first
};
/// How far a blade reaches to either side of its middle, across shaft and blade [m].
double reach_across(const Paddles& paddles);
/// Needs reach_across() < radius.
WallForm paddles_form(const Vec3& start, const Vec3& end, const Paddles& paddles, int segments);

}  // namespace scree
