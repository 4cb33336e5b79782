#include "solver/run/plan_ranks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/base/progress.hpp"
#include "core/partition/part_counts.hpp"
#include "core/partition/partition.hpp"

namespace scree {

namespace {

constexpr double kGhostOverBody = 0.17;  // processor time, measured
constexpr double kLatency = 2e-6;        // [s], assumed
constexpr double kBandwidth = 1e9;       // [bytes/s] of a rank, assumed

double largest(const std::vector<double>& values) { return *std::max_element(values.begin(), values.end()); }

}  // namespace

StepOnRanks step_on_ranks(const BodiesToCut& bodies, double body, int ranks) {
  const std::size_t count = bodies.x.size();
  Partitioner partitioner(MPI_COMM_SELF, ranks);
  partitioner.cut(bodies.id, bodies.x, bodies.work);
  std::vector<int> part(count);
  for (std::size_t i = 0; i < count; ++i) part[i] = partitioner.part_of(bodies.id[i], bodies.x[i]);
  const PartCounts counts = count_parts(part, bodies.x, bodies.reach, bodies.work, ranks);

  StepOnRanks step;
  step.ranks = ranks;
  step.bodies_mean = static_cast<double>(count) / ranks;
  step.bodies_max = largest(counts.bodies);
  step.ghosts_max = largest(counts.ghosts);
  step.neighbours_max = largest(counts.neighbours);
  step.imbalance = imbalance(counts.work);
  const double own = step.bodies_mean * step.imbalance * body, ghosts = step.ghosts_max * kGhostOverBody * body;
  const double messages =
      ranks > 1 ? (step.neighbours_max + std::log2(static_cast<double>(ranks))) * kLatency + largest(counts.sent) / kBandwidth : 0;
  step.seconds = own + ghosts + messages;
  step.efficiency = step.bodies_mean * body / step.seconds;
  step.of_ghosts = ghosts / step.seconds;
  step.of_messages = messages / step.seconds;
  return step;
}

std::string step_text(double seconds) {
  constexpr double kMicroseconds = 1e-3;
  return seconds < kMicroseconds ? fmt::format("{:.3g} us", 1e6 * seconds)
         : seconds < 1           ? fmt::format("{:.3g} ms", 1e3 * seconds)
                                 : fmt::format("{:.3g} s", seconds);
}

std::string text_of(const StepOnRanks& step, double steps, double spread, const std::string& memory) {
  const double all = step.seconds * steps;
  const std::string range =
      spread > 1 ? fmt::format(" ({} to {})", format_duration(all / spread), format_duration(all * spread)) : std::string();
  return fmt::format(
      "  {:<13} about {}{} on {} cores of this kind: {} a step, efficiency {:.2f} (ghosts take {:.2f} of a step, messages {:.2f}); "
      "about {} for each\n"
      "  {:<13} parts of {:.0f} bodies (at most {:.0f}), {:.0f} ghosts and {:.0f} neighbours at most, imbalance {:.3f}\n",
      fmt::format("{} ranks", step.ranks), format_duration(all), range, step.ranks, step_text(step.seconds), step.efficiency,
      step.of_ghosts, step.of_messages, memory, "", step.bodies_mean, step.bodies_max, step.ghosts_max, step.neighbours_max,
      step.imbalance);
}

}  // namespace scree
