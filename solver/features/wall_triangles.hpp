// Which triangles of a wall's mesh a contact lies on.
#pragma once

#include <cstdint>
#include <vector>

#include "solver/features/pair_view.hpp"

namespace scree {

/// Triangles whose distance from a point differs by less than this share of the margin sum hold it alike: far above the rounding of a
/// place on a wall, far below any triangle that carries a contact. A larger value would spread loads over neighbours.
inline constexpr double kSameTriangleDistance = 1e-6;

/// The triangles of B's mesh that hold the contact of a feature: the nearest to its place on B's surface, in ascending order; several for
/// one on an edge or at a vertex between them, each of which bears an equal share. It follows from the pose alone, whatever lists there
/// are.
///
/// How: the pair's own candidates where the body is an analytic ball, else a descent of B's tree about the place.
/// in   view   body against a mesh wall: B is the wall     in  feature  one of the pair, frame of A
/// Fails: gives none where the place is not a number.   Threads: safe, with scratch of their own.
void triangles_of(const PairView& view, const CandidateLists& lists, const ContactFeature& feature, MeshDistanceScratch& scratch,
                  std::vector<std::int32_t>& triangles);

}  // namespace scree
