#include "core/base/error.hpp"
#include "mesher/edit/mesh_picture.hpp"

namespace scree {

std::string picture_obstacle() { return "this scree-mesher was built without VTK; install libvtk9-dev (./setup does) and build again"; }

void draw_meshes(const std::vector<std::pair<std::string, const TriangleMesh*>>&, const std::string&) {
  throw SystemError("cannot draw a picture: {}", picture_obstacle());
}

void draw_pieces(const std::string&, const std::vector<std::pair<TriangleMesh, Vec3>>&, const std::string&) {
  throw SystemError("cannot draw a picture: {}", picture_obstacle());
}

}  // namespace scree
