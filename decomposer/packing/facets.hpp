// Facets of mesh walls that stand for a curved surface: how much stiffer a ball is where it lies on two of them at once.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace scree {

struct Scene;
struct SceneParts;

/// Concave edges between nearly parallel facets of one wall.
struct Facets {
  std::string wall;
  std::int64_t edges = 0;  ///< concave towards the bodies, between faces whose normals differ by at most kFacetAngle
  double angle = 0;        ///< the largest between the normals of two of these faces [rad]
  double stiffer = 0;      ///< stiffness of a ball above that edge over its stiffness on one facet, less 1
};

/// Above this angle between two faces, an edge is that of two walls and not of a curved one [rad]: 30 degrees, twelve facets a circle.
inline constexpr double kFacetAngle = 0.5235987755982988;

/// Stiffness of a ball that touches two faces equally, over its stiffness on one, less 1: 0 where the faces are one contact, 0.19 where
/// they are two. The law of docs/reference/contact-law.md section 3.7 with g = R: y = 2 R tan^2(angle / 2) / eta, eta = R / 200, K = (1 -
/// y^2)^2 for y < 1, else 0; both weights are 1 / (1 + K), and the stiffness of weighted contacts is that of one times their sum to the
/// power 1/4. in   angle   between the normals [rad], in [0, pi)
double stiffness_of_two_facets(double angle);

/// One entry for each mesh wall with such edges, where balls move; nothing is paid where none does.   Cost: O(T log T) a wall.
std::vector<Facets> facets_of_walls(const SceneParts& parts, const Scene& scene);

}  // namespace scree
