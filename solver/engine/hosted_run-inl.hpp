// What a hosted run holds: for hosted_run.cpp and hosted_state.cpp alone.
#pragma once

#include <omp.h>

#include <chrono>
#include <cstdlib>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/storage/written_by_program.hpp"
#include "solver/engine/body_fields.hpp"
#include "solver/engine/hosted_run.hpp"
#include "solver/engine/new_body_check.hpp"
#include "solver/run/run_steps.hpp"
#include "solver/run/start.hpp"

namespace scree {

struct HostedRun::Inner {
  mpi::Communicator comm;
  RunOptions options;
  int threads;
  LoadedScene loaded;  // its prepared part points into it: it stays where it is made
  RunStart start;
  std::optional<Watchdog> watchdog;
  std::optional<Simulation> simulation;
  std::optional<RunSteps> files;  // of a run with a folder
  std::function<int()> poll;
  double poll_interval = 0;
  std::chrono::steady_clock::time_point polled = std::chrono::steady_clock::now();
  std::string failed;    // what ended the run; "": it goes on
  bool is_told = false;  // the files of the run say so
  struct Force {
    int number, number_of_effect;
    GivenFunction given;
  };
  std::vector<Force> forces;
  BodyFields fields;
  std::optional<NewBodyCheck> new_body_check;  // from the first insert() on
  double reported_overlap = 0;                 // of new bodies, over the radius of the smaller one
  FrameContacts contacts;

  Inner(const std::string& scene, MPI_Comm c, const Options& o)
      : comm(c), threads(o.threads > 0 ? o.threads : omp_get_max_threads()), loaded(load_scene(comm, scene)) {
    options.scene_path = scene;
    options.run_folder = o.run_folder;
    options.restart = o.restart;
    options.command = {kEngineCommand, scene};
    options.has_program = true;
    options.is_quiet = true;
    options.stall_limit = 0;  // the program that steps may wait for as long as it likes
    options.most_threads = o.threads > 0 || std::getenv("OMP_NUM_THREADS") != nullptr ? 0 : threads;
  }

  const RunState& state() const { return simulation->state(); }
  RunState& change() { return simulation->changeable_state(); }
  void begin();
  void check_goes_on(const char* what) const;
  void check_joined(const char* what, const std::vector<std::int64_t>& mine) const;
  void check_all_or_named(const char* what, bool is_named) const;
  void check_moves(const char* what) const;
  HeatEffect& heat(const char* what);
  void check_nobody_waits(const char* what) const;
  template <class Action>
  void guarded(Action&& action);
  int some_steps(std::int64_t most);
  void look_around();
};

/// What makes the state meaningless is remembered.
template <class Action>
void HostedRun::Inner::guarded(Action&& action) {
  try {
    action();
  } catch (const std::exception& error) {
    failed = error.what();
    const auto* known = dynamic_cast<const Error*>(&error);
    is_told = known != nullptr && known->code() == ExitCode::run_invalid;
    throw;
  }
}

}  // namespace scree
