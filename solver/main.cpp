// scree-solver: read the command, read the scene, run, tell the outcome.
#include <omp.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>

#include "core/base/command_line.hpp"
#include "core/distance/triangle_distance.hpp"
#include "solver/run.hpp"

namespace {

/// More threads than cores on this machine: waiting threads and ranks must give their core away instead of spinning,
/// or a step takes a thousand times longer (4 minutes instead of 1 s were measured on 2 cores with 2 ranks x 2 threads).
/// The OpenMP runtime reads its policy when it is loaded, so the program starts itself once more.
void share_cores_when_oversubscribed(char** argv) {
  const char* local_ranks = std::getenv("OMPI_COMM_WORLD_LOCAL_SIZE");
  const long ranks = local_ranks != nullptr ? std::atol(local_ranks) : 1;
  if (ranks * omp_get_max_threads() <= sysconf(_SC_NPROCESSORS_ONLN) || std::getenv("OMP_WAIT_POLICY") != nullptr) return;
  setenv("OMP_WAIT_POLICY", "passive", 0);
  setenv("OMPI_MCA_mpi_yield_when_idle", "1", 0);
  execv("/proc/self/exe", argv);  // returns only when it failed; then the run is slow, not wrong
}

}  // namespace

int main(int argc, char** argv) {
  using namespace scree;
  share_cores_when_oversubscribed(argv);
  const mpi::Session session(argc, argv);
  const mpi::Communicator comm;
  const auto body = [&]() -> int {
    // 1. the command line
    RunOptions options;
    options.command = command_words(argc, argv);
    bool plan = false;
    std::string halo = "overlap", send = "selected", cut = "rcb", simd = "best";
    const auto app = make_command_line(
        "scree-solver", "Moves the bodies of a scene by the discrete element method.",
        {{"mpirun -n 2 scree-solver drum.scene.h5 -o drum.run", "run a scene on two ranks"},
         {"scree-solver drum.scene.h5 --plan", "what is computed, what is left out, memory, step"},
         {"mpirun -n 4 scree-solver drum.scene.h5 -o drum.run --restart latest", "continue a stopped run"}});
    app->add_option("scene", options.scene_path, "scene file made by scree-decomposer")->required();
    app->add_option("-o,--output", options.run_folder, "run folder to make (default: the scene's name with .run)");
    app->add_flag("--plan", plan, "print what would be done, and stop");
    app->add_option("--restart", options.restart, "checkpoint file, or 'latest' of the run folder");
    app->add_option("--halo", halo, "overlap | blocking: whether messages hide behind work")->check(CLI::IsMember({"overlap", "blocking"}));
    app->add_option("--send", send, "selected | all: what a neighbour gets, the bodies within its reach or everything")->check(CLI::IsMember({"selected", "all"}));
    app->add_option("--cut", cut, "rcb | rib | hsfc | body: how bodies are shared out among the ranks")->check(CLI::IsMember(cut_method_names()));
    app->add_option("--simd", simd, "best | avx512 | avx2 | sse4 | scalar");
    bool go_on = false;
    mpi::on_root(comm, [&] { go_on = parse_command_line(*app, argc, argv); });
    int flag = go_on ? 1 : 0;
    MPI_Bcast(&flag, 1, MPI_INT, 0, comm.get());
    if (flag == 0) return 0;
    if (comm.rank() != 0) parse_command_line(*app, argc, argv);
    limit_simd(simd);
    options.parallel = {halo == "blocking" ? HaloStrategy::blocking : HaloStrategy::overlap,
                        send == "all" ? HaloSelection::all : HaloSelection::selected, cut_method_of(cut)};
    if (options.run_folder.empty()) {
      std::string name = options.scene_path;
      for (const char* ending : {".h5", ".scene"}) {
        if (name.ends_with(ending)) name.resize(name.size() - std::string(ending).size());
      }
      options.run_folder = name + ".run";
    }

    // 2. the plan
    if (plan) {
      Scene scene;
      mpi::on_root(comm, [&] { scene = read_scene_file(options.scene_path); });
      if (comm.rank() != 0) scene = read_scene_file(options.scene_path);
      std::unique_ptr<SolverScene> prepared;
      mpi::on_root(comm, [&] { prepared = std::make_unique<SolverScene>(scene); });
      if (!prepared) prepared = std::make_unique<SolverScene>(scene);
      Simulation simulation(comm, *prepared, options.parallel);
      simulation.start_from_scene();
      const std::string text = plan_text(comm, *prepared, simulation);
      if (comm.rank() == 0) std::fputs(text.c_str(), stdout);
      return 0;
    }

    // 3. the run
    return run_scene(comm, options);
  };
  // A failure that all ranks agreed on ends each of them with its code; rank 0 or the failing rank tells it once.
  // Anything else would leave the others waiting: the job is stopped.
  try {
    return body();
  } catch (const mpi::SilentError& e) {
    return static_cast<int>(e.code());
  } catch (const Error& e) {
    const int code = run_main("scree-solver", [&]() -> int { throw Error(e); });
    if (e.code() == ExitCode::internal) MPI_Abort(MPI_COMM_WORLD, code);
    return code;
  } catch (...) {
    const int code = run_main("scree-solver", []() -> int { throw; });
    MPI_Abort(MPI_COMM_WORLD, code);
    return code;
  }
}
