// Walls that wear: at whole steps counted from the start of the run, their vertices recede until the mesh has lost `wear` times the
// sliding work since the last time (Archard). Source: J. F. Archard, Contact and rubbing of flat surfaces, J. Appl. Phys. 24 (1953) 981.
//
// The work is an exact sum over all ranks, so that all ranks move the same vertices to the same places. Between two steps nothing else
// changes: pairs with the wall keep their friction springs, each with the feature that now is where its own was, since corners, edges and
// flat regions of a worn mesh have other numbers; and what their contacts store less than before counts as dissipated.
// Cost: of a wall that is worn, its tree and features anew; a look at each of its pairs. Nothing in the steps between.
#pragma once

#include "solver/pairs/forces.hpp"
#include "solver/ranks/failure.hpp"
#include "solver/step/run_state.hpp"

namespace scree {

/// Of the margin of a body: by more than this no vertex recedes at a time. What touches a wall would lose its contact and fall onto it, and
/// a run would depend on the interval; a tenth keeps the forces of a contact at rest within some tenths.
inline constexpr double kMostWear = 0.1;

/// In how many steps a wall is worn.
std::int64_t wear_steps(const Wall& wall, double step);

/// Whether one is due after the present whole step.
bool wear_is_due(const RunState& s);

/// Wears the walls that are due. Candidates of pairs are forgotten; new lists are left to the caller. Collective; a mesh that cannot be
/// worn so is kept in `failure` on every rank.
void wear_walls(RunState& s, ForceScratch& scratch, FirstFailure& failure);

/// Gives the scene the vertices that the state has: at the start and after a restart.
void place_worn_vertices(const RunState& s);

/// Volume that a wall has lost so far [m^3], and how far its farthest vertex has receded [m].
struct WornAway {
  double volume = 0, depth = 0;
};
WornAway worn_away(const RunState& s, std::size_t wall);

}  // namespace scree
