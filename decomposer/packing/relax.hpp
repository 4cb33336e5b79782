// Parts bodies of [[bodies]] that start too close: before the first step, so that nothing is thrown (contact.relax).
#pragma once

#include "decomposer/packing/packing_report.hpp"
#include "decomposer/packing/scene_parts.hpp"

namespace scree {

/// What relax_given_bodies did.
struct Relaxation {
  std::int64_t moved = 0;       ///< bodies
  double furthest = 0;          ///< of one body [m]
  double potential_change = 0;  ///< of all of them in gravity [J]: the only energy that parting can change
  int sweeps = 0;
  std::string hardest;  ///< which body was pressed hardest, and what that stored; "" when none was
};

/// Share of the smaller body's radius that a pair may be moved apart by in one sweep: what is packed densely then spreads
/// instead of being shot through its neighbours.
inline constexpr double kRelaxShare = 0.1;

/// Moves the bodies of [[bodies]] until no two are closer than two margins and none is closer to a wall, as the case asks.
///
/// shallow: refused when a body would have to go further than two margins. all: however far it is.
/// How: sweeps over the pairs that are close, each time in the order of the case; the list of them comes from a grid and lasts until a
/// body has used up its skin. A pair that is too close goes the shortest way apart (separation.hpp), both in inverse proportion to
/// their masses, so that their common centre of mass stays; fixed bodies and walls stay, velocities and orientations are kept.
/// In a cluster one way spoils another, and sweeps go on: then ways are longer than needed (kOverRelaxed), and gaps end a little wider
/// (kCrowdShare), which ends what would otherwise only converge.
/// Nothing is stored in contacts and no kinetic energy is made.
/// in   gap   to be reached [m], > 0
/// Throws InputError naming what is pressed, the energy that it stores and the speed that this is, when there is no room, or none
/// within the limit.
/// Cost: of N balls at rest on each other about 15 N distances a sweep, and hundreds of sweeps for beds of tens of layers. A pair of
/// meshes that overlap takes about 1000 distances a sweep.   Order: the same case gives the same bits.
Relaxation relax_given_bodies(Case& c, const SceneParts& parts, const Scene& scene, double gap);

}  // namespace scree
