// What must hold of any mesh, however it came about: no crash, and no certificate for what is no solid.
#pragma once

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "mesher/check/mesh_check.hpp"
#include "mesher/repair/heal_mesh.hpp"
#include "mesher/repair/mesh_repair.hpp"

namespace scree::test {

[[noreturn]] inline void wrong_certificate(const char* why) {
  std::fprintf(stderr, "wrong certificate: %s\n", why);
  std::abort();
}

/// Looks at a mesh that was called a solid with the plainest code there is.
inline void expect_true_certificate(const TriangleMesh& mesh, const MeshCheck& check) {
  std::map<std::pair<std::int32_t, std::int32_t>, int> directed;
  double volume6 = 0;
  const Vec3 o = mesh.vertices.empty() ? Vec3{} : mesh.vertices[0];
  for (std::int32_t t = 0; t < mesh.triangle_count(); ++t) {
    const Triangle& c = mesh.triangles[static_cast<std::size_t>(t)];
    for (std::size_t k = 0; k < 3; ++k) {
      if (++directed[{c[k], c[(k + 1) % 3]}] > 1) wrong_certificate("two triangles run along an edge in the same direction");
    }
    volume6 += dot(mesh.corner(t, 0) - o, cross(mesh.corner(t, 1) - o, mesh.corner(t, 2) - o));
  }
  for (const auto& [edge, count] : directed) {
    if (!directed.contains({edge.second, edge.first})) wrong_certificate("an edge has one triangle only");
  }
  if (!(volume6 > 0) || !std::isfinite(volume6)) wrong_certificate("the signed volume is not above 0");
  if (!(check.mass.principal_moments.x > 0)) wrong_certificate("a principal moment is not above 0");
}

/// Cleans, checks, and, when asked to, heals and checks again, as check and repair do. Returns whether it ended as a solid.
inline bool examine(TriangleMesh mesh, bool heals) {
  clean_mesh(mesh, false);
  const MeshCheck check = check_mesh(mesh);
  if (check.is_solid()) expect_true_certificate(mesh, check);
  if (check.nonfinite_vertices > 0 || mesh.triangles.empty()) return false;
  if (!heals) return check.is_solid();
  std::vector<std::string> steps;
  heal_mesh(mesh, {}, steps);
  const MeshCheck healed = check_mesh(mesh);
  if (healed.is_solid()) expect_true_certificate(mesh, healed);
  if (check.is_solid() && !healed.is_solid()) wrong_certificate("repair broke a solid");
  return healed.is_solid();
}

}  // namespace scree::test
