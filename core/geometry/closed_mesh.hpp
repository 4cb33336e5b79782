// Whether a surface is closed.
#pragma once

#include "core/geometry/triangle_mesh.hpp"

namespace scree {

/// Closed and oriented: each edge has as many triangles on either side. Cost: O(T log T).
bool is_closed(const TriangleMesh& mesh);

}  // namespace scree
