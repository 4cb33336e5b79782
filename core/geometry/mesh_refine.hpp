// More triangles for the same surface.
#pragma once

#include <cstdint>

#include "core/geometry/triangle_mesh.hpp"

namespace scree {

/// Splits edges at their middles until none is longer than `edge_length`; the surface does not change.
///
/// How: an edge is split in both of its triangles, so no T-junction arises; a triangle with one, two or three split
/// edges becomes two, three or four. New vertices lie in the old triangles, up to rounding.
/// in   edge_length        [m], > 0
/// in   most_triangles     throws UsageError when more would be needed
/// Returns the number of edges that were split.   Cost: O(T log T) of the result.
std::int64_t refine_mesh(TriangleMesh& mesh, double edge_length, std::int64_t most_triangles);

/// Splits every triangle in four.   Cost: O(T log T).
void split_in_four(TriangleMesh& mesh);

}  // namespace scree
