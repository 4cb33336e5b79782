// What a run will cost, for --plan: its first steps are timed, and files are counted as they will be written.
#pragma once

#include <string>

#include "solver/run/loaded_scene.hpp"
#include "solver/step/simulation.hpp"

namespace scree {

/// Wall time, memory, disk, and what would make the run shorter. Advances the simulation by some hundred steps, for two seconds at most;
/// writes nothing. Collective.
/// in   simulation   started from the scene
std::string estimates_text(const mpi::Communicator& comm, const LoadedScene& loaded, Simulation& simulation);

}  // namespace scree
