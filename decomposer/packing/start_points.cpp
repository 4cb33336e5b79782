#include "decomposer/packing/start_points.hpp"

#include <algorithm>

namespace scree {

std::vector<Vec3> start_points(const SceneParts& parts, const Scene& scene) {
  constexpr std::size_t kMax = 24;
  std::vector<Vec3> all;
  for (std::size_t i = 0; i < scene.bodies.size(); ++i)
    if (scene.bodies.fixed[i] == 0) all.push_back(scene.bodies.position[i]);
  std::vector<Vec3> some;
  const std::size_t every = std::max<std::size_t>(1, all.size() / kMax);
  for (std::size_t i = 0; i < all.size(); i += every) some.push_back(all[i]);
  for (const Region& inlet : parts.inlets) some.push_back(0.5 * (inlet.box.lower + inlet.box.upper));
  return some;
}

}  // namespace scree
