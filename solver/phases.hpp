// The phases of a step whose time is measured.
#pragma once

#include <array>
#include <chrono>
#include <cstddef>

namespace scree {

enum class Phase : std::size_t { search, distance, integrate, halo, migrate, output, count };
const char* phase_name(Phase phase);

/// Seconds spent in each phase by this rank.
using PhaseTimes = std::array<double, static_cast<std::size_t>(Phase::count)>;

/// Adds the time of its scope to a phase.
class PhaseTimer {
 public:
  PhaseTimer(PhaseTimes& times, Phase phase) : slot_(times[static_cast<std::size_t>(phase)]), start_(Clock::now()) {}
  ~PhaseTimer() { slot_ += std::chrono::duration<double>(Clock::now() - start_).count(); }
  PhaseTimer(const PhaseTimer&) = delete;
  PhaseTimer& operator=(const PhaseTimer&) = delete;

 private:
  using Clock = std::chrono::steady_clock;
  double& slot_;
  Clock::time_point start_;
};

}  // namespace scree
