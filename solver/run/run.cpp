#include "solver/run/run.hpp"

#include "solver/ranks/requests.hpp"
#include "solver/run/run_steps.hpp"
#include "solver/run/start.hpp"
#include "solver/run/thread_choice.hpp"

namespace scree {

int run_scene(const mpi::Communicator& comm, const RunOptions& options) {
  catch_signals();
  const LoadedScene loaded = load_scene(comm, options.scene_path);

  for (const Wall& wall : loaded.scene.walls) {
    if (comm.rank() == 0 && wall.motion.drive() && wall.motion.drive()->is_outer)
      warn_once("scree-solver", fmt::format("wall '{}' has the motion 'outer' and stands still: nobody drives it here; step the scene by "
                                            "scree.Engine, or give it another motion",
                                            wall.name));
  }

  // 1. where it begins; whatever refuses this run comes before its folder is touched
  RunStart start = find_start(comm, options, loaded);
  if (start.is_complete) return 0;

  // 2. the state that it begins with
  Watchdog watchdog(comm, options.stall_limit, options.stalled);
  Simulation simulation(comm, *loaded.prepared, options.parallel);
  fit_threads(loaded.scene, comm.size(), options.most_threads);
  std::string checkpoint_path;
  RunRecord before;
  if (start.checkpoint) {
    checkpoint_path = start.checkpoint->path;
    before = start.checkpoint->record;
    start_from_checkpoint(comm, simulation, std::move(*start.checkpoint), loaded.origin);
  } else {
    simulation.start_from_scene(loaded.start);
  }
  check_step_size(comm, options, loaded.scene.settings, simulation.state().clock.size);

  // 3. the steps, and what is written of them
  RunSteps run(comm, options, loaded, watchdog, simulation, checkpoint_path, before);
  run.begin();
  while (!run.is_over()) {
    if (const int signal_code = run.step(); signal_code != 0) return signal_code;
  }
  run.finish();
  return 0;
}

}  // namespace scree
