#include "decomposer/case/machine_forms.hpp"

#include <cmath>

namespace scree {

WallForm screw_form(const Vec3& start, const Vec3& end, const Screw& screw, int segments) {
  const Vec3 axis = normalised(end - start), middle = 0.5 * (start + end);
  const auto [u, v] = across(axis);
  TriangleMesh mesh = screw_mesh(screw, length(end - start), segments);
  for (Vec3& p : mesh.vertices) p = middle + p.x * u + p.y * v + p.z * axis;
  return {std::move(mesh), {}};
}

double reach_across(const Paddles& p) { return 0.5 * (p.width * std::abs(std::sin(p.angle)) + p.thickness * std::abs(std::cos(p.angle))); }

WallForm paddles_form(const Vec3& start, const Vec3& end, const Paddles& paddles, int segments) {
  const Vec3 axis = normalised(end - start);
  const auto [u, v] = across(axis);
  TriangleMesh mesh = cone_form(start, end, paddles.shaft, paddles.shaft, false, false, segments).inside;
  const double side = reach_across(paddles), blade_length = std::sqrt(paddles.radius * paddles.radius - side * side);
  const TriangleMesh blade = box_mesh({blade_length, paddles.width, paddles.thickness});
  for (int i = 0; i < paddles.count; ++i) {
    const double turn = paddles.turn * i;
    const Vec3 out = std::cos(turn) * u + std::sin(turn) * v, around = cross(axis, out);
    const Vec3 along = std::cos(paddles.angle) * axis + std::sin(paddles.angle) * around, through = cross(out, along);
    const Vec3 foot = start + ((i + 0.5) / paddles.count) * (end - start);
    const std::int32_t first = mesh.vertex_count();
    for (const Vec3& p : blade.vertices) mesh.vertices.push_back(foot + (p.x + 0.5 * blade_length) * out + p.y * along + p.z * through);
    for (const Triangle& t : blade.triangles) mesh.triangles.push_back({first + t[0], first + t[1], first + t[2]});
  }
  return {std::move(mesh), {}};
}

}  // namespace scree
