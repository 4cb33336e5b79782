// Dense populations: bodies placed small, which grow and push each other apart until they have their size.
#pragma once

#include <functional>

#include "decomposer/packing/child_solver.hpp"
#include "decomposer/packing/packing_report.hpp"
#include "decomposer/packing/placements.hpp"

namespace scree {

/// Packs one population with method = "compact" to the solid fraction that its bodies make in its region.
///
/// How: at random at a scale at which that is easy; then, stage by stage, all bodies grow by a small share and the solver moves
/// them apart, without gravity and friction and with much damping, from rest. While bodies grow fast their margins are wide, so
/// that a stage presses two bodies at most half way through them; at the end the margins are those of the case. The sides of the
/// region are walls, those of the case too; all other bodies are held.
/// Source of the idea: B. Lubachevsky and F. Stillinger (1990), J. Stat. Phys. 60, 561, with overdamped motion (C. O'Hern et al.
/// (2003), Phys. Rev. E 68, 011306) in place of collisions. A packing that jams is let loose and pressed
/// again twice, which makes it denser (J. Knight et al. (1995), Phys. Rev. E 51, 3957, tapped theirs); then growth ends.
/// Throws InputError when it jams before all bodies have their size; says which fraction was reached.
void compact_population(const Case& c, const SceneParts& parts, const Scene& scene, std::size_t population, const ChildSolver& solver,
                        Placements& placements, PackingReport& report);

}  // namespace scree
