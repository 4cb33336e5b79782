#include "solver/run/writers.hpp"

#include <nlohmann/json.hpp>

#include "core/storage/frame_file.hpp"
#include "solver/run/make_frame.hpp"
#include "solver/run/run_folder.hpp"

namespace scree {

namespace {

template <class Rows, class ColumnsOf>
std::string rows_of(const Rows& rows, ColumnsOf&& columns_of) {
  std::string text;
  for (const auto& row : rows) text += row_of(columns_of(row));
  return text;
}

/// Measures as log.csv has them: since the start of the run. An earlier part counts with the mean of its ranks, which may have been
/// others.
std::vector<RankMeasures> since_start(std::vector<RankMeasures> ranks, const RunRecord& before) {
  for (RankMeasures& m : ranks) {
    for (std::size_t p = 0; p < m.times.size(); ++p) m.times[p] += before.phases[p];
  }
  if (!ranks.empty()) ranks[0].bytes += before.bytes_sent;
  return ranks;
}

}  // namespace

Writers::Writers(const mpi::Communicator& comm, const RunOptions& options, const LoadedScene& loaded, const Schedule& schedule,
                 const nlohmann::json& provenance, const Simulation& simulation, bool is_restart)
    : comm_(comm), loaded_(loaded), folder_(options.run_folder), provenance_(provenance), rank_log_(comm.size()) {
  const Settings& settings = loaded.scene.settings;
  has_steps_ = settings.step_control == StepControl::quantised;
  has_program_ = options.has_program;
  has_removed_ = can_remove(loaded.scene) || has_program_;
  has_inserted_ = !loaded.scene.inlets.empty() || has_program_;
  const std::int64_t keep_up_to_step = is_restart ? simulation.step() : -1;
  LogRow header;
  header.has_program = has_program_;
  header.of_effects = columns_of_effects(simulation.state(), header.energies);
  mpi::on_root(comm_, [&] {
    open_run_folder(folder_, loaded_.path);
    frames_ = trim_run_folder(folder_, {schedule.frame, schedule.last, simulation.state().clock.size.step}, keep_up_to_step);
    start_tables(header, keep_up_to_step);
  });
}

void Writers::start_tables(const LogRow& header, std::int64_t keep_up_to_step) {
  const auto start = [&](const std::string& path, const std::vector<Column>& columns) {
    start_table(path, header_of(columns), keep_up_to_step);
    tables_.push_back(path);
  };
  start(log_path(), log_columns(loaded_.scene, header));
  start(folder_ + "/ranks.csv", rank_columns(0, 0, {}));
  if (has_steps_) start(folder_ + "/steps.csv", step_columns({}));
  InsertedBody no_body{};
  RemovedBody none_left{};
  no_body.inlet = no_body.shape = none_left.outlet = -1;
  if (has_inserted_) start(folder_ + "/inserted.csv", inserted_columns(loaded_.scene, no_body, has_program_));
  if (has_removed_) start(folder_ + "/removed.csv", removed_columns(loaded_.scene, none_left, has_program_));
}

void Writers::write_row(const LogRow& row, const RunRecord& before, bool is_last) {
  mpi::on_root(comm_, [&] {
    LogRow whole = row;
    whole.ranks = since_start(row.ranks, before);
    append_to_table(log_path(), row_of(log_columns(loaded_.scene, whole)));
    const std::string ranks = rank_log_.rows(row.step, row.ranks, is_last);
    if (!ranks.empty()) append_to_table(folder_ + "/ranks.csv", ranks);
  });
}

void Writers::write_events(Simulation& simulation) {
  if (has_steps_) {
    const std::vector<StepChange> changes = simulation.levels().take_changes();
    mpi::on_root(comm_, [&] { append_to_table(folder_ + "/steps.csv", rows_of(changes, step_columns)); });
  }
  if (has_inserted_) {
    std::vector<InsertedBody> bodies = simulation.take_inserted();
    for (InsertedBody& b : bodies) b.x += loaded_.origin;
    mpi::on_root(comm_, [&] {
      append_to_table(folder_ + "/inserted.csv",
                      rows_of(bodies, [&](const InsertedBody& b) { return inserted_columns(loaded_.scene, b, has_program_); }));
    });
  }
  if (!has_removed_) return;
  std::vector<RemovedBody> bodies = simulation.domain().take_removed(simulation.state().comm);
  for (RemovedBody& b : bodies) b.x += loaded_.origin;
  mpi::on_root(comm_, [&] {
    append_to_table(folder_ + "/removed.csv",
                    rows_of(bodies, [&](const RemovedBody& b) { return removed_columns(loaded_.scene, b, has_program_); }));
  });
}

void Writers::write_frame(Simulation& simulation, std::int64_t number, bool with_contacts) {
  const std::string path = folder_ + "/" + frame_name(number);
  Frame frame = make_frame(simulation, energies_of(simulation.state()), comm_.rank(),
                           with_contacts && loaded_.scene.settings.output_contacts, loaded_.origin);
  frame.number = number;
  frame.provenance = provenance_;
  mpi::on_all(comm_, [&] { write_frame_file(comm_.get(), path, frame); });
  mpi::on_root(comm_, [&] {
    std::erase_if(frames_, [&](const FrameEntry& entry) { return entry.path == path; });  // a run that became invalid after its last frame
    frames_.push_back({path, simulation.time()});
    write_frame_series(folder_, frames_);
  });
}

void Writers::write_checkpoint(const Simulation& simulation, const RunRecord& record) {
  // a restart keeps the rows up to its step: they must be on the disk before the checkpoint counts; frames are when they have their names
  mpi::on_root(comm_, [&] {
    for (const std::string& table : tables_) sync_table(table);
  });
  Checkpoint so_far;
  so_far.record = record;
  so_far.origin = loaded_.origin;
  so_far.scene_sha256 = loaded_.sha256;
  scree::write_checkpoint(comm_, simulation, folder_, so_far, provenance_);
}

}  // namespace scree
