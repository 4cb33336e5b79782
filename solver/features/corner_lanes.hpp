// Corners of many pairs of meshes against triangles at once, one in each lane of a vector.
//
// Lanes find the nearest point of each triangle; which of a corner's triangles is the nearest, the pair finds for itself
// (mesh_features.cpp), since every corner has another number of them. The bits are those of nearest_on_triangle() on every instruction
// set: the same operations in the same order, none fused, only those that IEEE 754 rounds exactly.
#pragma once

#include <array>
#include <cstddef>

#include "core/geometry/vec3.hpp"

namespace scree {

/// Corners that are taken at once: a multiple of the lanes of every vector.
inline constexpr std::size_t kCornersAtOnce = 192;

/// Numbers of a corner and triangle each, apart by coordinate.
struct CornerVectors {
  using Numbers = std::array<double, kCornersAtOnce>;
  alignas(64) Numbers x, y, z;
  void set(std::size_t k, const Vec3& v) {
    x[k] = v.x;
    y[k] = v.y;
    z[k] = v.z;
  }
  Vec3 at(std::size_t k) const { return {x[k], y[k], z[k]}; }
};

/// Corners and the triangles that they are looked at against, in the frame and scale of the triangles.
struct CornerQueue {
  std::size_t count = 0;
  CornerVectors p, a, b, c;

  void add(const Vec3& of_p, const Vec3& of_a, const Vec3& of_b, const Vec3& of_c) {
    p.set(count, of_p);
    a.set(count, of_a);
    b.set(count, of_b);
    c.set(count, of_c);
    ++count;
  }
};

struct CornerAnswers {
  CornerVectors nearest;                     ///< point of the triangle
  alignas(64) CornerVectors::Numbers place;  ///< of this point on the triangle, as in NearestOnTriangle
  alignas(64) CornerVectors::Numbers squared, distance;
};

/// Fills up to the lanes of a vector what is beyond queue.count.
void examine_vertices_at_once(CornerQueue& queue, CornerAnswers& answers);

}  // namespace scree
