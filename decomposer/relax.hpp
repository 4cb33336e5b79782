// Parts bodies that overlap at the start, where the case asks for it (contact.relax = true).
#pragma once

#include "decomposer/build_scene.hpp"
#include "decomposer/scene_parts.hpp"

namespace scree {

/// What relax_given_bodies did.
struct Relaxation {
  std::int64_t moved = 0;        ///< bodies
  double furthest = 0;           ///< of one body [m]
  double potential_change = 0;   ///< of all of them in gravity [J]: the only energy that parting can change
  int sweeps = 0;
};

/// Share of the smaller body's radius that a pair may be moved apart by in one sweep: what is packed densely then spreads
/// instead of being shot through its neighbours.
inline constexpr double kRelaxShare = 0.1;
/// Sweeps after which bodies count as having no room: each could have gone 20 radii by then.
inline constexpr int kMostSweeps = 200;

/// Moves the bodies of [[bodies]] until no two are closer than two margins and none is closer to a wall.
///
/// How: sweeps over all pairs in the order of the case. A pair that is too close is moved apart along the direction with the
/// shortest way out: of the line of centres, the axes of both bodies and those of the world, found by marching and bisection
/// with exact distances. Both are moved in inverse proportion to their masses, so their common centre of mass stays; fixed
/// bodies and walls stay, velocities and orientations are kept. Nothing is stored in contacts and no kinetic energy is made.
/// in   gap   to be reached [m], > 0
/// Throws InputError naming two bodies, or a body and a wall, when kMostSweeps do not suffice.
/// Cost: a pair that overlaps takes about 1000 distances a sweep. Meant for hundreds of bodies.
Relaxation relax_given_bodies(Case& c, const SceneParts& parts, const Scene& scene, double gap);

}  // namespace scree
