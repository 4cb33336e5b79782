// A picture of meshes side by side, for instance before and after a repair.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "core/geometry/triangle_mesh.hpp"

namespace scree {

/// Why no picture can be drawn (no VTK, no X display) and what to do, or "".
std::string picture_obstacle();

/// Draws each mesh with its edges under its title and its number of triangles, all at the same scale from the same
/// side, into a PNG. Open edges are red. Edges of dense meshes are left out.
/// Fails: SystemError when it cannot be drawn or written.
void draw_meshes(const std::vector<std::pair<std::string, const TriangleMesh*>>& meshes, const std::string& path);

/// Draws the pieces of a body side by side with themselves, moved apart from its origin by a part of their distance, each in a colour of
/// its own, as draw_meshes does. in   pieces   mesh of each piece in the coordinates of the body, and its centre [m]
void draw_pieces(const std::string& title, const std::vector<std::pair<TriangleMesh, Vec3>>& pieces, const std::string& path);

}  // namespace scree
