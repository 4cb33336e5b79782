#include "solver/run/plan_pace.hpp"

#include <algorithm>
#include <chrono>

#include "solver/phases.hpp"
#include "solver/run/measures.hpp"
#include "solver/run/thread_choice.hpp"

namespace scree {

Pace pace_of(const mpi::Communicator& comm, Simulation& simulation, std::int64_t whole_run) {
  using Clock = std::chrono::steady_clock;
  constexpr std::int64_t kWarmUp = 20, kMaxSteps = 400, kBetweenLooks = 20;
  constexpr double kMaxSeconds = 2;
  Pace pace;
  const auto run = [&](std::int64_t steps) {
    for (const std::int64_t end = simulation.step() + steps; simulation.step() < end;) simulation.advance(end);
    simulation.agree_on_failures();
  };
  const std::int64_t warm_up = std::min(kWarmUp, whole_run / 2), most = std::min(kMaxSteps, whole_run - warm_up);
  run(warm_up);
  const Clock::time_point begin = Clock::now();
  const double used_before = thread_seconds();
  CoreWatch cores;
  double passed = 0;
  while (pace.steps < most && passed < kMaxSeconds) {
    const std::int64_t steps = std::min(kBetweenLooks, most - pace.steps);
    run(steps);
    pace.steps += steps;
    passed = comm.max(std::chrono::duration<double>(Clock::now() - begin).count());
  }
  pace.seconds = comm.max(thread_seconds() - used_before);
  cores.take_in();
  if (cores.seconds() > kWorthWatching) pace.slowdown = cores.slowdown();
  pace.contacts = contact_count(simulation.state());
  return pace;
}

}  // namespace scree
