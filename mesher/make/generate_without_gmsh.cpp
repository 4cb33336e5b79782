#include "core/base/error.hpp"
#include "mesher/make/generate.hpp"

namespace scree {

namespace {
[[noreturn]] void refuse(const char* what) {
  throw UsageError(
      "generate {}: this build has no gmsh, which makes the mesh; install libgmsh-dev and build again "
      "(a box without --edge-length and an --analytic sphere need no gmsh)",
      what);
}
}  // namespace

bool has_gmsh() { return false; }
std::string gmsh_version() { return ""; }
TriangleMesh generate_sphere(double, double) { refuse("sphere"); }
TriangleMesh generate_box(const Vec3&, double) { refuse("box"); }
TriangleMesh generate_cylinder(double, double, double, int) { refuse("cylinder"); }

}  // namespace scree
