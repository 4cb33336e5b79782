// Whether a scene has come to rest, for runs that end then (time.stop_at_rest).
#pragma once

#include <string>

#include "core/storage/scene_file.hpp"

namespace scree {

/// At rest: the kinetic energy stayed below kRestShare of what all bodies would gain by falling their own diameter, for as
/// long as the slowest of them takes to fall so far; drag left out but for this: no body gains more than it has at its terminal speed. A body that nothing holds breaks the rule within that time.
class RestWatch {
 public:
  static constexpr double kRestShare = 1e-6;

  /// Watches nothing unless the scene asks for it. Throws UsageError when it does and there is no gravity.
  explicit RestWatch(const Scene& scene);

  /// A row of the log: the same on all ranks.
  void add(double time, double kinetic);
  /// Takes in the rows of log.csv, so that a restart ends where the run would have ended without it.
  void read_log(const std::string& path);

  /// When the energy was above the limit last [s]: ranks that read no log get it from the one that did.
  double& last_busy() { return last_busy_; }
  bool at_rest(double time) const { return active_ && time - last_busy_ >= window_; }

 private:
  bool active_ = false;
  double limit_ = 0;       // [J]
  double window_ = 0;      // [s]
  double last_busy_ = 0;   // [s]
};

}  // namespace scree
