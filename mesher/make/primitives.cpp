#include "mesher/make/primitives.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/error.hpp"
#include "core/base/numbers.hpp"
#include "core/geometry/mesh_refine.hpp"
#include "mesher/edit/convex_hull.hpp"

namespace scree {

namespace {

/// A ring of vertices or a single point, from which strips of triangles are sewn.
struct VertexRing {
  std::int32_t first = 0, count = 1;
  std::int32_t at(std::int32_t i) const { return first + (count == 1 ? 0 : i % count); }
};

/// Triangles between two rings of equal count (or a point), outward when `below` comes first along the axis and rings run
/// counter-clockwise seen from its end.
void sew(TriangleMesh& mesh, const VertexRing& below, const VertexRing& above) {
  const std::int32_t n = std::max(below.count, above.count);
  for (std::int32_t i = 0; i < n; ++i) {
    if (below.count > 1) mesh.triangles.push_back({below.at(i), below.at(i + 1), above.at(i)});
    if (above.count > 1) mesh.triangles.push_back({below.at(i + 1), above.at(i + 1), above.at(i)});
  }
}

VertexRing add_point(TriangleMesh& mesh, const Vec3& p) {
  mesh.vertices.push_back(p);
  return {mesh.vertex_count() - 1, 1};
}

}  // namespace

TriangleMesh icosphere(int level) {
  TriangleMesh mesh = platonic_solid("icosahedron");
  for (Vec3& p : mesh.vertices) p = normalised(p);
  for (int l = 0; l < level; ++l) {
    split_in_four(mesh);
    for (Vec3& p : mesh.vertices) p = normalised(p);
  }
  return mesh;
}

TriangleMesh platonic_solid(const std::string& name) {
  const double g = (1 + std::sqrt(5.0)) / 2;
  std::vector<Vec3> corners;
  double edge = 1;  // of the coordinates below
  if (name == "tetrahedron") {
    corners = {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
    edge = std::sqrt(8.0);
  } else if (name == "cube") {
    return box_mesh({1, 1, 1});
  } else if (name == "octahedron") {
    corners = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
    edge = std::sqrt(2.0);
  } else if (name == "icosahedron" || name == "dodecahedron") {
    const bool is_dodecahedron = name == "dodecahedron";
    const double a = is_dodecahedron ? 1 / g : 1, b = g;
    for (double s : {-1.0, 1.0}) {
      for (double t : {-1.0, 1.0}) {
        corners.insert(corners.end(), {Vec3{0, s * a, t * b}, Vec3{s * a, t * b, 0}, Vec3{t * b, 0, s * a}});
        if (!is_dodecahedron) continue;
        corners.insert(corners.end(), {Vec3{1, s, t}, Vec3{-1, s, t}});
      }
    }
    edge = is_dodecahedron ? 2 / g : 2;
  } else {
    throw UsageError("'{}' is no Platonic solid; expected tetrahedron, cube, octahedron, dodecahedron or icosahedron", name);
  }
  for (Vec3& p : corners) p *= 1 / edge;
  return convex_hull(corners);
}

TriangleMesh ellipsoid(const Vec3& semi_axes, int level) {
  TriangleMesh mesh = icosphere(level);
  for (Vec3& p : mesh.vertices) p = {semi_axes.x * p.x, semi_axes.y * p.y, semi_axes.z * p.z};
  return mesh;
}

TriangleMesh superellipsoid(const Vec3& semi_axes, double e, double n, int level) {
  TriangleMesh mesh = icosphere(level);
  for (Vec3& p : mesh.vertices) {
    // along the ray of the sphere's point, to the surface
    const double xy = std::pow(std::pow(std::abs(p.x), 2 / e) + std::pow(std::abs(p.y), 2 / e), e / n);
    const double f = std::pow(xy + std::pow(std::abs(p.z), 2 / n), -n / 2);
    p = {f * semi_axes.x * p.x, f * semi_axes.y * p.y, f * semi_axes.z * p.z};
  }
  return mesh;
}

TriangleMesh torus(double ring, double tube, int n, int m) {
  TriangleMesh mesh;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < m; ++j) {
      const double u = 2 * kPi * i / n, v = 2 * kPi * j / m, r = ring + tube * std::cos(v);
      mesh.vertices.push_back({r * std::cos(u), r * std::sin(u), tube * std::sin(v)});
      const auto at = [&](int a, int b) { return (a % n) * m + b % m; };
      mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  return mesh;
}

TriangleMesh revolved(const std::vector<std::array<double, 2>>& profile, int sectors) {
  TriangleMesh mesh;
  VertexRing last;
  bool is_first = true;
  const auto add = [&](double r, double z) {
    VertexRing ring;
    if (r > 0) {
      ring = {mesh.vertex_count(), sectors};
      for (int i = 0; i < sectors; ++i) {
        const double u = 2 * kPi * i / sectors;
        mesh.vertices.push_back({r * std::cos(u), r * std::sin(u), z});
      }
    } else {
      ring = add_point(mesh, {0, 0, z});
    }
    if (!is_first) sew(mesh, last, ring);
    is_first = false;
    last = ring;
  };
  if (profile.front()[0] > 0) add(0, profile.front()[1]);
  for (const auto& [r, z] : profile) add(r, z);
  if (profile.back()[0] > 0) add(0, profile.back()[1]);
  return mesh;
}

TriangleMesh capsule(double radius, double height, int sectors) {
  std::vector<std::array<double, 2>> profile;
  const int rings = std::max(2, sectors / 4);
  for (int i = 0; i <= rings; ++i) {
    const double a = 0.5 * kPi * i / rings;
    profile.push_back({i == 0 ? 0 : radius * std::sin(a), -0.5 * height - radius * std::cos(a)});
  }
  for (int i = rings; i >= 0; --i) profile.push_back({profile[static_cast<std::size_t>(i)][0], -profile[static_cast<std::size_t>(i)][1]});
  if (!(height > 0)) profile.erase(profile.begin() + rings);
  return revolved(profile, sectors);
}

TriangleMesh cone(double lower, double upper, double height, int sectors) {
  return revolved({{lower, -0.5 * height}, {upper, 0.5 * height}}, sectors);
}

TriangleMesh tablet(double radius, double height, double cup, double bevel, int sectors, int rings) {
  std::vector<std::array<double, 2>> cap;  // of the upper half, from its middle to the band
  if (bevel > 0) {
    cap = {{radius - bevel, 0.5 * height + cup}, {radius, 0.5 * height}};
  } else {
    const double sphere = 0.5 * (radius * radius + cup * cup) / cup, centre = 0.5 * height + cup - sphere;
    const double end = 2 * std::atan2(cup, radius);  // of the arc, from the axis
    for (int i = 0; i < rings; ++i) {
      const double a = end * i / rings;
      cap.push_back({i == 0 ? 0 : sphere * std::sin(a), centre + sphere * std::cos(a)});
    }
    cap.push_back({radius, 0.5 * height});
  }
  std::vector<std::array<double, 2>> profile;
  for (const auto& [r, z] : cap) profile.push_back({r, -z});
  for (auto point = cap.rbegin(); point != cap.rend(); ++point) profile.push_back(*point);
  return revolved(profile, sectors);
}

TriangleMesh rod(const std::vector<Vec3>& path, double radius, int sectors) {
  TriangleMesh mesh;
  // a frame carried along the path without twist
  Vec3 tangent = normalised(path[1] - path[0]);
  Vec3 u = std::abs(tangent.x) < 0.9 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
  VertexRing last = add_point(mesh, path.front());
  for (std::size_t i = 0; i < path.size(); ++i) {
    const Vec3 before = i == 0 ? tangent : normalised(path[i] - path[i - 1]);
    const Vec3 after = i + 1 == path.size() ? before : normalised(path[i + 1] - path[i]);
    const Vec3 n = normalised(before + after);  // of the mitre plane, at which both pieces end
    u = normalised(u - dot(u, before) * before);
    const Vec3 v = cross(before, u);
    VertexRing ring{mesh.vertex_count(), sectors};
    for (int k = 0; k < sectors; ++k) {
      const double a = 2 * kPi * k / sectors;
      const Vec3 d = radius * (std::cos(a) * u + std::sin(a) * v);
      mesh.vertices.push_back(path[i] + d - (dot(d, n) / dot(before, n)) * before);
    }
    sew(mesh, last, ring);
    last = ring;
  }
  sew(mesh, last, add_point(mesh, path.back()));
  return mesh;
}

std::vector<Vec3> u_path(double width, double left_leg, double right_leg, int steps) {
  std::vector<Vec3> path{{-0.5 * width, 0, left_leg}};
  for (int i = 0; i <= steps; ++i) {
    const double a = kPi * i / steps;
    path.push_back({-0.5 * width * std::cos(a), 0, -0.5 * width * std::sin(a)});
  }
  path.push_back({0.5 * width, 0, right_leg});
  return path;
}

}  // namespace scree
