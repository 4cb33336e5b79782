// VTK surfaces: what ParaView opens. Present only in builds with VTK.
#pragma once

#include <string>
#include <vector>

#include "post/drawn_meshes.hpp"

namespace scree {

/// One mesh as a .vtp of 3 x float32 points, appended raw, zlib. Throws SystemError when it cannot be written.
void write_mesh_vtp(const std::string& path, const DrawnMesh& mesh);

/// All walls in one .vtp; cell data "wall" is the wall's id.
void write_walls_vtp(const std::string& path, const Scene& scene, const std::vector<TriangleMesh>& walls,
                     const std::vector<WallPlace>& places);

/// Every body's own triangles in world coordinates, float32; cell data id (int64), shape, material (int32),
/// speed (float32) [m/s].   Cost: bodies x triangles in memory.
void write_surfaces_vtp(const std::string& path, const FrameBodies& bodies, const std::vector<DrawnMesh>& shapes);

}  // namespace scree
