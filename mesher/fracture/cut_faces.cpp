#include "mesher/fracture/cut_faces.hpp"

#include "core/base/index.hpp"
#include "core/geometry/plane_faces.hpp"
#include "core/geometry/polygon_moments.hpp"

namespace scree {

namespace {

using Ring = std::vector<std::int32_t>;

}  // namespace

void make_faces(const FaceRims& rims, const Generators& generators, CutMesh& cut) {
  for (const auto& [cells, edges] : rims) {
    const Vec3 normal = normalised(generators.points()[at(cells.second)] - generators.points()[at(cells.first)]);
    std::optional<std::vector<PlaneFace>> filled = plane_faces(edges, cut.vertices, normal);
    if (!filled) throw DegenerateCut();
    for (PlaneFace& face : *filled) cut.faces.push_back({cells.first, cells.second, std::move(face.loops), std::move(face.triangles)});
  }
}

SharedFace face_measures(std::span<const Ring> loops, const std::vector<Vec3>& vertices, const Vec3& normal) {
  std::vector<std::vector<Vec3>> corners;
  for (const Ring& loop : loops) {
    corners.emplace_back();
    for (std::int32_t v : loop) corners.back().push_back(vertices[at(v)]);
  }
  const PolygonMoments m = polygon_moments(corners, normal);
  SharedFace face;
  face.area = m.area;
  face.normal = normal;
  face.centroid = m.centroid;
  face.axis = m.axis;
  face.moment_1 = m.moment_1;
  face.moment_2 = m.moment_2;
  face.rim_radius = m.rim_radius;
  return face;
}

}  // namespace scree
