// scree-solver: read the command, read the scene, run.
#include <omp.h>
#include <sched.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>

#include "core/base/command_line.hpp"
#include "core/base/error.hpp"
#include "core/base/interruption.hpp"
#include "core/distance/triangle_distance.hpp"
#include "core/storage/h5_crash.hpp"
#include "solver/run/job_script.hpp"
#include "solver/run/loaded_scene.hpp"
#include "solver/run/plan.hpp"
#include "solver/run/plan_estimates.hpp"
#include "solver/run/thread_choice.hpp"
#include "solver/run/verify.hpp"

namespace {

/// Cores that this process may run on: mpirun binds each of one or two ranks to one core, and all threads of a rank with it.
int cores_of_process() {
  cpu_set_t cores;
  CPU_ZERO(&cores);
  return sched_getaffinity(0, sizeof cores, &cores) == 0 ? CPU_COUNT(&cores) : omp_get_max_threads();
}

/// Tells of threads that were asked for and that have no core of their own, where the machine has more cores than they may use.
void warn_of_bound_threads(const scree::mpi::Communicator& comm) {
  const int cores = cores_of_process(), threads = omp_get_max_threads();
  if (comm.rank() != 0 || threads <= cores || cores >= sysconf(_SC_NPROCESSORS_ONLN)) return;
  scree::warn_once(
      "scree-solver",
      fmt::format("{} threads of a rank share {} of the machine's cores, to which they are bound; start with mpirun --bind-to none, or "
                  "--map-by slot:PE={} --bind-to core",
                  threads, cores == 1 ? "one" : std::to_string(cores), threads));
}

/// Whether the user says how many threads there are to be.
bool threads_are_given() { return std::getenv("OMP_NUM_THREADS") != nullptr; }

/// Waiting threads must give their core away, or a step takes up to a thousand times longer: to each other where there are more of them
/// than cores on this machine, or than this process may use, at once (4 minutes instead of 1 s were measured on 2 cores with 2 ranks x 2
/// threads); else soon, for other processes may want the cores, without a word to this one (60 blocks: 9 s to 3 minutes instead of 1 s).
/// The OpenMP runtime reads how it waits when it is loaded, so the program starts itself once more.
void share_cores(char** argv) {
  const char* local_ranks = std::getenv("OMPI_COMM_WORLD_LOCAL_SIZE");
  const long ranks = local_ranks != nullptr ? std::atol(local_ranks) : 1;
  const bool enough = ranks * omp_get_max_threads() <= sysconf(_SC_NPROCESSORS_ONLN) && omp_get_max_threads() <= cores_of_process();
  constexpr const char* kSpins = "2000";  // of GNU's OpenMP: some 30 us, as long as a thread takes to wake
  if (std::getenv("OMP_WAIT_POLICY") != nullptr || std::getenv("GOMP_SPINCOUNT") != nullptr) return;
  if (enough && omp_get_max_threads() == 1) return;
  if (enough) {
    setenv("GOMP_SPINCOUNT", kSpins, 0);
  } else {
    setenv("OMP_WAIT_POLICY", "passive", 0);
    setenv("OMPI_MCA_mpi_yield_when_idle", "1", 0);
  }
  execv("/proc/self/exe", argv);  // returns only when it failed; then the run is slow, not wrong
}

/// What the watchdog does in its thread, while the rank itself may be stuck in a call that never returns.
void end_stalled_run(const std::string& message) {
  _exit(scree::run_main("scree-solver", [&]() -> int { throw scree::SystemError(message); }));
}

std::string run_folder_of(std::string scene_path) {
  for (const std::string ending : {".h5", ".scene"}) {
    if (scene_path.ends_with(ending)) scene_path.resize(scene_path.size() - ending.size());
  }
  return scene_path + ".run";
}

using namespace scree;

/// What the user asks for.
struct Command {
  RunOptions options;
  VerifyOptions again;
  bool goes_on = true;  ///< false: the help was all
  bool verify = false, plan = false, slurm = false;
  std::vector<int> planned_ranks;  ///< on each of which --plan is to tell the time, besides those that run it
  std::string halo = "overlap", send = "selected", cut = "rcb", simd = "best";
};

/// A plan for more tells nothing: its model has no contention in the network.
constexpr int kMostRanks = 100000;

void describe_run_options(CLI::App& app, Command& c) {
  RunOptions& o = c.options;
  app.add_option("scene", o.scene_path, "scene file made by scree-decomposer");
  app.add_option("-o,--output", o.run_folder, "run folder to make (default: the scene's name with .run)");
  app.add_flag("--plan", c.plan, "print what would be done, and stop");
  app.add_option("--ranks", c.planned_ranks, "with --plan: the time on so many ranks too, also more than this machine has: 16,64,256")
      ->delimiter(',')
      ->check(CLI::Range(1, kMostRanks));
  app.add_flag("--print-slurm", c.slurm, "print a job script for SLURM that requeues itself, and stop");
  app.add_option("--restart", o.restart, "checkpoint file; 'latest' of the run folder; or 'auto': latest, or from the start");
  add_quantity(app, "--stall-limit", o.stall_limit, Dimension::time,
               "time without a step or output after which the run ends with 4, "
               "for instance \"10 min\"; 0: never (default 30 min)");
  add_quantity(app, "--checkpoint-interval", o.checkpoint_interval, Dimension::time,
               "run time between checkpoints, for a case without output.checkpoint; 0: only at the end (default 30 min)");
  app.add_option("--halo", c.halo, "overlap | blocking: whether messages hide behind work")->check(CLI::IsMember({"overlap", "blocking"}));
  app.add_option("--send", c.send, "selected | all: what a neighbour gets, the bodies within its reach or everything")
      ->check(CLI::IsMember({"selected", "all"}));
  app.add_option("--cut", c.cut, "rcb | rib | hsfc | body: how bodies are shared out among the ranks")
      ->check(CLI::IsMember(cut_method_names()));
  app.add_option("--simd", c.simd, "best | avx512 | avx2 | sse4 | scalar");
}

/// The same command on every rank; rank 0 alone prints. Collective.
Command read_command(const mpi::Communicator& comm, int argc, char** argv) {
  Command c;
  c.options.command = command_words(argc, argv);
  c.options.stalled = end_stalled_run;
  const auto app = make_command_line("scree-solver", "Moves the bodies of a scene by the discrete element method.",
                                     {{"mpirun -n 2 scree-solver drum.scene.h5 -o drum.run", "run a scene on two ranks"},
                                      {"scree-solver drum.scene.h5 --plan", "what is computed, what is left out, memory, step"},
                                      {"mpirun -n 4 scree-solver drum.scene.h5 -o drum.run --restart latest", "continue a stopped run"},
                                      {"scree-solver drum.scene.h5 --print-slurm > drum.sh", "a job that requeues itself until the end"},
                                      {"mpirun -n 3 scree-solver verify drum.run", "the same bits again? where not?"}});
  describe_run_options(*app, c);
  CLI::App* verify = app->add_subcommand("verify", "Computes steps of a run again and says whether they are the same, or where not.");
  verify->fallthrough();
  verify->add_option("run", c.again.run_folder, "run folder")->required();
  verify->add_option("--steps", c.again.steps, "how many (default: up to the newest checkpoint)")->check(CLI::Range(1, 1000000000));
  verify->add_option("--from", c.again.from, "checkpoint, or 'start' (default: the older checkpoint that is kept)");
  mpi::on_root(comm, [&] { c.goes_on = parse_command_line(*app, argc, argv); });
  int goes_on = c.goes_on ? 1 : 0;
  MPI_Bcast(&goes_on, 1, MPI_INT, 0, comm.get());
  c.goes_on = goes_on != 0;
  if (!c.goes_on) return c;
  if (comm.rank() != 0) parse_command_line(*app, argc, argv);
  c.verify = verify->parsed();
  return c;
}

/// Refuses what the parser cannot, and fills in what follows from the options. Collective.
void complete(const mpi::Communicator& comm, Command& c) {
  RunOptions& o = c.options;
  mpi::on_root(comm, [&] {
    if (!(o.stall_limit >= 0)) throw UsageError("--stall-limit {:g}: expected a time >= 0 s", o.stall_limit);
    if (!(o.checkpoint_interval >= 0)) throw UsageError("--checkpoint-interval {:g}: expected a time >= 0 s", o.checkpoint_interval);
    if (!c.planned_ranks.empty() && (!c.plan || comm.size() > 1))
      throw UsageError("--ranks {0}: expected with --plan on one rank; to run on {0} ranks: mpirun -n {0} scree-solver ...",
                       c.planned_ranks.front());
    if (!c.verify && o.scene_path.empty()) throw UsageError("name a scene file, for instance drum.scene.h5; see scree-solver --help");
  });
  o.parallel = {c.halo == "blocking" ? HaloStrategy::blocking : HaloStrategy::overlap,
                c.send == "all" ? HaloSelection::all : HaloSelection::selected, cut_method_of(c.cut)};
  if (o.run_folder.empty()) o.run_folder = run_folder_of(o.scene_path);
  o.most_threads = threads_are_given() ? 0 : omp_get_max_threads();
  c.again.parallel = o.parallel;
  c.again.most_threads = o.most_threads;
  c.again.stall_limit = o.stall_limit;
  c.again.stalled = o.stalled;
}

int verify(const mpi::Communicator& comm, const VerifyOptions& options) {
  const Verdict verdict = verify_run(comm, options);
  if (comm.rank() == 0) std::puts(verdict.text.c_str());
  return static_cast<int>(verdict.same ? ExitCode::done : ExitCode::run_invalid);
}

/// Prints the plan of a run, or the job script for it.
int print_only(const mpi::Communicator& comm, const Command& c) {
  const LoadedScene loaded = load_scene(comm, c.options.scene_path);
  std::string text;
  if (c.slurm) {
    const int ranks = comm.size() > 1 ? comm.size() : std::max<int>(1, static_cast<int>(loaded.scene.partition.ranks));
    text = slurm_script({c.options.command[0], c.options.scene_path, c.options.run_folder, ranks, omp_get_max_threads()});
  } else {
    Simulation simulation(comm, *loaded.prepared, c.options.parallel);
    fit_threads(loaded.scene, comm.size(), c.options.most_threads);
    simulation.start_from_scene(loaded.start);
    text = plan_text(comm, loaded, simulation);
    text += estimates_text(comm, loaded, simulation, c.planned_ranks);
  }
  if (comm.rank() == 0) std::fputs(text.c_str(), stdout);
  return 0;
}

int do_command(const mpi::Communicator& comm, int argc, char** argv) {
  Command c = read_command(comm, argc, argv);
  if (!c.goes_on) return 0;
  complete(comm, c);
  limit_simd(c.simd);
  if (c.verify) return verify(comm, c.again);
  if (c.slurm || c.plan) return print_only(comm, c);
  warn_of_bound_threads(comm);
  return run_scene(comm, c.options);
}

}  // namespace

int main(int argc, char** argv) {
  h5::explain_crashes("scree-solver");
  share_cores(argv);
  listen_to_interruptions();  // until the run asks signals to end it after the present step
  const mpi::Session session(argc, argv);
  const mpi::Communicator comm;
  // A failure that all ranks agreed on ends each of them with its code; rank 0 or the failing rank reports it once.
  // Anything else would leave the others waiting: the job is stopped.
  try {
    return do_command(comm, argc, argv);
  } catch (const mpi::SilentError& e) {
    return static_cast<int>(e.code());
  } catch (const Error& e) {
    const int code = run_main("scree-solver", [&]() -> int { throw Error(e); });
    const bool agreed = dynamic_cast<const mpi::AgreedError*>(&e) != nullptr || comm.size() == 1;
    if (!agreed || e.code() == ExitCode::internal) MPI_Abort(MPI_COMM_WORLD, code);
    return code;
  } catch (...) {
    const int code = run_main("scree-solver", []() -> int { throw; });
    MPI_Abort(MPI_COMM_WORLD, code);
    return code;
  }
}
