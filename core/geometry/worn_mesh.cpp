#include "core/geometry/worn_mesh.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/error.hpp"

namespace scree {

namespace {

Vec3 area_vector(const TriangleMesh& mesh, std::int32_t t) {
  return 0.5 * cross(mesh.corner(t, 1) - mesh.corner(t, 0), mesh.corner(t, 2) - mesh.corner(t, 0));
}

/// The same with corners moved by a part of their displacements.
Vec3 area_vector(const TriangleMesh& mesh, std::int32_t t, const std::vector<Vec3>& way, double part) {
  const Triangle& v = mesh.triangles[static_cast<std::size_t>(t)];
  const auto at = [&](std::size_t k) {
    const auto i = static_cast<std::size_t>(v[k]);
    return mesh.vertices[i] + part * way[i];
  };
  return 0.5 * cross(at(1) - at(0), at(2) - at(0));
}

/// Integral of the area vector over the way from 0 to `part`, over `part`: a polynomial of second degree, so that Simpson's rule is exact.
Vec3 mean_area_vector(const TriangleMesh& mesh, std::int32_t t, const std::vector<Vec3>& way, double part) {
  return (1.0 / 6) * (area_vector(mesh, t) + 4 * area_vector(mesh, t, way, 0.5 * part) + area_vector(mesh, t, way, part));
}

/// Volume lost as each vertex goes a part of its way; `side` says of each vertex which side of its triangles it recedes from.
double lost_volume(const TriangleMesh& mesh, const std::vector<Vec3>& way, const std::vector<double>& side, double part) {
  double lost = 0;
  for (std::int32_t t = 0; t < mesh.triangle_count(); ++t) {
    Vec3 gone;
    for (const std::int32_t v : mesh.triangles[static_cast<std::size_t>(t)])
      gone += (side[static_cast<std::size_t>(v)] / 3) * way[static_cast<std::size_t>(v)];
    if (!(squared_length(gone) > 0)) continue;
    lost += part * dot(mean_area_vector(mesh, t, way, part), gone);
  }
  return lost;
}

}  // namespace

double swept_volume(const TriangleMesh& mesh, const std::vector<Vec3>& to, const std::vector<signed char>& pushed) {
  std::vector<Vec3> way;
  for (std::size_t v = 0; v < to.size(); ++v) way.push_back(to[v] - mesh.vertices[v]);
  double swept = 0;
  for (std::int32_t t = 0; t < mesh.triangle_count(); ++t) {
    Vec3 gone;
    for (const std::int32_t v : mesh.triangles[static_cast<std::size_t>(t)]) gone += (1.0 / 3) * way[static_cast<std::size_t>(v)];
    if (!(squared_length(gone) > 0)) continue;
    const double side = pushed[static_cast<std::size_t>(t)] > 0 ? 1 : -1;
    swept += side * dot(mean_area_vector(mesh, t, way, 1), gone);
  }
  return swept;
}

std::vector<Vec3> worn_vertices(const TriangleMesh& mesh, const WearOfMesh& wear) {
  const std::size_t count = mesh.vertices.size();
  std::vector<Vec3> way(count), around(count);
  std::vector<double> volume(count), side(count);
  double target = 0;
  // where each vertex goes to, and what it takes along
  for (std::int32_t t = 0; t < mesh.triangle_count(); ++t) {
    const auto row = static_cast<std::size_t>(t);
    const Vec3 area = area_vector(mesh, t);
    for (const std::int32_t v : mesh.triangles[row]) around[static_cast<std::size_t>(v)] += area;
    if (!(wear.volume[row] > 0) || !(squared_length(area) > 0)) continue;
    target += wear.volume[row];
    const Vec3 along = (wear.pushed[row] > 0 ? 1 : -1) * normalised(area);
    for (const std::int32_t v : mesh.triangles[row]) {
      way[static_cast<std::size_t>(v)] += wear.volume[row] * along;
      volume[static_cast<std::size_t>(v)] += wear.volume[row] / 3;
    }
  }
  if (!(target > 0)) return mesh.vertices;
  constexpr double kMinSine = 1e-3;  // of a way to the surface about a vertex: along the surface nothing is worn off, whatever the way
  for (std::size_t v = 0; v < count; ++v) {
    const double size = length(way[v]);
    if (!(size > 0)) continue;
    way[v] *= 1 / size;
    const double across = dot(around[v], way[v]);
    if (!(std::abs(across) > kMinSine * length(around[v]))) {
      way[v] = {};
      continue;
    }
    side[v] = across > 0 ? 1 : -1;
    way[v] *= 3 * volume[v] / std::abs(across);
  }
  // the factor that makes it exact: the volume is nearly in proportion to it
  double factor = 1;
  constexpr int kMaxRounds = 60;
  constexpr double kExact = 1e-13;  // of the volume; rounding of a sum over the triangles
  for (int round = 0;; ++round) {
    const double lost = lost_volume(mesh, way, side, factor);
    if (!(lost > 0) || round == kMaxRounds) throw InputError("no displacement of its vertices gives the volume that was worn off");
    if (std::abs(lost - target) <= kExact * target) break;
    const double next = factor * (target / lost);
    if (std::abs(next - factor) <= kExact * factor) break;
    factor = next;
  }
  for (std::int32_t t = 0; t < mesh.triangle_count(); ++t) {
    const Vec3 before = area_vector(mesh, t);
    if (!(squared_length(before) > 0)) continue;
    if (!(dot(before, area_vector(mesh, t, way, factor)) > 0)) throw InputError("triangle {} would turn over", t);
  }
  std::vector<Vec3> worn = mesh.vertices;
  for (std::size_t v = 0; v < count; ++v) worn[v] += factor * way[v];
  return worn;
}

}  // namespace scree
