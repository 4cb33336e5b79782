// Whether a surface is closed, and its other side.
#pragma once

#include "core/geometry/triangle_mesh.hpp"

namespace scree {

/// Closed and oriented: each edge has as many triangles on either side. Cost: O(T log T).
bool is_closed(const TriangleMesh& mesh);

/// Reverses the winding of all triangles: normals point to the other side. Cost: O(T).
void turn_inside_out(TriangleMesh& mesh);

}  // namespace scree
