// The cells of a closed mesh that was cut (cut_mesh.hpp).
#pragma once

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/geometry/triangle_mesh.hpp"
#include "mesher/fracture/voronoi_cells.hpp"

namespace scree {

/// One face between two cells: a polygon with holes, in the bisector plane of their generators.
struct CutFace {
  std::int32_t cell_a = 0, cell_b = 0;           ///< cell_a < cell_b
  std::vector<std::vector<std::int32_t>> loops;  ///< vertices; the rim, then holes; seen from b, the rim is counter-clockwise
  std::vector<Triangle> triangles;               ///< the same area; counter-clockwise seen from b
};

/// The cells as closed surfaces that share their vertices and faces: what one cell has, the one behind it has, turned round.
struct CutMesh {
  std::vector<Vec3> vertices;               ///< [m] those of the mesh first
  std::vector<std::vector<Triangle>> skin;  ///< of each cell: its share of the mesh's surface, outward
  std::vector<CutFace> faces;               ///< by cell_a, cell_b
};

}  // namespace scree
