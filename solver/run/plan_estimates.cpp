#include "solver/run/plan_estimates.hpp"

#include <fmt/format.h>
#include <omp.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fstream>
#include <vector>

#include "core/base/progress.hpp"
#include "core/base/units.hpp"
#include "core/storage/frame_file.hpp"
#include "solver/run/measures.hpp"
#include "solver/run/thread_choice.hpp"

namespace scree {

namespace {

// What files take beside their rows, of runs of 40 to 10 000 bodies: descriptions of the columns and the provenance.
constexpr double kFrameOverhead = 19e3, kCheckpointOverhead = 60e3, kLogRow = 450;
constexpr double kCheckpointBody = 470, kCheckpointSpring = 60;
constexpr double kRowsPerFrame = 10;  // of log.csv, see make_schedule
/// Contacts a body has in a heap at rest: 4 to 6 neighbours, each shared by two; some corners and edges of meshes for each.
constexpr double kContactsAtRest = 2.4;

/// The first steps of the run.
struct Pace {
  std::int64_t steps = 0;
  double seconds = 0;  ///< of them
  std::int64_t contacts = 0;
  double slowdown = 1;  ///< see CoreWatch
  double per_step() const { return steps > 0 ? seconds / static_cast<double>(steps) : 0; }
};

Pace pace_of(const mpi::Communicator& comm, Simulation& simulation, std::int64_t whole_run) {
  using Clock = std::chrono::steady_clock;
  constexpr std::int64_t kWarmUp = 20, kMaxSteps = 400, kBetweenLooks = 20;
  constexpr double kMaxSeconds = 2;
  Pace pace;
  const auto run = [&](std::int64_t steps) {
    for (std::int64_t n = 0; n < steps; ++n) simulation.advance();
    simulation.agree_on_failures();
  };
  const std::int64_t warm_up = std::min(kWarmUp, whole_run / 2), most = std::min(kMaxSteps, whole_run - warm_up);
  run(warm_up);
  const Clock::time_point begin = Clock::now();
  CoreWatch cores;
  while (pace.steps < most && pace.seconds < kMaxSeconds) {
    const std::int64_t steps = std::min(kBetweenLooks, most - pace.steps);
    run(steps);
    pace.steps += steps;
    pace.seconds = comm.max(std::chrono::duration<double>(Clock::now() - begin).count());
  }
  cores.take_in();
  if (cores.seconds() > kWorthWatching) pace.slowdown = cores.slowdown();
  pace.contacts = contact_count(simulation.state());
  return pace;
}

/// Resident memory of this process [bytes].
double resident() {
  std::ifstream file("/proc/self/statm");
  double all = 0, pages = 0;
  file >> all >> pages;
  return pages * static_cast<double>(sysconf(_SC_PAGESIZE));
}

std::string bytes_text(double bytes) {
  if (bytes < 1e6) return fmt::format("{:.0f} kB", bytes / 1e3);
  return bytes < 1e9 ? fmt::format("{:.1f} MB", bytes / 1e6) : fmt::format("{:.1f} GB", bytes / 1e9);
}

class Estimates {
 public:
  Estimates(const mpi::Communicator& comm, const LoadedScene& loaded, const Simulation& simulation)
      : comm_(comm), scene_(loaded.scene), settings_(loaded.scene.settings), step_(simulation.state().clock.size) {
    const BodyTable& bodies = scene_.bodies;
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      if (!bodies.fixed[b]) masses_.push_back(scene_.mass(b));
    }
    std::sort(masses_.begin(), masses_.end());
    steps_ = step_.step > 0 ? static_cast<std::int64_t>(std::ceil(settings_.duration / step_.step)) : 0;
  }
  std::int64_t steps() const { return steps_; }

  std::string text(const Pace& pace, double memory) {
    if (pace.steps > 0) add_time(pace);
    line("memory in all", fmt::format("{} now{}", bytes_text(memory), comm_.size() > 1 ? ", of all ranks together" : ""));
    add_disk(pace);
    add_help();
    return text_;
  }

 private:
  void line(const std::string& what, const std::string& value) { text_ += fmt::format("  {:<13} {}\n", what, value); }

  /// Contacts of a heap of all bodies, where gravity may make one.
  double contacts_at_rest() const { return length(settings_.gravity) > 0 ? kContactsAtRest * static_cast<double>(masses_.size()) : 0; }

  void add_time(const Pace& pace) {
    const double all = pace.per_step() * static_cast<double>(steps_);
    line("wall time", fmt::format("about {} at the pace of {} steps that were just made ({:.3g} us a step, {} contacts)",
                                  format_duration(all), pace.steps, 1e6 * pace.per_step(), pace.contacts));
    if (contacts_at_rest() > 2 * static_cast<double>(pace.contacts))
      line("",
           fmt::format("a heap of all bodies has about {:.0f} contacts, and steps take several times as long then", contacts_at_rest()));
    if (pace.slowdown > kSlowedDown) line("", slowdown_text(pace.slowdown));
    add_cores();
  }

  /// What more or fewer cores would bring, of the bodies that there are; of an inlet more come.
  void add_cores() {
    const int cores = omp_get_num_procs(), used = comm_.size() * omp_get_max_threads();
    const int busy = worthwhile_threads(scene_, 1);
    if (std::min(cores, busy) > used)
      line("", fmt::format("{} of {} cores are used: OMP_NUM_THREADS, or mpirun -n{}", used, cores,
                           busy < cores ? fmt::format(", up to {} for these bodies", busy) : ""));
    if (used > 1 && used > busy && scene_.inlets.empty())
      line("", fmt::format("{} cores are used, so few bodies keep {} busy: OMP_NUM_THREADS={} and no mpirun", used, busy, busy));
  }

  void add_disk(const Pace& pace) {
    const double frames = settings_.output_every > 0 ? std::floor(settings_.duration / settings_.output_every) + 1 : 101;
    const double bodies = static_cast<double>(scene_.bodies.size());
    const double bare = kFrameOverhead + static_cast<double>(frame_rows_bytes(static_cast<std::int64_t>(bodies), 0));
    const double at_rest = settings_.output_contacts ? std::max(static_cast<double>(pace.contacts), contacts_at_rest()) : 0;
    const double full = bare + static_cast<double>(frame_rows_bytes(0, static_cast<std::int64_t>(at_rest)));
    // what falls comes to rest after about the time of the longest fall, and contacts form one after the other until then
    const double g = length(settings_.gravity), fall = g > 0 && pace.contacts < at_rest / 2 ? settings_.impact_speed / g : 0;
    const double share = settings_.duration > 0 ? 1 - std::min(1.0, fall / (2 * settings_.duration)) : 1;
    const double walls = static_cast<double>(scene_.walls.size());
    const double log = frames * kRowsPerFrame * (kLogRow + 200 * walls);
    const double checkpoint = kCheckpointOverhead + kCheckpointBody * bodies + kCheckpointSpring * at_rest;
    line("disk", fmt::format("about {}: {:.0f} frames of {}{}, log {}, a checkpoint {}",
                             bytes_text(frames * (bare + share * (full - bare)) + log + checkpoint), frames, bytes_text(bare),
                             full > bare ? fmt::format(" ({} once {:.0f} contacts have formed)", bytes_text(full), at_rest) : "",
                             bytes_text(log), bytes_text(checkpoint)));
    if (full > 1.5 * bare) line("", fmt::format("output.contacts = false makes frames {:.1f} times smaller", full / bare));
  }

  /// What makes the run shorter, with what it costs.
  void add_help() {
    if (step_.given || !(step_.contact_time > 0) || masses_.empty()) return;
    if (step_.limited_by.find(" on ") == std::string::npos) {
      line("would help", fmt::format("the step is limited by {}, not by a contact", step_.limited_by));
      return;
    }
    if (settings_.law == ContactLaw::hertz_mindlin) {
      line("would help", "a tenth of Young's modulus: 2.5 times fewer steps, overlaps 2.5 times as deep");
    } else if (settings_.gather != Gathering::area) {
      double softest = 1e300;
      for (const MaterialPair& p : scene_.pairs) softest = std::min(softest, p.stiffness);
      std::string cost;
      if (!by_size() && settings_.margin > 0 && settings_.impact_speed > 0 && softest < 1e300) {
        const double overlap = settings_.impact_speed * std::sqrt(2 * masses_.back() / softest), share = overlap / (2 * settings_.margin);
        constexpr double kMax = 0.8;  // beyond, pack warns
        cost = share <= kMax
                   ? fmt::format("; the fastest impact then takes {:.2f} of the margins", share)
                   : fmt::format("; margins of {} then, for the fastest impact", format_quantity(overlap / 1.6, Dimension::length));
      }
      line("would help", fmt::format("half the {} of all pairs: 1.41 times fewer steps", by_size() ? "modulus" : "stiffness") + cost);
    }
    add_help_of_sizes();
  }

  /// The lightest bodies set the step: what leaving out some of them would bring.
  void add_help_of_sizes() {
    constexpr double kMaxMass = 0.05, kWorthTelling = 1.3;
    double all = 0, out = 0, best = 1, best_out = 0;
    for (const double m : masses_) all += m;
    std::size_t best_count = 0;
    for (std::size_t n = 0; n + 1 < masses_.size(); ++n) {
      out += masses_[n];
      if (out > kMaxMass * all) break;
      const double left = static_cast<double>(masses_.size() - n - 1) / static_cast<double>(masses_.size());
      const double gain = std::pow(masses_[n + 1] / masses_[0], by_size() ? 1.0 / 3 : 0.5) / left;  // a step goes with R, or R^(3/2)
      if (gain > best) {
        best = gain;
        best_count = n + 1;
        best_out = out;
      }
    }
    if (best < kWorthTelling) return;
    line("", fmt::format("leaving out the {} lightest bodies, below {} ({:.2g} % of the mass): about {:.1f} times faster", best_count,
                         format_quantity(masses_[best_count], Dimension::mass), 100 * best_out / all, best));
  }

  /// Whether the stiffness of some pair goes with size.
  bool by_size() const {
    return std::any_of(scene_.pairs.begin(), scene_.pairs.end(), [](const MaterialPair& p) { return p.modulus > 0; });
  }

  const mpi::Communicator& comm_;
  const Scene& scene_;
  const Settings& settings_;
  const StepSize step_;
  std::vector<double> masses_;  ///< of the bodies that move, ascending [kg]
  std::int64_t steps_ = 0;
  std::string text_;
};

}  // namespace

std::string estimates_text(const mpi::Communicator& comm, const LoadedScene& loaded, Simulation& simulation) {
  Estimates estimates(comm, loaded, simulation);
  Pace pace;
  try {
    pace = pace_of(comm, simulation, estimates.steps());
  } catch (const RunInvalid& reason) {  // on all ranks
    return fmt::format("  wall time     none: the run ends in its first steps; {}\n", reason.what());
  }
  const double memory = comm.sum(resident());
  return estimates.text(pace, memory);
}

}  // namespace scree
