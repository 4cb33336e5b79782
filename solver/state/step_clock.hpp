// The step of a run and where it stands in time.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <string>

namespace scree {

/// How long a step is, and why (step_size/step_size.hpp).
struct StepSize {
  double step = 0;                  ///< [s]
  double contact_time = 0;          ///< half period of the limiting contact [s]; 0: no contact can occur
  double slowest_contact_time = 0;  ///< half period of the most sluggish body's contact [s]; 0: no contact can occur
  std::string limited_by;           ///< "body 17 (rock) on fixed steel", for the user
  bool given = false;               ///< taken from the case
  double crossing = 0;              ///< longest that follows the attraction of all pairs through its range [s]; 0: none attract
  /// Step above which the limiting contact is unstable, damping left out [s]: 2 / omega.
  double critical() const { return contact_time * 2 / 3.14159265358979323846; }
};

/// The longest step that is stable for an effect, and the reason, for the user.
struct StepBound {
  double step = std::numeric_limits<double>::infinity();  ///< [s]
  std::string reason;
};

/// Where a run stands in time. A step is made in 2^level equal parts; the level is 0 but for quantised steps.
struct StepClock {
  StepSize size;
  std::int64_t step = 0;  ///< whole steps since the start
  std::int64_t level = 0;
  std::int64_t substep = 0;  ///< parts of the present step that are done
  double dt = 0;             ///< what the bodies move by at once [s]: size.step / 2^level

  double time() const { return static_cast<double>(step) * size.step + static_cast<double>(substep) * dt; }
  void set_level(std::int64_t to) {
    level = to;
    dt = std::ldexp(size.step, -static_cast<int>(to));
  }
  void advance() {
    if (++substep < std::int64_t{1} << level) return;
    substep = 0;
    ++step;
  }
};

}  // namespace scree
