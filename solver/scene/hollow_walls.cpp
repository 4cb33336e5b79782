#include "solver/scene/hollow_walls.hpp"

#include <algorithm>
#include <utility>

namespace scree {

double hollow_factor(const Scene& scene, const MaterialPair& pair, const BodyExtremes& extremes) {
  double factor = 1;
  for (const Wall& wall : scene.walls) {
    if (wall.kind != WallKind::sphere_inside) continue;
    for (const auto& [of_wall, other] : {std::pair{pair.a, pair.b}, std::pair{pair.b, pair.a}}) {
      if (wall.material != of_wall) continue;
      const double a = extremes.radius[static_cast<std::size_t>(other)];
      if (a < wall.radius) factor = std::max(factor, wall.radius / (wall.radius - a));
    }
  }
  return factor;
}

}  // namespace scree
