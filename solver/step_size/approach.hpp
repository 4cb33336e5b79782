// How fast surfaces come together as a scene starts: what the step must follow so that a first touch is seen while it is shallow.
#pragma once

#include <string>

#include "solver/scene/solver_scene.hpp"

namespace scree {

struct Approach {
  double speed = 0;  ///< at which the gap of two surfaces shrinks [m/s]; 0: nothing comes together
  std::string who;   ///< "bodies 3 and 7", "body 3 and wall 9", for the user
};

/// The fastest approach of two bodies, or of a body and a wall, that are on course for each other, if it is faster than `least`.
///
/// How: two bodies are on course when they would meet on straight paths; they approach with their relative velocity and what
/// their spins add (SolverShape::turning_arm). Of two that are near, with bounding balls and margins that overlap, only the
/// speed at which the gap shrinks counts: what rolls or slides on another approaches nothing. Walls of numbers are met in
/// closed form; before a mesh wall the centre looks ahead along its path.
/// Cost: one look at each body where nothing is fast; else pairs by falling speed, until no pair left could be faster. Past
/// kMaxPairs those left count with all their speed.
/// Ranks, restarts: follows from the scene alone.   Limits: no gravity; of a periodic domain the nearest images.
Approach fastest_approach(const SolverScene& scene, double least);

/// Pairs that are looked at, a second or less.
inline constexpr std::int64_t kMaxPairs = 5'000'000;

}  // namespace scree
