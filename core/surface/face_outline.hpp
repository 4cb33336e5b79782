// The outline of a flat face, and triangles between it.
//
// A face of more than three corners whose corners move is sound as long as its outline is, whatever triangles it was drawn with: those of
// a face that is not convex may turn over although nothing is wrong with the face. It then has other triangles, as many.
#pragma once

#include <array>
#include <vector>

#include "core/geometry/triangle_mesh.hpp"

namespace scree {

struct FaceOutline {
  Vec3 normal;                                     ///< unit, as drawn; zero: the face has no area
  double area = 0;                                 ///< as drawn [m^2]
  std::vector<std::int32_t> triangles, vertices;   ///< all of the face, ascending
  std::vector<std::array<std::int32_t, 2>> sides;  ///< places in `vertices`, the face to their left: sides of one triangle of the face
  std::vector<std::array<std::int32_t, 2>> edges;  ///< the same from corner to corner
};

/// Whether the outline, with its vertices at `places`, meets itself nowhere and holds more than `least_area` [m^2].
/// Cost: O(E log E) for E edges that do not cluster.
bool is_sound(const FaceOutline& outline, const std::vector<Vec3>& places, double least_area);

/// Triangles between the outline, as many as the face was drawn with: those of Delaunay, as far as the outline lets them.
///
/// How: a front goes in from the outline. At each of its edges lies the triangle whose third corner sees the edge under the widest angle.
/// in   outline   of consistent winding, is_sound
/// in   places    of its vertices; out: those inside that did not lie well inside are moved to the middle of a large triangle
/// Returns none where triangles would be too thin, or the outline is not one.   Cost: vertices times triangles.
/// Source: J. R. Shewchuk, Lecture notes on Delaunay mesh generation, Berkeley 1999, section 3.2 (gift-wrapping).
std::vector<Triangle> triangles_between(const FaceOutline& outline, std::vector<Vec3>& places);

}  // namespace scree
