// The steps of a run with a folder, and what is written of them when it is due. Every function is collective.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "core/base/progress.hpp"
#include "solver/run/guard.hpp"
#include "solver/run/loaded_scene.hpp"
#include "solver/run/outcome.hpp"
#include "solver/run/rest_watch.hpp"
#include "solver/run/run_options.hpp"
#include "solver/run/thread_choice.hpp"
#include "solver/run/watchdog.hpp"
#include "solver/run/writers.hpp"

namespace scree {

/// What made the files of a run, from what.
nlohmann::json provenance_of_run(const mpi::Communicator& comm, const RunOptions& options, const LoadedScene& loaded,
                                 const std::string& checkpoint_path);

class RunSteps {
 public:
  static constexpr std::int64_t kAsMany = std::int64_t{1} << 40;

  /// in   checkpoint_path   that the simulation was started from, or ""
  /// in   before            the record of the parts of this run before this one
  /// What it is given must outlive it.
  RunSteps(const mpi::Communicator& comm, const RunOptions& options, const LoadedScene& loaded, Watchdog& watchdog, Simulation& simulation,
           const std::string& checkpoint_path, const RunRecord& before);

  /// The first row and frame of a run from its scene.
  void begin();
  /// Whether its time is over, all is at rest where it stops then, or no body is left that is free to move.
  bool is_over() const;
  /// One step, or as many as go at once before something is written, `most` at most. Returns 0; or 128 + n after signal n: a checkpoint is
  /// kept, and the run may go on. Throws RunInvalid after the last state was kept, and what files and MPI throw.
  int step(std::int64_t most = kAsMany);
  /// The outcome of a run that is over.
  void finish();
  bool nothing_came() const;
  /// The same of one that ends here: it can be continued.
  void leave();
  /// The same of one that an error ended which is not of the simulation: the state means nothing, the last checkpoint does.
  void abandon(const std::string& reason);

 private:
  void announce() const;
  int advance(std::int64_t most);
  void check_for_end();
  void ask_for_checkpoint_by_clock();
  void write_row();
  LogRow take_row();
  void write_frame();
  void save_state();
  int stop_by_signal();
  void keep_invalid_state(const Error& error);
  RunRecord record_so_far() const;
  DeepTotals deep_of_all() const;
  void write_outcome(const Outcome& outcome);
  void show_progress();
  template <class Action>
  void timed_output(Action&& action);
  template <class Action>
  void keep_if_invalid(Action&& action);

  bool is_root() const { return comm_.rank() == 0; }
  bool talks() const { return is_root() && !options_.is_quiet; }
  double kinetic_energy() const { return guard_.record().energies.translational + guard_.record().energies.rotational; }

  const mpi::Communicator& comm_;
  const RunOptions& options_;
  const LoadedScene& loaded_;
  Watchdog& watchdog_;
  Simulation& simulation_;
  bool is_restart_;
  RunRecord before_;
  RestWatch rest_;
  bool deep_is_told_ = false;  // the first contacts deeper than their maximum overlap
  bool is_empty_ = false;      // only where the run ends then: no body is left that is free to move
  std::string end_of_effect_;  // why an effect ends the run; empty: none does
  Schedule schedule_;
  Writers writers_;
  Guard guard_;
  std::int64_t first_step_;  // of this part of the run, from a restart on
  std::int64_t row_step_;    // of the last row
  double body_steps_ = 0;    // of this part of the run: bodies may come and go
  std::chrono::steady_clock::time_point start_, row_time_, checkpoint_time_;
  CoreWatch cores_;                     // of the steps, without what is written
  std::unique_ptr<Progress> progress_;  // rank 0 of a run that talks
};

}  // namespace scree
