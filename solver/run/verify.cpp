#include "solver/run/verify.hpp"
#include "solver/effects/effects.hpp"

#include <omp.h>

#include <cmath>
#include <filesystem>
#include <map>
#include <optional>
#include <sstream>

#include "core/storage/collective_file.hpp"
#include "core/storage/frame_file.hpp"
#include "solver/run/differences.hpp"
#include "solver/run/loaded_scene.hpp"
#include "solver/run/run_folder.hpp"
#include "solver/run/table.hpp"
#include "solver/run/thread_choice.hpp"
#include "solver/run/watchdog.hpp"

namespace scree {

namespace {

/// What a run recorded of one step.
struct Record {
  std::string hash, frame, checkpoint;  ///< of the log; paths
};
using Records = std::map<std::int64_t, Record>;

/// The hashes of a log by step.
void read_log(const std::string& path, Records& records) {
  const StepTable log = read_table(path);
  if (log.names.empty()) throw InputError("{}: cannot be read; name the folder of a run", path);
  const std::size_t column = log.column("state_hash");
  if (column == log.names.size()) throw InputError("{}: has no column state_hash; it is damaged or of another kind", path);
  for (std::size_t row = 0; row < log.rows.size(); ++row) records[log.step(row)].hash = log.rows[row][column];
}

/// Rank 0's records on every rank.
void broadcast(const mpi::Communicator& comm, Records& records) {
  std::string text;
  for (const auto& [step, r] : records) text += fmt::format("{}\n{}\n{}\n{}\n", step, r.hash, r.frame, r.checkpoint);
  std::istringstream lines(broadcast_text(comm.get(), text));
  records.clear();
  for (std::string step; std::getline(lines, step);) {
    Record& r = records[std::stoll(step)];
    std::getline(lines, r.hash);
    std::getline(lines, r.frame);
    std::getline(lines, r.checkpoint);
  }
}

/// All that the folder of a run recorded, and where to begin, on every rank.
struct Recorded {
  Records records;
  std::string from;  ///< a checkpoint or "start"
};

/// Hashes and checkpoints; frames are known by their times, and come when the step size is known. Collective.
Recorded find_records(const mpi::Communicator& comm, const VerifyOptions& options) {
  Recorded recorded;
  recorded.from = options.from;
  mpi::on_root(comm, [&] {
    read_log(options.run_folder + "/log.csv", recorded.records);
    const std::vector<std::string> checkpoints = list_checkpoints(options.run_folder);
    if (recorded.from.empty()) recorded.from = checkpoints.size() > 1 ? checkpoints[checkpoints.size() - 2] : "start";
    for (const std::string& path : checkpoints) {
      recorded.records[*checkpoint_step_of(std::filesystem::path(path).filename().string())].checkpoint = path;
    }
  });
  recorded.from = broadcast_text(comm.get(), recorded.from);
  return recorded;
}

/// Starts from a checkpoint of the run, or from its scene. Collective.
void start(const mpi::Communicator& comm, const VerifyOptions& options, const LoadedScene& loaded, const std::string& from,
           Simulation& simulation) {
  if (from == "start") {
    simulation.start_from_scene(loaded.start);
    return;
  }
  Checkpoint checkpoint = read_checkpoint(comm, from);
  mpi::on_root(comm, [&] {
    if (checkpoint.scene_sha256 != loaded.sha256)
      throw InputError("{}: was made from another scene than {}/scene.h5", from, options.run_folder);
  });
  start_from_checkpoint(comm, simulation, std::move(checkpoint), loaded.origin);
}

/// Adds the frames and leaves the records that are compared, on every rank. Collective.
void choose_records(const mpi::Communicator& comm, const VerifyOptions& options, const Simulation& simulation, Recorded& recorded) {
  Records& records = recorded.records;
  const std::int64_t first = simulation.step();
  const bool from_start = recorded.from == "start";
  mpi::on_root(comm, [&] {
    for (const FrameEntry& frame : list_frames(options.run_folder)) {
      records[std::llround(frame.time / simulation.state().clock.size.step)].frame = frame.path;
    }
    std::erase_if(records, [&](const auto& entry) { return entry.first < first || (entry.first == first && !from_start); });
    std::int64_t last = first + options.steps;
    if (options.steps == 0) {
      for (const auto& [step, record] : records) {
        if (!record.checkpoint.empty() || from_start) last = step;
      }
    }
    // the state at the start alone says nothing of steps
    const auto next = records.upper_bound(first);
    const bool only_the_start = options.steps > 0 && (next == records.end() || next->first > last);
    if (records.empty() || records.begin()->first > last || only_the_start) {
      throw UsageError("{}: nothing is recorded from step {} to {}; {}", options.run_folder, first + 1, last,
                       next != records.end()
                           ? fmt::format("the next record is at step {}: use --steps {}", next->first, next->first - first)
                       : from_start ? "the run ended before its first record"
                                    : "begin earlier, with --from start");
    }
    std::erase_if(records, [&](const auto& entry) { return entry.first > last; });
  });
  broadcast(comm, records);
}

/// Compares states one after the other.
class Verifier {
 public:
  Verifier(const mpi::Communicator& comm, const LoadedScene& loaded, Simulation& simulation)
      : comm_(comm), loaded_(loaded), simulation_(simulation), first_(simulation.step()), equal_until_(first_) {}

  /// The verdict, once it is known: the state differs, and there is something that names the body. Collective.
  std::optional<Verdict> compare(std::int64_t step, const Record& record);
  /// The verdict after the last state.
  Verdict finish_features(std::int64_t last) const;

 private:
  std::string difference_from_checkpoint(const Checkpoint& now, const std::string& path);

  const mpi::Communicator& comm_;
  const LoadedScene& loaded_;
  Simulation& simulation_;
  std::int64_t hashes_ = 0, frames_ = 0, checkpoints_ = 0, first_, equal_until_, differs_at_ = -1;
};

std::string Verifier::difference_from_checkpoint(const Checkpoint& now, const std::string& path) {
  ++checkpoints_;
  const Checkpoint recorded = read_checkpoint(comm_, path);
  const std::string where = sum_up(comm_, compare_with_checkpoint(now, recorded));
  if (!where.empty()) return where;
  if (words_of(recorded.totals) != words_of(now.totals)) return "the accumulated work and impulse of walls differ";
  if (words_of(recorded.totals.outlets) != words_of(now.totals.outlets)) return "what outlets took out differs";
  if (recorded.totals.inlets != now.totals.inlets) return "the state of an inlet differs";
  for (std::size_t k = 0; k < effect_kinds().size(); ++k) {
    const EffectRecord &was = recorded.totals.effects[k], &is = now.totals.effects[k];
    if (was == is) continue;
    const EffectFormat& format = effect_kinds()[k].format;
    const std::string more = format.difference != nullptr ? format.difference(was, is) : "";
    return more.empty() ? format.differs : more;
  }
  if (words_of(recorded.totals.arrived) != words_of(now.totals.arrived)) return "what bodies brought that joined differs";
  return recorded.state_hash == now.state_hash ? "" : "the hash that the checkpoint gives differs";
}

std::optional<Verdict> Verifier::compare(std::int64_t step, const Record& record) {
  const Checkpoint now = present_state(comm_, simulation_);
  std::string where;
  if (!record.checkpoint.empty()) where = difference_from_checkpoint(now, record.checkpoint);
  if (!record.frame.empty()) {
    ++frames_;
    const std::string in_frame = sum_up(comm_, compare_with_frame(comm_, *loaded_.prepared, now, loaded_.origin, record.frame));
    if (where.empty() && !in_frame.empty()) where = fmt::format("{} (in its frame)", in_frame);
  }
  const bool hash_differs = !record.hash.empty() && record.hash != now.state_hash;
  if (!record.hash.empty()) ++hashes_;
  if (differs_at_ < 0 && (hash_differs || !where.empty())) differs_at_ = step;
  if (differs_at_ < 0) {
    equal_until_ = step;
    return std::nullopt;
  }
  if (where.empty() && record.frame.empty() && record.checkpoint.empty()) return std::nullopt;  // go on to a state that names bodies
  return Verdict{false, fmt::format("not the same: equal until step {}, different at step {}. At step {}: {}", equal_until_, differs_at_,
                                    step, where.empty() ? "bodies are the same, the state of pairs differs" : where)};
}

Verdict Verifier::finish_features(std::int64_t last) const {
  if (differs_at_ >= 0) {
    return {false, fmt::format("not the same: equal until step {}, different at step {} by the hash of the log; no frame or checkpoint "
                               "up to step {} tells the body, use a larger --steps",
                               equal_until_, differs_at_, last)};
  }
  return {true,
          fmt::format(
              "the same, bit for bit: steps {} to {} on {} ranks x {} threads; {} hashes of the log, {} frames, {} checkpoints compared",
              first_, last, comm_.size(), omp_get_max_threads(), hashes_, frames_, checkpoints_)};
}

}  // namespace

Verdict verify_run(const mpi::Communicator& comm, const VerifyOptions& options) {
  // 1. what was recorded, and where to begin
  mpi::on_root(comm, [&] {
    if (is_folder_of_program(options.run_folder))
      warn_once(
          "scree-solver",
          fmt::format("{}: a program stepped this run (the engine): forces that it gave, and walls and bodies that it moved, are in no "
                      "file, so that steps after the first of them cannot be computed again",
                      options.run_folder));
  });
  const LoadedScene loaded = load_scene(comm, options.run_folder + "/scene.h5");
  Recorded recorded = find_records(comm, options);
  Watchdog watchdog(comm, options.stall_limit, options.stalled);
  Simulation simulation(comm, *loaded.prepared, options.parallel);
  fit_threads(loaded.scene, comm.size(), options.most_threads);
  start(comm, options, loaded, recorded.from, simulation);
  choose_records(comm, options, simulation, recorded);

  // 2. the same steps again
  Verifier verifier(comm, loaded, simulation);
  for (const auto& [step, record] : recorded.records) {
    while (simulation.step() < step) {
      simulation.advance();
      watchdog.progress(simulation.step());
    }
    simulation.agree_on_failures();
    if (const std::optional<Verdict> verdict = verifier.compare(step, record)) return *verdict;
  }
  return verifier.finish_features(recorded.records.rbegin()->first);
}

}  // namespace scree
