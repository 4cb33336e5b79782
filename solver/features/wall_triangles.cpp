#include "solver/features/wall_triangles.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/geometry/nearest_on_triangle.hpp"

namespace scree {

namespace {

/// Leaves those of the candidates that are as near to a point as the nearest.
void keep_nearest(const TriangleMesh& mesh, const Vec3& point, double tolerance, std::vector<std::int32_t>& triangles) {
  thread_local std::vector<double> distances;
  distances.clear();
  double nearest = std::numeric_limits<double>::infinity();
  for (const std::int32_t t : triangles) {
    distances.push_back(length(point - nearest_on_triangle(point, mesh.corner(t, 0), mesh.corner(t, 1), mesh.corner(t, 2)).point));
    nearest = std::min(nearest, distances.back());
  }
  std::size_t kept = 0;
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    if (distances[i] <= nearest + tolerance) triangles[kept++] = triangles[i];
  }
  triangles.resize(kept);
}

}  // namespace

void triangles_of(const PairView& view, const CandidateLists& lists, const ContactFeature& feature, MeshDistanceScratch& scratch,
                  std::vector<std::int32_t>& triangles) {
  const SolverShape& wall = *view.b.shape;
  const double gap = view.margin - feature.overlap;
  const Vec3 point = (1 / view.b.scale) * view.pose.b_from_a(feature.x - (0.5 * gap) * feature.n);
  const double margin = view.margin / view.b.scale;
  triangles.clear();
  if (view.geometry == PairGeometry::sphere_mesh) {  // every triangle that the ball can touch is a candidate
    for (const CornerCandidate& c : lists.corners_a) triangles.push_back(c.triangle);
  } else {
    static const TriangleMesh dot{{Vec3{}}, {Triangle{0, 0, 0}}};
    static const Bvh dot_tree = build_bvh(dot);
    thread_local std::vector<TrianglePair> pairs;
    Placement place;
    place.translation = point;
    constexpr int kMaxTimes = 64;  // the place of a contact is within the margins but for rounding; the end is for one that is not a number
    pairs.clear();
    for (double reach = margin; pairs.empty() && reach < std::ldexp(margin, kMaxTimes); reach *= 2)
      triangle_pairs_within({&wall.mesh, &wall.bvh}, {&dot, &dot_tree}, place, reach, scratch, pairs);
    for (const TrianglePair& pair : pairs) triangles.push_back(pair.a);
  }
  std::sort(triangles.begin(), triangles.end());
  triangles.erase(std::unique(triangles.begin(), triangles.end()), triangles.end());
  keep_nearest(wall.mesh, point, kSameTriangleDistance * margin, triangles);
}

}  // namespace scree
