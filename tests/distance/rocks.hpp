// Meshes for the tests and benchmarks: concave rocks from a noisy icosphere.
#pragma once

#include "core/geometry/triangle_mesh.hpp"
#include "tests/distance/triangle_pairs.hpp"
#include "tests/support/shapes.hpp"

namespace scree {

/// Icosphere of radius 1 with 20 * 4^levels triangles, each vertex moved radially by normal noise.
inline TriangleMesh make_rock(int levels, std::uint64_t seed, double noise) {
  TriangleMesh mesh = test::icosphere(levels);
  Random random(seed);
  for (Vec3& v : mesh.vertices) v *= 1 + noise * random.normal();
  return mesh;
}

}  // namespace scree
