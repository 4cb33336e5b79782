// The shortest way on which a body leaves another one, or a wall, that it is too close to.
#pragma once

#include <vector>

#include "core/placing/placed_body.hpp"

namespace scree {

/// A gap to be reached [m]: what is closer than `least` goes until it is `reached` away. The second lies above the first by
/// more than places are rounded, so that what has gone its way is not found too close again.
struct GapWanted {
  double least = 0, reached = 0;
};

/// Finds ways out. Keeps scratch memory: one per thread.
class Separation {
 public:
  Separation() : scratch_(make_mesh_distance_scratch()) {}

  /// Way of `a` away from `b`, zero when they are apart.
  ///
  /// How: two spheres along the line of centres; what is too close by less than margins, and balls whose centre is outside, along the
  /// common normal at the nearest points, so that several faces part a body one after the other; what overlaps further in the direction
  /// with the shortest way, of the line of centres, the axes of both bodies and those of the world, found by marching and bisection with
  /// exact distances.   Cost: one distance, or for overlaps of meshes about 1000.
  Vec3 from_body(const PlacedBody& a, const PlacedBody& b, const GapWanted& gap);

  /// Way of a body to the particles' side of a wall, zero when the wall allows the body where it is.
  ///
  /// How: straight away from each face of an analytic wall that is too close, as far as the deepest vertex needs; from meshes
  /// as from bodies.
  Vec3 from_wall(const Wall& wall, const PlacedBody* mesh, bool is_solid, const PlacedBody& body, const GapWanted& gap);

 private:
  Vec3 from_analytic_wall(const Wall& wall, const PlacedBody& body, const GapWanted& gap);
  Vec3 common_normal(const PlacedBody& a, const PlacedBody& b, double reach);

  MeshDistanceScratchPtr scratch_;
  std::vector<Vec3> vertices_;
};

}  // namespace scree
