#include "solver/run/start.hpp"

#include <algorithm>
#include <cstdio>

#include "core/base/progress.hpp"
#include "solver/step_size/step_size.hpp"

namespace scree {

namespace {

bool continues_newest(const RunOptions& options) { return options.restart == "latest" || options.restart == "auto"; }

/// Whether there is a checkpoint to continue from.
bool is_restart(const mpi::Communicator& comm, const RunOptions& options) {
  if (options.restart != "auto") return !options.restart.empty();
  int found = 0;
  mpi::on_root(comm, [&] { found = list_checkpoints(options.run_folder).empty() ? 0 : 1; });
  MPI_Bcast(&found, 1, MPI_INT, 0, comm.get());
  return found != 0;
}

void check_scene(const mpi::Communicator& comm, const RunOptions& options, const LoadedScene& loaded, const RunStart& start) {
  mpi::on_root(comm, [&] {
    if (start.checkpoint && start.checkpoint->scene_sha256 != loaded.sha256) {
      throw InputError(
          "{}: was made from another scene than {}; give the scene it came from, or begin a new run from it with [start] in the case",
          options.words().restart(start.checkpoint->path), options.scene_path);
    }
    const std::int64_t cut_for = loaded.scene.partition.ranks;
    if (cut_for > 0 && cut_for != comm.size()) {
      warn_once("scree-solver", fmt::format("the scene is cut for {} ranks, this run has {}: it is cut again", cut_for, comm.size()));
    }
    for (const std::string& gap : loaded.prepared->seam_gaps()) warn_once("scree-solver", gap);
  });
}

}  // namespace

RunStart find_start(const mpi::Communicator& comm, const RunOptions& options, const LoadedScene& loaded) {
  RunStart start;
  std::int64_t complete = -1;
  mpi::on_root(comm, [&] {
    const auto look = [&] {
      check_run_folder(options.run_folder, options.scene_path, loaded.sha256, options.restart, options.words());
      if (!options.restart.empty()) complete = completed_at(options.run_folder).value_or(-1);
    };
    look();
    if (continues_newest(options) && complete >= 0) return;
    start.lock = std::make_unique<FolderLock>(options.run_folder, options.words());
    look();  // the solver that had the lock before may have gone on since
    if (options.restart == "latest" && list_checkpoints(options.run_folder).empty())
      throw no_checkpoint(options.run_folder, options.words());
  });
  MPI_Bcast(&complete, 1, MPI_INT64_T, 0, comm.get());
  start.is_complete = continues_newest(options) && complete >= 0;
  if (!start.is_complete) {
    if (is_restart(comm, options)) {
      start.checkpoint = continues_newest(options) ? read_latest_checkpoint(comm, options.run_folder, options.words())
                                                   : read_checkpoint(comm, options.restart);
    }
    check_scene(comm, options, loaded, start);
    start.is_complete = start.checkpoint && start.checkpoint->step == complete;
  }
  if (start.is_complete && comm.rank() == 0 && !options.is_quiet) {
    std::fprintf(
        stderr,
        "scree-solver: %s: complete at step %lld; nothing is left to do, and nothing was changed; to go on for longer, make a case with "
        "[start] run = \"%s\"\n",
        options.run_folder.c_str(), static_cast<long long>(complete), options.run_folder.c_str());
  }
  return start;
}

void check_step_size(const mpi::Communicator& comm, const RunOptions& options, const Settings& settings, const StepSize& step) {
  constexpr double kMaxSteps = 0x1p53;  // counted exactly everywhere
  mpi::on_root(comm, [&] {
    if (settings.duration / step.step >= kMaxSteps) {
      throw InputError("{}: {:g} s in steps of {:.3g} s ({}) are more steps than can be counted; check density, stiffness and sizes",
                       options.scene_path, settings.duration, step.step, step.limited_by);
    }
    if (step.given && step.crossing > 0 && step.step > step.crossing) {
      warn_once(
          "scree-solver",
          fmt::format("time.step = {:g} s: bodies go {:.2g} times too far in a step to follow an attraction through its range; use at most "
                      "{:.3g} s, or leave it out",
                      step.step, step.step / step.crossing, step.crossing));
    }
    const double unevenness = step.slowest_contact_time / std::max(step.contact_time, step.step);
    if (unevenness > kUnevenContacts) {
      warn_once("scree-solver",
                fmt::format("{} sets the step, and the contact of the heaviest body lasts {:.0f} times as long: a mass ratio that "
                            "costs as many times the steps; a softer pair or a larger light body makes the run shorter",
                            step.limited_by, unevenness));
    }
  });
}

}  // namespace scree
