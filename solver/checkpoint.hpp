// checkpoint_000000123456.h5: the exact state of a run; a restart from it continues bit for bit, on any number of
// ranks and threads. The page of the format is CHECKPOINT_FORMAT.md.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "solver/simulation.hpp"

namespace scree {

inline constexpr const char* kCheckpointFormat = "scree-checkpoint";
inline constexpr std::int64_t kCheckpointFormatVersion = 3;

struct Checkpoint {
  std::string path;
  std::int64_t step = 0;
  double step_size = 0, energy_reference = 0;                      ///< [s]; balance at the start [J]
  double kinetic_peak = 0, max_depth_ratio = 0, energy_error = 0;  ///< worst so far, for the outcome
  RunTotals totals;                                                ///< of all ranks
  std::string state_hash, scene_sha256;
  std::vector<ParticleRecord> bodies;   ///< this rank's share, ascending id
  std::vector<PendingSprings> springs;  ///< of every pair with one of these bodies, ascending
};

/// Whether the share of this rank holds a body.
inline bool in_share(const mpi::Communicator& comm, std::int64_t id) { return id % comm.size() == comm.rank(); }

/// Writes the state, each rank its own bodies and springs; whole or not at all; keeps the last two. Collective.
/// `so_far` gives what the run keeps besides the state: references, worst values, hash of the scene.
/// Fails: throws SystemError on every rank when the disk refuses; the checkpoints before it are as they were.
void write_checkpoint(const mpi::Communicator& comm, const Simulation& simulation, const std::string& folder,
                      const Checkpoint& so_far, const nlohmann::json& provenance);

/// Checks every bit, then reads; a rank gets a share by id and no more. Collective.
/// Fails: throws InputError on every rank when it is missing, truncated, damaged or of another kind.
Checkpoint read_checkpoint(const mpi::Communicator& comm, const std::string& path);

/// The newest checkpoint of a run folder that is whole; damaged ones are told in a warning and passed over. Collective.
/// Fails: throws InputError on every rank when there is none.
Checkpoint read_latest_checkpoint(const mpi::Communicator& comm, const std::string& folder);

/// The present state as read_checkpoint() would give it; what the run keeps besides is left empty. Collective.
Checkpoint present_state(const mpi::Communicator& comm, const Simulation& simulation);

/// Starts from a checkpoint and checks its state hash. Collective. Throws InputError on every rank.
void start_from_checkpoint(const mpi::Communicator& comm, Simulation& simulation, Checkpoint checkpoint);

}  // namespace scree
