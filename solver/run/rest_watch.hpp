// Whether a scene has come to rest, for runs that end then (time.stop_at_rest).
#pragma once

#include <algorithm>
#include <map>
#include <optional>
#include <string>

#include "core/storage/scene_file.hpp"
#include "solver/bodies/fluid.hpp"

namespace scree {

/// At rest: no wall moves or will move; since that is so, and for as long as the slowest body takes to fall its own diameter, the
/// kinetic energy stayed below kRestShare of what all bodies would gain by such a fall; and no single body has kBodyShare of its own.
/// A body that nothing holds breaks the rule within that time: what rests for so long has forces that balance, to 2e-3 of the weight.
/// In a fluid: of a fall there, and no body gains more than it has at its terminal speed; one that weighs nothing there is
/// measured by a fall in a void.
/// Limits: "all bodies" are those that the scene starts with.
class RestWatch {
 public:
  static constexpr double kRestShare = 1e-6;
  static constexpr double kBodyShare = 1e-2;  ///< a body that falls has it after a hundredth of its diameter; others may hide it in the sum
  static constexpr double kLooksPerFall = 4;  ///< closer than any swing of a body in its place, which is still at its turning points

  /// Watches nothing unless the scene asks for it. Throws UsageError when it does and there is no gravity.
  explicit RestWatch(const Scene& scene);

  /// Longest time between two rows [s].
  double row_interval() const { return active_ && window_ > 0 ? window_ / kLooksPerFall : 1e300; }
  /// When the last wall comes to a stop [s]; 1e300 when one never does.
  double walls_stop() const { return walls_stop_; }

  /// A row of the log: the same on all ranks.
  void add(double time, double kinetic);
  /// Takes in the rows of log.csv, so that a restart ends where the run would have ended without it.
  void read_log(const std::string& path);
  /// The largest kinetic energy of an owned body, over what it would gain by its fall.
  double busiest(const ParticleSet& p) const;
  /// That of all ranks, at the present time, and how many bodies there are.
  void look(double busiest, std::int64_t bodies) {
    busiest_ = busiest;
    is_empty_ = bodies == 0;
  }

  /// When the energy was above the limit last [s]: ranks that read no log get it from the one that did.
  double& last_busy() { return last_busy_; }
  bool at_rest(double time) const {
    return active_ && !is_empty_ && busiest_ <= kBodyShare && time >= walls_stop_ && time - std::max(last_busy_, walls_stop_) >= window_;
  }
  bool is_active() const { return active_; }
  bool is_empty() const { return is_empty_; }

 private:
  bool active_ = false, is_empty_ = false;
  double limit_ = 0;       // [J]
  double window_ = 0;      // [s]
  double last_busy_ = 0;   // [s]
  double walls_stop_ = 0;  // [s]
  double busiest_ = 0;
  struct Fall {
    double gain, time;  // [J], [s]
  };
  Fall fall_of(const BodyKind& body) const;

  const Scene* scene_;
  double gravity_ = 0;                        // [m/s^2]
  std::optional<FluidForces> fluid_;          // of a scene that has one
  mutable std::map<BodyKind, double> gains_;  // of kinds of bodies that were looked at [J]
};

}  // namespace scree
