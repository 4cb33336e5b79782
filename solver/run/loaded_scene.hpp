// A scene as every rank holds it.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "core/storage/start_state.hpp"
#include "solver/ranks/mpi_session.hpp"
#include "solver/scene/solver_scene.hpp"

namespace scree {

struct LoadedScene {
  Scene scene;
  std::optional<StartState> start;  ///< of bodies that come from a run
  std::string path, sha256;
  std::unique_ptr<SolverScene> prepared;
  Vec3 origin;  ///< of the scene as it is computed, in the world [m], see origin.hpp
};

/// Reads and checks; each rank reads for itself. Collective.
/// Fails: throws InputError on every rank, reported once, when one of them cannot read it or finds another file of this name.
LoadedScene load_scene(const mpi::Communicator& comm, const std::string& path);

}  // namespace scree
