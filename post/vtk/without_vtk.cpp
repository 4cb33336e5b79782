#include "core/base/error.hpp"
#include "post/vtk/vtk_or_not.hpp"

namespace scree {

namespace {
const char* const kMissing = "this scree-post was built without VTK; install libvtk9-dev (./setup does) and build again";
}

std::string vtk_version() { return "no VTK"; }
void require_vtk() { throw UsageError("{}", kMissing); }
std::string picture_obstacle() { return kMissing; }
std::string make_picture(const Run&, std::size_t, const std::string&, const PictureOptions&) {
  require_vtk();
  return "";
}
std::string make_film(const Run&, const std::string&, const FilmOptions&, std::vector<std::string>&) {
  require_vtk();
  return "";
}
std::string make_paraview_files(const Run&, const ParaviewOptions&, std::vector<std::string>&) {
  require_vtk();
  return "";
}
std::string make_vtk_files(const Run&, const VtkOptions&, std::vector<std::string>&) {
  require_vtk();
  return "";
}

}  // namespace scree
