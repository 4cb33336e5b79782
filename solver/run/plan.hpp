// What --plan prints.
#pragma once

#include <string>

#include "solver/run/loaded_scene.hpp"
#include "solver/run/measures.hpp"

namespace scree {

/// What a scene needs and what is left out and why, step size, memory of each body and pair. Collective.
/// in   simulation   started from the scene
std::string plan_text(const mpi::Communicator& comm, const LoadedScene& loaded, const Simulation& simulation);

}  // namespace scree
