#include "mesher/repair/winding_field.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace scree {

namespace {

/// A group counts as one when it is further away than this many of its radii: 2 keeps the error near one percent.
constexpr double kFarNode = 2;
constexpr std::int32_t kLeaf = 8;

std::size_t at_index(std::int32_t i) { return static_cast<std::size_t>(i); }

}  // namespace

WindingField::WindingField(const TriangleMesh& mesh) : mesh_(mesh), order_(mesh.triangles.size()) {
  std::vector<Vec3> middle(mesh.triangles.size());
  for (std::int32_t t = 0; t < mesh.triangle_count(); ++t) {
    order_[at_index(t)] = t;
    middle[at_index(t)] = (1.0 / 3) * (mesh.corner(t, 0) + mesh.corner(t, 1) + mesh.corner(t, 2));
  }
  if (!order_.empty()) build(0, mesh.triangle_count(), middle);
}

std::int32_t WindingField::build(std::int32_t begin, std::int32_t end, std::vector<Vec3>& middle) {
  const auto index = static_cast<std::int32_t>(nodes_.size());
  nodes_.emplace_back();
  Node node;
  node.first = begin;
  node.count = end - begin;
  Box3 centres;
  double total = 0;
  for (std::int32_t i = begin; i < end; ++i) {
    const std::int32_t t = order_[at_index(i)];
    const Vec3 area = 0.5 * cross(mesh_.corner(t, 1) - mesh_.corner(t, 0), mesh_.corner(t, 2) - mesh_.corner(t, 0));
    const double size = length(area);
    node.area += area;
    node.centre += size * middle[at_index(t)];
    total += size;
    centres.add(middle[at_index(t)]);
  }
  node.centre = total > 0 ? (1 / total) * node.centre : centres.centre();
  for (std::int32_t i = begin; i < end; ++i) {
    for (int k = 0; k < 3; ++k) {
      node.radius = std::max(node.radius, length(mesh_.corner(order_[at_index(i)], k) - node.centre));
    }
  }
  if (end - begin > kLeaf) {
    const Vec3 e = centres.extent();
    const int axis = e.x >= e.y && e.x >= e.z ? 0 : (e.y >= e.z ? 1 : 2);
    const std::int32_t half = begin + (end - begin) / 2;
    std::nth_element(order_.begin() + begin, order_.begin() + half, order_.begin() + end, [&](std::int32_t s, std::int32_t t) {
      const double a = middle[at_index(s)][axis], b = middle[at_index(t)][axis];
      return a != b ? a < b : s < t;
    });
    node.count = 0;
    build(begin, half, middle);
    build(half, end, middle);
  }
  node.skip = static_cast<std::int32_t>(nodes_.size());
  nodes_[at_index(index)] = node;
  return index;
}

double WindingField::at(const Vec3& point) const {
  double angle = 0;
  for (std::int32_t n = 0; n < static_cast<std::int32_t>(nodes_.size());) {
    const Node& node = nodes_[at_index(n)];
    const Vec3 d = node.centre - point;
    const double distance = length(d);
    if (distance > kFarNode * node.radius) {
      angle += dot(node.area, d) / (distance * distance * distance);
      n = node.skip;
      continue;
    }
    for (std::int32_t i = node.first; i < node.first + node.count; ++i) {
      const std::int32_t t = order_[at_index(i)];
      const Vec3 a = mesh_.corner(t, 0) - point, b = mesh_.corner(t, 1) - point, c = mesh_.corner(t, 2) - point;
      const double la = length(a), lb = length(b), lc = length(c);
      angle += 2 * std::atan2(dot(a, cross(b, c)), la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb);
    }
    ++n;
  }
  return angle / (4 * std::numbers::pi);
}

}  // namespace scree
