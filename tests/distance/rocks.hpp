// Meshes for the tests and benchmarks: concave rocks from a noisy icosphere.
#pragma once

#include <map>
#include <utility>

#include "core/geometry/triangle_mesh.hpp"
#include "tests/distance/triangle_pairs.hpp"

namespace scree {

/// Icosphere of radius 1 with 20 * 4^levels triangles, each vertex moved radially by normal noise.
inline TriangleMesh make_rock(int levels, std::uint64_t seed, double noise) {
  const double g = (1 + std::sqrt(5.0)) / 2;
  TriangleMesh mesh;
  mesh.vertices = {{-1, g, 0}, {1, g, 0}, {-1, -g, 0}, {1, -g, 0}, {0, -1, g}, {0, 1, g},
                   {0, -1, -g}, {0, 1, -g}, {g, 0, -1}, {g, 0, 1}, {-g, 0, -1}, {-g, 0, 1}};
  mesh.triangles = {{0, 11, 5}, {0, 5, 1}, {0, 1, 7}, {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                    {11, 10, 2}, {10, 7, 6}, {7, 1, 8}, {3, 9, 4}, {3, 4, 2}, {3, 2, 6}, {3, 6, 8},
                    {3, 8, 9}, {4, 9, 5}, {2, 4, 11}, {6, 2, 10}, {8, 6, 7}, {9, 8, 1}};
  for (Vec3& v : mesh.vertices) v = normalised(v);
  for (int level = 0; level < levels; ++level) {
    std::map<std::pair<std::int32_t, std::int32_t>, std::int32_t> middles;
    std::vector<Triangle> finer;
    const auto middle = [&](std::int32_t a, std::int32_t b) {
      const std::pair<std::int32_t, std::int32_t> key = std::minmax(a, b);
      const auto [it, is_new] = middles.try_emplace(key, mesh.vertex_count());
      if (is_new)
        mesh.vertices.push_back(normalised(mesh.vertices[static_cast<std::size_t>(a)] + mesh.vertices[static_cast<std::size_t>(b)]));
      return it->second;
    };
    for (const Triangle& t : mesh.triangles) {
      const std::int32_t a = middle(t[0], t[1]), b = middle(t[1], t[2]), c = middle(t[2], t[0]);
      finer.push_back({t[0], a, c});
      finer.push_back({t[1], b, a});
      finer.push_back({t[2], c, b});
      finer.push_back({a, b, c});
    }
    mesh.triangles = finer;
  }
  Random random(seed);
  for (Vec3& v : mesh.vertices) v *= 1 + noise * random.normal();
  return mesh;
}

}  // namespace scree
