// Poured populations: bodies placed at random in their region, dropped, and more of them on top, until all lie there.
#pragma once

#include <functional>

#include "decomposer/packing/child_solver.hpp"
#include "decomposer/packing/packing_report.hpp"
#include "decomposer/packing/placements.hpp"

namespace scree {

/// Packs all populations with method = "settle", together.
///
/// How: as many bodies as find a place at random in what is free of the region are added, and fall for as long as a fall through
/// the region takes; then the next ones. When all are in, or no more fit, they move until they rest (solver/run/rest_watch.hpp).
/// What then does not lie wholly in its region is taken out with `fill`; a population of a given amount is refused. Walls stand still,
/// other bodies are held. Gravity, contact laws and margins are those of the case, so that a poured bed is one of the materials given.
/// Where contacts are much stiffer than pouring needs, the bed is softer until it nearly rests (softness.hpp), then made stiff by stages,
/// and its last rest is with the contacts and the step of the case. Throws InputError when the region is full before all bodies are in (not
/// for `fill`), when nothing falls, or with the solver's words when a stage fails; says what was reached.
void settle_populations(const Case& c, const SceneParts& parts, const Scene& scene, const ChildSolver& solver, Placements& placements,
                        PackingReport& report);

}  // namespace scree
