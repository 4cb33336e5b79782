// checkpoint_000000123456.h5: the exact state of a run; a restart from it continues bit for bit, on any number of
// ranks. The page of the format is CHECKPOINT_FORMAT.md.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "solver/simulation.hpp"

namespace scree {

inline constexpr const char* kCheckpointFormat = "scree-checkpoint";
inline constexpr std::int64_t kCheckpointFormatVersion = 1;

struct Checkpoint {
  std::int64_t step = 0;
  double step_size = 0, wall_work = 0, wall_dissipated = 0, energy_reference = 0;  ///< energy_reference: balance at the start [J]
  double kinetic_peak = 0, max_depth_ratio = 0, energy_error = 0;  ///< worst so far, for the outcome
  std::string state_hash, scene_sha256;
  std::vector<ParticleRecord> bodies;          ///< of all ranks, ascending id
  std::vector<PendingSprings> springs;         ///< ascending key
  std::vector<Vec3> wall_impulse;
};

/// Gathers the state on rank 0, which writes the file whole or not at all; keeps the last two. Collective.
/// `so_far` gives what the run keeps besides the state: references, worst values, hash of the scene.
void write_checkpoint(const mpi::Communicator& comm, const Simulation& simulation, const std::string& folder,
                      const Checkpoint& so_far, const nlohmann::json& provenance);

/// Serial. Throws InputError when damaged or of another kind.
Checkpoint read_checkpoint(const std::string& path);

/// Newest checkpoint of a run folder, or "".
std::string latest_checkpoint(const std::string& folder);

}  // namespace scree
