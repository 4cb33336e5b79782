// checkpoint_000000123456.h5: the exact state of a run; a restart from it continues bit for bit, on any number of
// ranks and threads. The page of the format is CHECKPOINT_FORMAT.md.
#pragma once

#include <algorithm>
#include <cmath>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/storage/energy_in_play.hpp"
#include "core/storage/run_files.hpp"
#include "solver/run/measures.hpp"
#include "solver/run/option_words.hpp"

namespace scree {

/// What a run has in its record (run.json, log.csv) besides its state: worst values, last values and sums since its start, over
/// all of its parts. What a killed part did after its last checkpoint is made again and counts once. Plain data.
struct RunRecord {
  double energy_reference = 0;                                                                            ///< balance at the start [J]
  double kinetic_peak = 0, elastic_peak = 0, dissipated_peak = 0, energy_error = 0;                       ///< largest of the log's rows [J]
  double max_overlap_ratio = 0;                                                                           ///< largest so far
  CriticalStep stiffest;                                                                                  ///< smallest of the log's rows
  Energies energies;                                                                                      ///< of the last row of the log
  double imbalance_sum = 0;                                                                               ///< over the rows of the log
  std::int64_t log_rows = 0, list_renewals = 0, cuts = 0, migrated = 0, bytes_sent = 0, peak_memory = 0;  ///< migrated: from rank 0
  double wall_seconds = 0;
  PhaseTimes phases{};  ///< mean over the ranks [s]
  /// What an error of the energy is measured by.
  EnergyInPlay in_play() const {
    return {kinetic_peak, elastic_peak, energies.dissipated, energies.wall_work, energies.outer_work, energies.cell_work};
  }
};

struct Checkpoint {
  std::string path;
  std::int64_t step = 0;
  double step_size = 0;         ///< [s]
  std::string step_limited_by;  ///< what the step was derived from at the start; "" in older files
  RunRecord record;             ///< of a file of version 3: only part of it, log_rows is 0
  std::optional<Vec3> origin;   ///< of the scene as it is computed, see origin.hpp; not in version 3
  RunTotals totals;             ///< of all ranks
  std::string state_hash, scene_sha256;
  std::vector<ParticleRecord> bodies;  ///< this rank's share, ascending id
  std::vector<WaitingState> states;    ///< of every pair with one of these bodies, ascending
};

/// Whether the share of this rank holds a body.
inline bool in_share(const mpi::Communicator& comm, std::int64_t id) { return id % comm.size() == comm.rank(); }

/// Writes the state, each rank its own bodies and the state of its pairs; whole or not at all; keeps the last two. Collective.
/// `so_far` gives what the run keeps besides the state: its record, origin, hash of the scene. Rank 0's record counts.
/// Fails: throws SystemError on every rank when the disk refuses; the checkpoints before it are as they were.
void write_checkpoint(const mpi::Communicator& comm, const Simulation& simulation, const std::string& folder, const Checkpoint& so_far,
                      const nlohmann::json& provenance);

/// Checks every bit, then reads; a rank gets a share by id and no more. Collective.
/// Fails: throws InputError on every rank when it is missing, truncated, damaged or of another kind.
Checkpoint read_checkpoint(const mpi::Communicator& comm, const std::string& path);

/// The error for a run folder without one.
InputError no_checkpoint(const std::string& folder, const OptionWords& words);

/// The newest checkpoint of a run folder that is whole; damaged ones are told in a warning and passed over. Collective.
/// Fails: throws InputError on every rank when there is none.
Checkpoint read_latest_checkpoint(const mpi::Communicator& comm, const std::string& folder, const OptionWords& words = {});

/// The present state as read_checkpoint() would give it; what the run keeps besides is left empty. Collective.
Checkpoint present_state(const mpi::Communicator& comm, const Simulation& simulation);

/// Starts from a checkpoint and checks its origin and state hash. Collective. Throws InputError on every rank.
void start_from_checkpoint(const mpi::Communicator& comm, Simulation& simulation, Checkpoint checkpoint, const Vec3& origin);

}  // namespace scree
