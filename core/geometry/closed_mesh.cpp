#include "core/geometry/closed_mesh.hpp"

#include <algorithm>
#include <utility>
#include <vector>

namespace scree {

bool is_closed(const TriangleMesh& mesh) {
  std::vector<std::pair<std::int32_t, std::int32_t>> forward, backward;
  for (const Triangle& t : mesh.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      forward.emplace_back(t[k], t[(k + 1) % 3]);
      backward.emplace_back(t[(k + 1) % 3], t[k]);
    }
  }
  std::sort(forward.begin(), forward.end());
  std::sort(backward.begin(), backward.end());
  return forward == backward;
}

void turn_inside_out(TriangleMesh& mesh) {
  for (Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
}

}  // namespace scree
