// Rims of the faces between cells, joined to loops and filled with triangles; and what a bond needs to know of a face.
#pragma once

#include <map>
#include <span>
#include <utility>
#include <vector>

#include "core/storage/piece_table.hpp"
#include "mesher/fracture/cut_cells.hpp"

namespace scree {

/// Directed edges of the faces between cells i < j, in no order; counter-clockwise around the face, seen from j.
using FaceRims = std::map<std::pair<std::int32_t, std::int32_t>, std::vector<std::pair<std::int32_t, std::int32_t>>>;

/// Joins the rims to loops, gives each hole to the rim around it, fills every face, and adds the faces to `cut`.
/// Fails: DegenerateCut when rounding has laid two loops across each other.   Cost: O(n^2) in the vertices of a face.
void make_faces(const FaceRims& rims, const Generators& generators, CutMesh& cut);

/// Area, centroid, normal (from a to b), principal axes and second moments of a face, exact for the polygon; and the distance of the
/// farthest point of its rim from the centroid. in   loops    the rim, counter-clockwise seen from b, then holes, clockwise in   normal of
/// unit length Source: C. Steger, On the calculation of moments of polygons, Technical report FGBV-96-05, TU Muenchen, 1996.
SharedFace face_measures(std::span<const std::vector<std::int32_t>> loops, const std::vector<Vec3>& vertices, const Vec3& normal);

}  // namespace scree
