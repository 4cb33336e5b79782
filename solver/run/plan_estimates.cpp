#include "solver/run/plan_estimates.hpp"

#include <fmt/format.h>
#include <omp.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <vector>

#include "core/base/progress.hpp"
#include "core/base/units.hpp"
#include "core/storage/frame_file.hpp"
#include "solver/run/bed_sample.hpp"
#include "solver/run/inflow.hpp"
#include "solver/run/plan_memory.hpp"
#include "solver/run/plan_pace.hpp"
#include "solver/run/plan_ranks.hpp"
#include "solver/run/thread_choice.hpp"

namespace scree {

namespace {

// What files take beside their rows, of runs of 40 to 10 000 bodies: descriptions of the columns and the provenance.
constexpr double kFrameOverhead = 19e3, kCheckpointOverhead = 60e3, kLogRow = 450;
constexpr double kCheckpointBody = 470, kCheckpointSpring = 60;
/// Load maps: datasets of a frame, and a triangle there (compressed, most of them seldom hit) and in a checkpoint.
constexpr double kLoadOverhead = 20e3, kLoadInFrame = 20, kLoadInCheckpoint = 575;
constexpr double kRowsPerFrame = 10;  // of log.csv, see make_schedule
/// Contacts a body has in a heap at rest: 4 to 6 neighbours, each shared by two; some corners and edges of meshes for each.
constexpr double kContactsAtRest = 2.4;
/// The same of bodies that walls press together, where meshes touch at several places.
constexpr double kContactsPressed = 6;

/// Processor time of a body and step in a bed [s], balls and meshes, about, before a sample tells (see kMeshesPerThread).
constexpr double kBallInBed = 0.2e-6, kMeshInBed = 2.5e-6;
/// How far off an estimate may be: walls, what they record and what stirs the bed are not in the sample, and a large bed fits no cache.
/// From the runs of tests/benchmarks/plan, those with outlets apart.
constexpr double kSpread = 2.5;

BodiesToCut bodies_to_cut(Simulation& simulation) {
  const RunState& s = simulation.state();
  BodiesToCut bodies;
  for (std::size_t i = 0; i < s.particles.owned; ++i) {
    bodies.id.push_back(s.particles.id[i]);
    bodies.x.push_back(s.particles.x[i]);
    bodies.reach.push_back(s.particles.radius[i] + s.scene.contact_range() + 0.5 * simulation.lists().skin());
    bodies.work.push_back(std::max(s.particles.work[i], 1e-12));  // not measured yet: as good as none
  }
  return bodies;
}

/// The numbers of a plan, and their text.
class Estimates {
 public:
  Estimates(const mpi::Communicator& comm, const LoadedScene& loaded, const Simulation& simulation)
      : comm_(comm), scene_(loaded.scene), settings_(loaded.scene.settings), step_(simulation.state().clock.size) {
    const BodyTable& bodies = scene_.bodies;
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      if (!bodies.fixed[b]) masses_.push_back(scene_.mass(b));
    }
    std::sort(masses_.begin(), masses_.end());
    for (const Inlet& inlet : scene_.inlets) mean_masses_.push_back(mean_mass(scene_, inlet));
    std::error_code ignored;  // a scene that cannot be looked at was not read
    scene_bytes_ = static_cast<double>(std::filesystem::file_size(loaded.path, ignored));
    steps_ = step_.step > 0 ? static_cast<std::int64_t>(std::ceil(settings_.duration / step_.step)) : 0;
  }
  std::int64_t steps() const { return steps_; }

  /// Whether most contacts are still to form, in a run that is long enough for a sample to be worth its time.
  bool needs_sample(const Pace& pace) const {
    constexpr double kLongRun = 20;  // [s]
    return pace.steps > 0 && contacts_are_to_form(pace) && length(settings_.gravity) > 0 && guess() > kLongRun;
  }
  /// Processor time of a body and step, the mean over the run [s].
  double time_of_body(const Pace& pace) const {
    const double steps = static_cast<double>(std::max<std::int64_t>(steps_, 1));
    const double all = bed_ ? time_as_bed(pace, bed_->resting) : time_without_sample(pace);
    return all / steps / std::max(1.0, bodies_at(0));
  }
  /// The lines on so many ranks, after text().
  std::string on_ranks(const Pace& pace, const BodiesToCut& bodies, int ranks) const {
    if (bodies.x.size() < static_cast<std::size_t>(ranks))
      return fmt::format("  {:<13} more than the {} bodies of the scene at its start: no estimate\n", fmt::format("{} ranks", ranks),
                         bodies.x.size());
    const StepOnRanks step = step_on_ranks(bodies, time_of_body(pace), ranks);
    const double spread = bed_ || contacts_are_to_form(pace) ? kSpread : 1;
    return text_of(step, static_cast<double>(steps_), spread, bytes_text(memory_of_rank(most_memory_, step)));
  }
  /// Processor time that a sample may take [s]: a tenth of what the run may take, and no more than a user waits for.
  double sample_budget() const { return std::clamp(0.1 * guess(), 5.0, 20.0); }
  void take(const std::optional<BedSample>& bed) {
    bed_ = bed;
    is_asked_ = true;
  }

  std::string text(const Pace& pace, const MemoryNow& memory) {
    if (pace.steps > 0) add_time(pace);
    const double bodies = static_cast<double>(scene_.bodies.size() - masses_.size()) + bodies_at(settings_.duration);
    const double in_bed = bed_ ? bed_->memory : contacts_are_to_form(pace) ? usual_memory_of_pairs(have_meshes()) : 0;
    most_memory_ = most_memory(memory, comm_.size(), bodies, come_by(settings_.duration), in_bed);
    line("memory in all",
         fmt::format("{} now{}, about {} while files are written{}", bytes_text(memory.all),
                     comm_.size() > 1 ? ", of all ranks together" : "", bytes_text(most_memory_), in_bed > 0 ? " in a bed" : ""));
    add_disk(pace);
    add_help();
    return text_;
  }

 private:
  void line(const std::string& what, const std::string& value) { text_ += fmt::format("  {:<13} {}\n", what, value); }

  /// Processor time of a body and step in a bed [s], before a sample tells.
  double usual_cost() const { return have_meshes() ? kMeshInBed : kBallInBed; }
  bool have_meshes() const {
    const auto is_mesh = [&](std::int32_t shape) { return scene_.shapes[static_cast<std::size_t>(shape)].kind != ShapeKind::sphere; };
    return std::any_of(scene_.bodies.shape.begin(), scene_.bodies.shape.end(), is_mesh) ||
           std::any_of(scene_.inlets.begin(), scene_.inlets.end(), [&](const Inlet& inlet) {
             return std::any_of(inlet.shares.begin(), inlet.shares.end(), [&](const Inlet::Share& share) { return is_mesh(share.shape); });
           });
  }
  /// Time of the run as a bed from that [s].
  double guess() const { return usual_cost() * mean_bodies() * static_cast<double>(steps_); }

  /// Whether walls that move, or the cell, press the bodies together.
  bool are_pressed() const {
    return settings_.cell.has_value() ||
           std::any_of(scene_.walls.begin(), scene_.walls.end(), [](const Wall& wall) { return wall.motion.drive().has_value(); });
  }
  /// Contacts of a heap of all bodies, where gravity, walls or the cell may make one.
  double contacts_at_rest() const {
    if (!are_pressed() && !(length(settings_.gravity) > 0)) return 0;
    return (bed_ ? bed_->contacts : are_pressed() ? kContactsPressed : kContactsAtRest) * bodies_at(settings_.duration);
  }
  bool contacts_are_to_form(const Pace& pace) const { return contacts_at_rest() > 2 * static_cast<double>(pace.contacts); }
  /// Processor time of the run [s], where no sample was settled.
  double time_without_sample(const Pace& pace) const {
    const double at_this_pace = pace.per_step() * static_cast<double>(steps_);
    return contacts_are_to_form(pace) ? std::max(at_this_pace, guess()) : at_this_pace;
  }

  /// Bodies that move at a time, if none leaves.
  double bodies_at(double time) const { return static_cast<double>(masses_.size()) + come_by(time); }

  /// Bodies that inlets have let in by a time, about.
  double come_by(double time) const {
    double all = 0;
    for (std::size_t i = 0; i < scene_.inlets.size(); ++i) all += inflow_by(scene_.inlets[i], mean_masses_[i], time);
    return all;
  }

  /// The mean of bodies_at() over the run.
  double mean_bodies() const {
    constexpr int kTimes = 100;
    double sum = 0;
    for (int k = 0; k < kTimes; ++k) sum += bodies_at((k + 0.5) / kTimes * settings_.duration) / kTimes;
    return sum;
  }

  /// How long what is there falls, and what comes in [s]: with the speed of the fastest impact.
  double fall_time() const {
    const double g = length(settings_.gravity);
    return g > 0 ? settings_.impact_speed / g : 0;
  }

  /// Processor time of the run on all ranks [s].
  /// in   falling, lying   of a body and step before it has contacts and in a bed [s]
  double whole_time(const Pace& pace, double falling, double lying) const {
    constexpr int kSlices = 400;
    const double slice = settings_.duration / kSlices, steps = static_cast<double>(steps_) / kSlices;
    // what falls rests after twice the longest fall, and its contacts form one after the other until then
    const double rest = std::max(2 * fall_time(), 1e-300), first = static_cast<double>(masses_.size());
    const double begun = std::min(1.0, static_cast<double>(pace.contacts) / std::max(bed_->contacts * first, 1.0));
    double all = 0;
    for (int k = 0; k < kSlices; ++k) {
      const double time = (k + 0.5) * slice, lies = begun + (1 - begun) * std::min(1.0, time / rest);
      const double bed = first * lies + come_by(std::max(0.0, time - rest)), fall = bodies_at(time) - bed;
      all += steps * (bed * lying + fall * falling);
    }
    return all;
  }

  /// How much faster the cores in use are than the one of the sample, as far as the first steps tell.
  double faster_than_one(const Pace& pace) const {
    const double cores = comm_.size() * omp_get_max_threads(), falling = bed_->falling * static_cast<double>(masses_.size());
    return cores > 1 && pace.per_step() > 0 ? std::clamp(falling / pace.per_step(), 1.0, cores) : 1;
  }

  /// Time of the run on one core [s].   in   lying   of a body and step in a bed [s]
  double time_as_bed(const Pace& pace, double lying) const {
    const double first = static_cast<double>(masses_.size());
    return whole_time(pace, first > 0 ? pace.per_step() * faster_than_one(pace) / first : bed_->falling, lying);
  }

  void add_time(const Pace& pace) {
    if (bed_) return add_time_of_bed(pace);
    estimate_ = time_without_sample(pace);
    if (contacts_are_to_form(pace)) {
      line("wall time",
           fmt::format("about {} ({} to {}): {} a step as now, {} once all lie in a bed, with about {:.0f} contacts",
                       format_duration(estimate_), format_duration(estimate_ / kSpread), format_duration(estimate_ * kSpread),
                       step_text(pace.per_step()), step_text(usual_cost() * bodies_at(settings_.duration)), contacts_at_rest()));
      const std::string no_sample =
          is_asked_ ? fmt::format(
                          ": no sample of the bed was settled, with this step it would take longer than the {:.0f} s that a plan may take",
                          sample_budget())
                    : "";
      line("", fmt::format("from the usual cost of a body in a bed, {:.3g} us a step{}", 1e6 * usual_cost(), no_sample));
    } else {
      line("wall time", fmt::format("about {} at the pace of {} steps that were just made ({} a step, {} contacts)",
                                    format_duration(estimate_), pace.steps, step_text(pace.per_step()), pace.contacts));
    }
    add_load(pace);
    add_cores();
  }

  /// From a sample of the bed that is still to form.
  void add_time_of_bed(const Pace& pace) {
    const double faster = faster_than_one(pace);
    const double bodies = bodies_at(settings_.duration);
    estimate_ = time_as_bed(pace, bed_->resting) / faster;
    line("wall time", fmt::format("about {} ({} to {}): {} a step as now, {} once {:.0f} bodies lie in a bed", format_duration(estimate_),
                                  format_duration(estimate_ / kSpread), format_duration(estimate_ * kSpread), step_text(pace.per_step()),
                                  step_text(bed_->resting * bodies / faster), bodies));
    line("", fmt::format("a sample of {} of these bodies was settled in {:.1f} s: {:.3g} us a body and step in a bed, {:.3g} in free fall; "
                         "{:.2f} contacts a body",
                         bed_->bodies, bed_->seconds, 1e6 * bed_->resting, 1e6 * bed_->falling, bed_->contacts));
    if (settings_.stop_at_rest || settings_.stop_when_empty)
      line("", fmt::format("that is until {}; the run may end sooner ({})", format_quantity(settings_.duration, Dimension::time),
                           settings_.stop_at_rest ? "time.stop_at_rest" : "time.stop_when_empty"));
    if (settings_.sleep) line("", "bodies that sleep (time.sleep) take about a fiftieth of that");
    if (!scene_.outlets.empty())
      line("", fmt::format("if no body leaves: {:.0f} bodies on the mean; otherwise in proportion to the bodies that are there",
                           mean_bodies()));
    add_load(pace);
    add_cores();
  }

  /// Times are those of cores that no other program uses.
  void add_load(const Pace& pace) {
    constexpr double kWorthTelling = 1.5;
    if (pace.slowdown > kWorthTelling)
      line("", fmt::format("about {} while other programs use these cores as now", format_duration(estimate_ * pace.slowdown)));
    if (pace.slowdown > kSlowedDown) line("", slowdown_text(pace.slowdown));
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

  /// Of walls with a load map.
  double triangles_with_loads() const {
    double all = 0;
    for (const Wall& wall : scene_.walls)
      if (wall.load_map) all += static_cast<double>(scene_.shapes[static_cast<std::size_t>(wall.shape)].mesh.triangle_count());
    return all;
  }

  void add_disk(const Pace& pace) {
    const double frames = settings_.output_every > 0 ? std::floor(settings_.duration / settings_.output_every) + 1 : 101;
    const double fixed = static_cast<double>(scene_.bodies.size() - masses_.size()), bodies = fixed + mean_bodies();
    const double bare = kFrameOverhead + static_cast<double>(frame_rows_bytes(static_cast<std::int64_t>(bodies), 0));
    const double at_rest = settings_.output_contacts ? std::max(static_cast<double>(pace.contacts), contacts_at_rest()) : 0;
    const double full = bare + static_cast<double>(frame_rows_bytes(0, static_cast<std::int64_t>(at_rest)));
    // what falls comes to rest after about the time of the longest fall, and contacts form one after the other until then
    const double g = length(settings_.gravity), fall = g > 0 && pace.contacts < at_rest / 2 ? settings_.impact_speed / g : 0;
    const double of_bodies = mean_bodies() / std::max(1.0, bodies_at(settings_.duration));  // contacts go with those that are there
    const double share = of_bodies * (settings_.duration > 0 ? 1 - std::min(1.0, fall / (2 * settings_.duration)) : 1);
    const double walls = static_cast<double>(scene_.walls.size());
    const double log = frames * kRowsPerFrame * (kLogRow + 200 * walls);
    const double triangles = triangles_with_loads(), loads = triangles > 0 ? kLoadOverhead + kLoadInFrame * triangles : 0;
    const double checkpoint = kCheckpointOverhead + kCheckpointBody * (fixed + bodies_at(settings_.duration)) +
                              kCheckpointSpring * at_rest + kLoadInCheckpoint * triangles;
    line("disk", fmt::format("about {}: {:.0f} frames of {}{}, log {}, two checkpoints of {}, the scene {}",
                             bytes_text(frames * (bare + loads + share * (full - bare)) + log + 2 * checkpoint + scene_bytes_), frames,
                             bytes_text(bare + loads),
                             full > bare ? fmt::format(" ({} once {:.0f} contacts have formed)", bytes_text(full + loads), at_rest) : "",
                             bytes_text(log), bytes_text(checkpoint), bytes_text(scene_bytes_)));
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
  std::optional<BedSample> bed_;
  bool is_asked_ = false;            ///< a sample was asked for; without bed_ there was no time for one
  std::vector<double> mean_masses_;  ///< of the bodies of each inlet [kg]
  std::vector<double> masses_;       ///< of the bodies that move, ascending [kg]
  std::int64_t steps_ = 0;
  double scene_bytes_ = 0;
  double estimate_ = 0;     ///< of the time of the run [s]
  double most_memory_ = 0;  ///< of all ranks [bytes]
  std::string text_;
};

}  // namespace

std::string estimates_text(const mpi::Communicator& comm, const LoadedScene& loaded, Simulation& simulation,
                           std::span<const int> other_ranks) {
  Estimates estimates(comm, loaded, simulation);
  Pace pace;
  try {
    pace = pace_of(comm, simulation, estimates.steps());
  } catch (const RunInvalid& reason) {  // on all ranks
    return fmt::format("  wall time     none: the run ends in its first steps; {}\n", reason.what());
  }
  const MemoryNow memory = memory_now(comm, simulation.state());
  if (estimates.needs_sample(pace))
    estimates.take(settle_sample(*loaded.prepared, simulation.state().clock.size.step, estimates.sample_budget()));
  std::string text = estimates.text(pace, memory);
  const BodiesToCut bodies = other_ranks.empty() ? BodiesToCut{} : bodies_to_cut(simulation);
  for (const int ranks : other_ranks) text += estimates.on_ranks(pace, bodies, ranks);
  if (!other_ranks.empty())
    text += fmt::format("  {:<13} assumed of ranks: 2 us a message and 1 GB/s each; bodies are cut where they are now\n", "");
  return text;
}

}  // namespace scree
