#include "core/base/error.hpp"
#include "post/vtk_or_not.hpp"

namespace scree {

namespace {
const char* const kMissing = "this scree-post was built without VTK; install libvtk9-dev (./setup does) and build again";
}

std::string vtk_version() { return "no VTK"; }
void require_vtk() { throw UsageError("{}", kMissing); }
std::string picture_obstacle() { return kMissing; }
void make_picture(const Run&, std::size_t, const std::string&) { require_vtk(); }
std::string make_paraview_files(const Run&, const std::string&, const std::string&) {
  require_vtk();
  return "";
}

}  // namespace scree
