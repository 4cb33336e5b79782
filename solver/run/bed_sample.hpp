// What a body costs in a bed, before there is one: some bodies of the scene fall into a bed of their own and are timed there.
//
// A plan times the first steps of a run, when most bodies still fall or have not come in yet. A body in a bed costs up to twenty times as
// much, by its shape, triangles, law and neighbours. The sample has the shapes, sizes, materials, law and step of the scene, in a periodic
// box with a floor, and so measures all of them together, on the machine that is to run the scene. Times and contacts are those of its
// lower two thirds: the top of a small sample is a large part of it.
#pragma once

#include <cstdint>
#include <optional>

#include "solver/scene/solver_scene.hpp"

namespace scree {

struct BedSample {
  std::int64_t bodies = 0;
  double falling = 0;   ///< processor time of a body and step before any contact [s]
  double resting = 0;   ///< the same at the end, when the bed is at rest or nearly so [s]
  double contacts = 0;  ///< of a body at the end
  double memory = 0;    ///< of the pairs and their candidates, for each body [bytes]
  double seconds = 0;   ///< processor time that the sample took
};

/// Settles a sample of the moving bodies of a scene and of those that its inlets bring.
/// in   step     of the run [s]
/// in   budget   processor time after which it is given up [s]
/// out  none where there is no gravity or no body to take, where the run itself could not go on so, or where the budget was too small
/// Cost: bodies times steps of the fall, by the first estimate half the budget at most.   Threads: one.   Ranks: each for itself, no
/// messages. Limits: walls other than a floor are left out; bodies lie as they fell, no wall stirs them; no bonds. Where sizes differ by
/// more than three times, the bed is lower than wide.
std::optional<BedSample> settle_sample(const SolverScene& scene, double step, double budget);

}  // namespace scree
