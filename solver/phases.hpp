// The phases of a step whose time is measured, and the clock of a rank's own work.
#pragma once

#include <array>
#include <chrono>
#include <cstddef>

namespace scree {

/// `sort`, `sum` and `duplicated` are what the same bits on any number of ranks and threads cost: putting pairs and their
/// sides in order, adding up in that order, and computing pairs that another rank computes and counts too.
enum class Phase : std::size_t { search, sort, contact, duplicated, sum, integrate, halo, wait, agree, migrate, output, count };
const char* phase_name(Phase phase);

/// Seconds spent in each phase by this rank. `wait` is time in which nothing but a message of a neighbour was missing.
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

/// Processor time of the calling thread [s]. Unlike the wall clock it leaves out what other programs on the same cores take,
/// so that a busy machine does not look like an imbalance.
double thread_seconds();

/// Adds the processor time of its scope, times a weight, to a sum. Weight 0: does nothing, since reading this clock is a call of
/// the system (0.6 us were measured).
class WorkTimer {
 public:
  WorkTimer(double& sum, double weight) : sum_(sum), weight_(weight), start_(weight > 0 ? thread_seconds() : 0) {}
  ~WorkTimer() {
    if (weight_ > 0) sum_ += weight_ * (thread_seconds() - start_);
  }
  WorkTimer(const WorkTimer&) = delete;
  WorkTimer& operator=(const WorkTimer&) = delete;

 private:
  double& sum_;
  double weight_, start_;
};

}  // namespace scree
