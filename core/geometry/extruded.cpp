#include "core/geometry/extruded.hpp"

#include <cmath>

namespace scree {

namespace {

/// The diagonal of the faces between two layers: from the first or second end of the edge below, or from one and the other in turn.
enum class Diagonal { from_start, from_end, in_turn };

/// A face that twists is not flat, and either diagonal leaves out or adds a part of it that adds up, over all layers, to an error of first
/// order in the step. So both sides of a flight have the diagonal from the inner end below: they are then the same surface, turned, and
/// what one adds the other leaves out. On a circle the diagonal that stands upright makes the faces of a prism. Elsewhere diagonals
/// alternate.
///   in   step   by which a layer turns [rad]
Diagonal diagonal_of(const CrossSection& section, std::int32_t from, std::int32_t to, double step) {
  constexpr double kRounding = 1e-12;  // of a radius, of points that were placed on one circle
  const auto& [ax, ay] = section.points[static_cast<std::size_t>(from)];
  const auto& [bx, by] = section.points[static_cast<std::size_t>(to)];
  const double a = std::hypot(ax, ay), b = std::hypot(bx, by);
  if (step == 0) return Diagonal::from_start;
  if (std::abs(a - b) > kRounding * (a + b)) return a < b ? Diagonal::from_start : Diagonal::from_end;
  const double angle = std::atan2(std::abs(ax * by - ay * bx), ax * bx + ay * by);
  if (angle > 1.5 * std::abs(step)) return Diagonal::in_turn;
  return step > 0 ? Diagonal::from_end : Diagonal::from_start;
}

}  // namespace

TriangleMesh extruded(const CrossSection& section, double height, double turn, int layers) {
  TriangleMesh mesh;
  const auto count = static_cast<std::int32_t>(section.points.size());
  for (int layer = 0; layer <= layers; ++layer) {
    const double share = static_cast<double>(layer) / layers, angle = turn * (share - 0.5);
    const double c = turn == 0 ? 1 : std::cos(angle), s = turn == 0 ? 0 : std::sin(angle);
    for (const auto& [x, y] : section.points) mesh.vertices.push_back({c * x - s * y, s * x + c * y, height * (share - 0.5)});
  }
  const std::int32_t top = count * layers;
  for (const auto& [a, b, c] : section.triangles) {
    mesh.triangles.push_back({a, c, b});
    mesh.triangles.push_back({top + a, top + b, top + c});
  }
  const double step = turn / layers;
  for (const std::vector<std::int32_t>& loop : section.loops) {
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const std::int32_t from = loop[i], to = loop[(i + 1) % loop.size()];
      const Diagonal diagonal = diagonal_of(section, from, to, step);
      for (std::int32_t layer = 0; layer < layers; ++layer) {
        const std::int32_t a = count * layer + from, b = count * layer + to;
        if (diagonal == Diagonal::from_end || (diagonal == Diagonal::in_turn && layer % 2 == 1)) {
          mesh.triangles.push_back({a, b, count + a});
          mesh.triangles.push_back({b, count + b, count + a});
        } else {
          mesh.triangles.push_back({a, b, count + b});
          mesh.triangles.push_back({a, count + b, count + a});
        }
      }
    }
  }
  return mesh;
}

}  // namespace scree
