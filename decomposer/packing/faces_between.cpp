#include "decomposer/packing/faces_between.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "core/geometry/features.hpp"
#include "core/geometry/periodic.hpp"
#include "core/geometry/polygon_moments.hpp"

namespace scree {

namespace {

/// A face is convex when its area is that of its hull within this part: rounding of the vertices of a file in single precision.
constexpr double kConvexRounding = 1e-6;
/// Faces that turn by less than this from facing each other [rad]: what placing with a few digits leaves.
constexpr double kParallel = 1e-3;
/// Common areas below this part of the smaller face are a touch of edges.
constexpr double kMinCommon = 1e-6;
/// Of the size of a body: by as much may faces lie in each other where they are placed to touch.
constexpr double kTouching = 1e-9;

struct FlatFace {
  Vec3 normal;                ///< unit, outward
  std::vector<Vec3> corners;  ///< convex, counter-clockwise seen from outside
  double area = 0;
};

double area_of(const std::vector<Vec3>& polygon, const Vec3& normal) {
  Vec3 doubled;
  for (std::size_t k = 1; k + 1 < polygon.size(); ++k) doubled += cross(polygon[k] - polygon[0], polygon[k + 1] - polygon[0]);
  return 0.5 * dot(doubled, normal);
}

/// Convex hull of points in a plane, counter-clockwise. Source: A. Andrew, Another efficient algorithm for convex hulls in two dimensions,
/// Inf. Proc. Lett. 9 (1979) 216.
std::vector<Vec3> hull_of(std::vector<Vec3> points, const Vec3& normal) {
  const PlaneAxes axes(normal, points[0]);
  const auto x = [&](const Vec3& p) { return dot(axes.u, p - axes.origin); };
  const auto y = [&](const Vec3& p) { return dot(axes.v, p - axes.origin); };
  std::sort(points.begin(), points.end(), [&](const Vec3& a, const Vec3& b) { return std::pair(x(a), y(a)) < std::pair(x(b), y(b)); });
  std::vector<Vec3> hull;
  for (int side = 0; side < 2; ++side) {
    const std::size_t first = hull.size();
    for (const Vec3& p : points) {
      while (hull.size() >= first + 2 && dot(cross(hull.back() - hull[hull.size() - 2], p - hull.back()), normal) <= 0) hull.pop_back();
      hull.push_back(p);
    }
    hull.pop_back();
    std::reverse(points.begin(), points.end());
  }
  return hull;
}

/// The flat faces of a shape that have a convex outline.
std::vector<FlatFace> flat_faces(const TriangleMesh& mesh) {
  const FeatureTable features = find_features(mesh);
  const auto count = static_cast<std::size_t>(features.region_count);
  std::vector<Vec3> doubled(count);
  std::vector<std::vector<Vec3>> points(count);
  for (std::int32_t t = 0; t < mesh.triangle_count(); ++t) {
    const auto r = static_cast<std::size_t>(features.region[static_cast<std::size_t>(t)]);
    doubled[r] += cross(mesh.corner(t, 1) - mesh.corner(t, 0), mesh.corner(t, 2) - mesh.corner(t, 0));
    for (int k = 0; k < 3; ++k) points[r].push_back(mesh.corner(t, k));
  }
  std::vector<FlatFace> faces;
  for (std::size_t r = 0; r < count; ++r) {
    if (points[r].size() < 3 || !(squared_length(doubled[r]) > 0)) continue;
    FlatFace face{normalised(doubled[r]), {}, 0.5 * length(doubled[r])};
    face.corners = hull_of(points[r], face.normal);
    if (face.corners.size() < 3 || area_of(face.corners, face.normal) > (1 + kConvexRounding) * face.area) continue;
    faces.push_back(std::move(face));
  }
  return faces;
}

FlatFace placed(const FlatFace& face, const BodyRow& row, const Vec3& position) {
  FlatFace moved{rotate(row.orientation, face.normal), {}, row.scale * row.scale * face.area};
  for (const Vec3& p : face.corners) moved.corners.push_back(position + rotate(row.orientation, row.scale * p));
  return moved;
}

/// What two convex polygons have in common, in the plane of the first, seen along its normal.
/// Source: I. Sutherland, G. Hodgman, Reentrant polygon clipping, Comm. ACM 17 (1974) 32.
std::vector<Vec3> common_part(const FlatFace& a, const FlatFace& b) {
  std::vector<Vec3> part = a.corners;
  for (std::size_t k = 0; k < b.corners.size() && !part.empty(); ++k) {
    // b runs clockwise seen from outside of a
    const Vec3 &from = b.corners[(k + 1) % b.corners.size()], &to = b.corners[k];
    const Vec3 inward = cross(a.normal, to - from);
    std::vector<Vec3> kept;
    for (std::size_t i = 0; i < part.size(); ++i) {
      const Vec3 &p = part[i], &q = part[(i + 1) % part.size()];
      const double dp = dot(inward, p - from), dq = dot(inward, q - from);
      if (dp >= 0) kept.push_back(p);
      if ((dp > 0 && dq < 0) || (dp < 0 && dq > 0)) kept.push_back(p + (dp / (dp - dq)) * (q - p));
    }
    part = std::move(kept);
  }
  return part;
}

}  // namespace

void fill_bond(const CaseBond& given, Bond& bond) {
  bond.normal_stiffness = given.young / bond.height;
  bond.tangential_stiffness = given.tangential_ratio * bond.normal_stiffness;
  bond.tension = given.tension;
  bond.cohesion = given.cohesion;
  bond.friction = std::tan(given.friction_angle);
  bond.fracture_energy = given.fracture_energy;
  bond.damping = given.damping;
}

std::size_t bond_faces_between(const CaseBond& given, double distance, const WholeBodies& whole, Scene& scene) {
  const Domain& domain = scene.settings.domain;
  const Periodicity periodicity = periodicity_of(domain);
  std::map<std::int32_t, std::vector<FlatFace>> faces;
  std::vector<std::size_t> bodies;
  double widest = 0;
  const auto radius = [&](std::size_t b) {
    return scene.bodies.scale[b] * scene.shapes[static_cast<std::size_t>(scene.bodies.shape[b])].bounding_radius();
  };
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    const std::int32_t m = scene.bodies.material[b], s = scene.bodies.shape[b];
    if (m != given.between_a && m != given.between_b) continue;
    bodies.push_back(b);
    widest = std::max(widest, radius(b));
    if (!faces.contains(s)) faces[s] = flat_faces(scene.shapes[static_cast<std::size_t>(s)].mesh);
  }
  // a sweep along x, but where that axis has no ends
  const bool sweeps = !periodicity.is_periodic(0);
  std::sort(bodies.begin(), bodies.end(),
            [&](std::size_t l, std::size_t r) { return scene.bodies.position[l].x < scene.bodies.position[r].x; });
  std::vector<Bond> found;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    for (std::size_t j = i + 1; j < bodies.size(); ++j) {
      std::size_t a = bodies[i], b = bodies[j];
      if (sweeps && scene.bodies.position[b].x - scene.bodies.position[a].x > 2 * widest + distance) break;
      if (scene.bodies.id[a] > scene.bodies.id[b]) std::swap(a, b);
      const std::int32_t low = std::min(scene.bodies.material[a], scene.bodies.material[b]);
      const std::int32_t high = std::max(scene.bodies.material[a], scene.bodies.material[b]);
      if (low != given.between_a || high != given.between_b || (scene.bodies.fixed[a] && scene.bodies.fixed[b])) continue;
      if (are_of_one_body(whole, scene.bodies.id[a], scene.bodies.id[b])) continue;
      const BodyRow row_a = scene.bodies.row(a), row_b = scene.bodies.row(b);
      const Vec3 branch = periodicity.nearest(row_b.position - row_a.position);
      if (length(branch) > radius(a) + radius(b) + distance) continue;
      // about the centre of A, so that no digits are lost far from the origin
      for (const FlatFace& face_a : faces[row_a.shape]) {
        const FlatFace fa = placed(face_a, row_a, {});
        for (const FlatFace& face_b : faces[row_b.shape]) {
          const FlatFace fb = placed(face_b, row_b, branch);
          if (length(fa.normal + fb.normal) > kParallel) continue;
          const double gap = dot(fa.normal, fb.corners[0] - fa.corners[0]), height = dot(fa.normal, branch);
          if (gap > distance || gap < -kTouching * (radius(a) + radius(b)) || !(height > 0)) continue;
          const std::vector<Vec3> part = common_part(fa, fb);
          if (part.size() < 3 || !(area_of(part, fa.normal) > kMinCommon * std::min(fa.area, fb.area))) continue;
          const PolygonMoments m = polygon_moments(std::vector<std::vector<Vec3>>{part}, fa.normal);
          const Vec3 point = m.centroid + (0.5 * gap) * fa.normal;
          const Quat frame = normalised(quaternion_of(transpose(Mat3{{fa.normal, m.axis, cross(fa.normal, m.axis)}})));
          Bond bond;
          bond.a = row_a.id;
          bond.b = row_b.id;
          bond.point_a = rotate_inverse(row_a.orientation, point);
          bond.point_b = rotate_inverse(row_b.orientation, point - branch);
          bond.frame_a = normalised(conjugate(row_a.orientation) * frame);
          bond.frame_b = normalised(conjugate(row_b.orientation) * frame);
          bond.area = m.area;
          bond.moment_1 = m.moment_1;
          bond.moment_2 = m.moment_2;
          bond.height = height;
          bond.rim_radius = m.rim_radius;
          fill_bond(given, bond);
          found.push_back(bond);
        }
      }
    }
  }
  scene.bonds.insert(scene.bonds.end(), found.begin(), found.end());
  return found.size();
}

}  // namespace scree
