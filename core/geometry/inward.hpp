// Whether a closed surface faces the inside, as that of a container does.
#pragma once

#include "core/geometry/triangle_mesh.hpp"

namespace scree {

/// Closed and oriented: each edge has as many triangles on either side. Cost: O(T log T).
bool is_closed(const TriangleMesh& mesh);

/// Closed and oriented, with normals that point to the inside: a container, whose outer edges are concave as seen from where its bodies
/// are. Cost: O(T log T).
bool faces_inward(const TriangleMesh& mesh);

}  // namespace scree
