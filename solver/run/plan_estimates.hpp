// What a run will cost, for --plan: its first steps are timed, and files are counted as they will be written.
#pragma once

#include <span>
#include <string>

#include "solver/run/loaded_scene.hpp"
#include "solver/step/simulation.hpp"

namespace scree {

/// Wall time, memory, disk, and what would make the run shorter. Advances the simulation by some hundred steps, for two seconds at most;
/// where most contacts are still to form and the run is long, settles a sample of the bed (bed_sample.hpp), 20 s at most. Writes nothing.
/// Collective.
/// in   simulation    started from the scene
/// in   other_ranks   on each of which the time is asked as well (plan_ranks.hpp), on one rank only
std::string estimates_text(const mpi::Communicator& comm, const LoadedScene& loaded, Simulation& simulation,
                           std::span<const int> other_ranks = {});

}  // namespace scree
