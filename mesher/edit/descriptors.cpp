#include "mesher/edit/descriptors.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/geometry/half_edges.hpp"
#include "mesher/edit/convex_hull.hpp"
#include "mesher/edit/sieve_opening.hpp"

namespace scree {

namespace {

double angularity_of(const TriangleMesh& mesh) {
  std::vector<Vec3> normal(mesh.triangles.size());
  for (std::int32_t t = 0; t < mesh.triangle_count(); ++t) {
    const Vec3 n = cross(mesh.corner(t, 1) - mesh.corner(t, 0), mesh.corner(t, 2) - mesh.corner(t, 0));
    const double l = length(n);
    normal[static_cast<std::size_t>(t)] = l > 0 ? (1 / l) * n : n;
  }
  double first = 0, second = 0;  // sums of length x angle and length x angle^2
  const std::vector<HalfEdge> half = sorted_half_edges(mesh);
  for_each_edge(half, [&](std::size_t i, std::size_t j) {
    if (j - i != 2) return;
    const HalfEdge &g = half[i].is_forward ? half[i] : half[i + 1], &h = half[i].is_forward ? half[i + 1] : half[i];
    const Vec3 edge = mesh.vertices[static_cast<std::size_t>(g.high)] - mesh.vertices[static_cast<std::size_t>(g.low)];
    const Vec3 &a = normal[static_cast<std::size_t>(g.triangle)], &b = normal[static_cast<std::size_t>(h.triangle)];
    const double l = length(edge);
    if (!(l > 0)) return;
    // the triangle that runs along the edge has the other one on its right: convex where the normals open outward
    const double angle = std::atan2(dot(cross(a, b), edge) / l, dot(a, b));
    if (angle <= 0) return;
    first += l * angle;
    second += l * angle * angle;
  });
  return first > 0 ? second / first / std::numbers::pi : 0;
}

}  // namespace

Descriptors describe(const TriangleMesh& mesh) {
  Descriptors d;
  const MassProperties mass = mass_properties(mesh);
  d.volume = mass.volume;
  d.area = surface_area(mesh);
  d.volume_diameter = std::cbrt(6 * d.volume / std::numbers::pi);
  d.area_diameter = std::sqrt(d.area / std::numbers::pi);
  d.sphericity = d.area > 0 ? std::numbers::pi * d.volume_diameter * d.volume_diameter / d.area : 0;
  const TriangleMesh hull = convex_hull(mesh.vertices);
  d.hull_volume = mass_properties(hull).volume;
  d.convexity = d.hull_volume > 0 ? d.volume / d.hull_volume : 0;
  Box3 box;
  for (const Vec3& p : mesh.vertices) box.add(rotate_inverse(mass.body_from_principal, p - mass.centre));
  std::array<double, 3> sides{box.extent().x, box.extent().y, box.extent().z};
  std::sort(sides.rbegin(), sides.rend());
  d.lengths = {sides[0], sides[1], sides[2]};
  d.elongation = sides[1] / sides[0];
  d.flatness = sides[2] / sides[1];
  d.angularity = angularity_of(mesh);
  d.sieve_opening = sieve_opening(hull.vertices);
  d.sieve_ratio = d.volume_diameter / d.sieve_opening;
  d.principal_moments = mass.principal_moments;
  return d;
}

const std::vector<DescriptorColumn>& descriptor_columns() {
  using D = const Descriptors&;
  static const std::vector<DescriptorColumn> columns{{"volume", "m^3", [](D d) { return d.volume; }},
                                                     {"surface", "m^2", [](D d) { return d.area; }},
                                                     {"equivalent_diameter", "m", [](D d) { return d.volume_diameter; }},
                                                     {"surface_diameter", "m", [](D d) { return d.area_diameter; }},
                                                     {"hull_volume", "m^3", [](D d) { return d.hull_volume; }},
                                                     {"length_l", "m", [](D d) { return d.lengths.x; }},
                                                     {"length_i", "m", [](D d) { return d.lengths.y; }},
                                                     {"length_s", "m", [](D d) { return d.lengths.z; }},
                                                     {"sphericity", "", [](D d) { return d.sphericity; }},
                                                     {"convexity", "", [](D d) { return d.convexity; }},
                                                     {"elongation", "", [](D d) { return d.elongation; }},
                                                     {"flatness", "", [](D d) { return d.flatness; }},
                                                     {"angularity", "", [](D d) { return d.angularity; }},
                                                     {"sieve_opening", "m", [](D d) { return d.sieve_opening; }},
                                                     {"sieve_ratio", "", [](D d) { return d.sieve_ratio; }},
                                                     {"principal_moment_1", "m^5", [](D d) { return d.principal_moments.x; }},
                                                     {"principal_moment_2", "m^5", [](D d) { return d.principal_moments.y; }},
                                                     {"principal_moment_3", "m^5", [](D d) { return d.principal_moments.z; }}};
  return columns;
}

std::string distribution_of(const std::vector<Descriptors>& all) {
  std::string text;
  for (const DescriptorColumn& column : descriptor_columns()) {
    const std::string name = column.name;
    if (*column.unit != '\0' && name != "equivalent_diameter") continue;
    double sum = 0, squares = 0, least = 1e308, most = -1e308;
    for (const Descriptors& d : all) {
      const double x = column.value(d);
      sum += x, squares += x * x;
      least = std::min(least, x), most = std::max(most, x);
    }
    const auto n = static_cast<double>(all.size());
    const double mean = sum / n, variance = n > 1 ? std::max(0.0, (squares - n * mean * mean) / (n - 1)) : 0;
    text += fmt::format("  {:<20} mean {:.4g}, standard deviation {:.3g}, from {:.4g} to {:.4g}{}\n", name, mean, std::sqrt(variance),
                        least, most, *column.unit == '\0' ? "" : std::string(" ") + column.unit);
  }
  return text;
}

}  // namespace scree
