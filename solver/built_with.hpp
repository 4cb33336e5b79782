// What is compiled into the solver. Everything is, but in the study builds of tests/benchmarks/leave_out: each of them leaves out
// one feature, to show that a scene without need of it gets the same bits from both builds and pays nothing for its presence.
#pragma once

namespace scree::built_with {

#ifdef SCREE_WITHOUT_FRICTION
inline constexpr bool kFriction = false;
#else
inline constexpr bool kFriction = true;  ///< friction springs and rolling resistance
#endif
#ifdef SCREE_WITHOUT_ROTATION
inline constexpr bool kRotation = false;
#else
inline constexpr bool kRotation = true;  ///< kick and rotor of angular momentum
#endif
#ifdef SCREE_WITHOUT_RANKS
inline constexpr bool kRanks = false;
#else
inline constexpr bool kRanks = true;     ///< migration, ghosts, refresh, agreement
#endif
#ifdef SCREE_WITHOUT_MESHES
inline constexpr bool kMeshes = false;
#else
inline constexpr bool kMeshes = true;    ///< every shape but analytic spheres, and mesh walls
#endif

}  // namespace scree::built_with
