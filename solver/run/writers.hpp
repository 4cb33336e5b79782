// What a run writes into its folder while it goes on: tables, frames, checkpoints.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "core/base/json_record.hpp"
#include "solver/run/checkpoint.hpp"
#include "solver/run/loaded_scene.hpp"
#include "solver/run/rank_log.hpp"
#include "solver/run/run_log.hpp"
#include "solver/run/run_options.hpp"
#include "solver/run/schedule.hpp"

namespace scree {

/// Every function is collective and throws SystemError on every rank when the disk refuses.
class Writers {
 public:
  /// Opens the folder. A restart keeps what was written up to its step, and the rest is made again.
  /// in   provenance   of the frames and checkpoints
  Writers(const mpi::Communicator& comm, const RunOptions& options, const LoadedScene& loaded, const Schedule& schedule,
          const nlohmann::json& provenance, const Simulation& simulation, bool is_restart);

  /// A row of log.csv, and of ranks.csv when it is due or `is_last`.
  /// in   before   of the parts of this run before this one: log.csv counts from the start of the run, ranks.csv from the last restart
  void write_row(const LogRow& row, const RunRecord& before, bool is_last);
  /// What happened since the last call: changes of the step, bodies that came in or were taken out.
  void write_events(Simulation& simulation);
  /// in   number      in the name of the frame
  /// in   with_contacts   whether it has them, where the case asks for them
  void write_frame(Simulation& simulation, std::int64_t number, bool with_contacts);
  void write_checkpoint(const Simulation& simulation, const RunRecord& record);

  const nlohmann::json& provenance() const { return provenance_; }
  std::string log_path() const { return folder_ + "/log.csv"; }

 private:
  void start_tables(const LogRow& header, std::int64_t keep_up_to_step);

  const mpi::Communicator& comm_;
  const LoadedScene& loaded_;
  std::string folder_;
  JsonRecord provenance_;
  bool has_program_, has_steps_, has_removed_, has_inserted_;
  std::vector<std::string> tables_;  // paths; rank 0
  RankLog rank_log_;
  std::vector<FrameEntry> frames_;  // rank 0
};

}  // namespace scree
