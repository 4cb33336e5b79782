#include "core/geometry/triangle_mesh.hpp"

#include <algorithm>

namespace scree {

Box3 bounding_box(const TriangleMesh& mesh) {
  Box3 box;
  for (const Vec3& p : mesh.vertices) box.add(p);
  return box;
}

double longest_extent(const TriangleMesh& mesh) {
  const Vec3 e = bounding_box(mesh).extent();
  return std::max({e.x, e.y, e.z});
}

double bounding_radius(const TriangleMesh& mesh) {
  double largest = 0;
  for (const Vec3& p : mesh.vertices) largest = std::max(largest, squared_length(p));
  return std::sqrt(largest);
}

double surface_area(const TriangleMesh& mesh) {
  double area = 0;
  for (std::int32_t t = 0; t < mesh.triangle_count(); ++t) {
    const Vec3& a = mesh.corner(t, 0);
    area += 0.5 * length(cross(mesh.corner(t, 1) - a, mesh.corner(t, 2) - a));
  }
  return area;
}

TriangleMesh box_mesh(const Vec3& size) {
  TriangleMesh mesh;
  for (int i = 0; i < 8; ++i) {
    mesh.vertices.push_back({(i & 1 ? 0.5 : -0.5) * size.x, (i & 2 ? 0.5 : -0.5) * size.y, (i & 4 ? 0.5 : -0.5) * size.z});
  }
  mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return mesh;
}

}  // namespace scree
