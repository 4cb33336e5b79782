// How many threads a rank takes where the user names no number, and how much of the time it waits for them and for a core.
#pragma once

#include <algorithm>
#include <chrono>
#include <string>

#include "solver/step/simulation.hpp"

namespace scree {

/// Bodies that keep a thread busy: a step starts the threads some ten times, for 5 us each time, and a body with a mesh takes 5 us of a
/// step in a bed at rest, a ball a tenth of that. With fewer bodies a thread costs more than it brings, and on a busy machine far more,
/// since each start waits for a core. With more, threads are left out that would help a little.
inline constexpr double kMeshesPerThread = 100, kBallsPerThread = 1000;

/// Threads that the bodies of a scene keep busy on so many ranks, at least one.
int worthwhile_threads(const Scene& scene, int ranks);

/// Takes as many threads as the bodies of this rank keep busy. The numbers of the run are the same.
/// in   most   0: leaves them as they are, for the user gave their number; else no more than this
void fit_threads(const Simulation& simulation, int most);
/// The same before bodies are made, from those of the scene, shared out evenly.
void fit_threads(const Scene& scene, int ranks, int most);

/// How often the time that the first thread computes goes into the time on the clock. On a machine to itself that is once.
class CoreWatch {
 public:
  CoreWatch();
  /// Leaves out what was done since the last call, when files were written.
  void leave_out();
  /// Takes in what was done since the last call.
  void take_in();
  /// Time on the clock so far, and over the time computed.
  double seconds() const { return clock_; }
  double slowdown() const { return clock_ / std::max(computed_, 1e-9); }
  /// Tells the user, the first time that it is so, where steps wait far longer than they compute. Nothing is wrong with them: a note.
  void report_once();

 private:
  std::chrono::steady_clock::time_point time_;
  double used_;
  double clock_ = 0, computed_ = 0;
  bool is_told_ = false;
};

/// A step that takes as many times longer than it computes is told.
inline constexpr double kSlowedDown = 10;
/// Shorter than this, what else the machine did says little [s].
inline constexpr double kWorthWatching = 1;

/// What a user is told of it.
std::string slowdown_text(double slowdown);

}  // namespace scree
