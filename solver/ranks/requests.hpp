// What the world outside asks of a run while it steps: to stop, by a signal to any rank, and to keep a checkpoint. All ranks hear of it
// at the same step, with what they exchange anyhow.
#pragma once

#include <cstdint>

#include "solver/ranks/agreement.hpp"

namespace scree {

/// Installs handlers of SIGINT, SIGTERM and SIGUSR1 that ask the run to stop after the present step.
void catch_signals();

class Requests {
 public:
  /// The largest number of a signal that any rank has seen; 0: none.
  int pending_signal() const { return signal_; }

  /// Asks all ranks, from this one, to stop by the number of a signal, as if it had been caught.
  void ask_to_stop(int signal) { stop_ = signal; }
  /// The run has stopped, on every rank, and may go on: what was asked until now counts no more.
  void stopped();

  /// A checkpoint that one rank's clock asks for: rank 0 asks, and within two steps all ranks hear it at the same step. Whoever
  /// writes one, for whatever reason, calls checkpoint_written() on every rank.
  void ask_for_checkpoint() { asked_ = written_ + 1; }
  bool is_checkpoint_asked() const { return heard_ > written_; }
  void checkpoint_written() { ++written_; }

  /// Whether a signal was caught that has not been heard of yet.
  bool is_signal_caught() const;
  /// Fills in what this rank asks.
  void fill(StepReport& mine) const;
  /// Takes in what all ranks ask.
  void hear(const StepReport& all);

 private:
  int signal_ = 0, stop_ = 0;
  int deaf_steps_ = 0;                                // in which signals are those that have been followed: ranks may agree a step ahead
  std::int64_t asked_ = 0, heard_ = 0, written_ = 0;  // numbers of checkpoints: a request for one that is written by now asks for nothing
};

}  // namespace scree
