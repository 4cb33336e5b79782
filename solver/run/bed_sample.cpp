#include "solver/run/bed_sample.hpp"

#include <omp.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/placing/random_numbers.hpp"
#include "solver/phases.hpp"
#include "solver/run/measures.hpp"
#include "solver/run/plan_memory.hpp"

namespace scree {

namespace {

constexpr std::size_t kMostBodies = 90, kFewestBodies = 54;
constexpr std::uint64_t kSeed = 20260714;  // any: the same sample for the same scene

/// Bodies to choose from: those of the scene that move, then what inlets bring, in proportion.
std::vector<BodyRow> candidates_of(const Scene& scene) {
  std::vector<BodyRow> rows;
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    if (scene.bodies.fixed[b] == 0) rows.push_back(scene.bodies.row(b));
  }
  for (const Inlet& inlet : scene.inlets) {
    std::optional<SizeSampler> sizes;
    if (inlet.size) sizes.emplace(*inlet.size);
    for (const Inlet::Share& share : inlet.shares) {
      const auto count = static_cast<std::size_t>(std::ceil(share.share * kMostBodies));
      for (std::size_t n = 0; n < count; ++n) {
        BodyRow row;
        row.shape = share.shape;
        row.material = inlet.material;
        row.temperature = inlet.temperature;
        if (sizes) {
          const double diameter = sizes->diameter((static_cast<double>(n) + 0.5) / static_cast<double>(count));
          row.scale = scale_of(inlet.size, scene.shapes[static_cast<std::size_t>(share.shape)], diameter);
        }
        rows.push_back(row);
      }
    }
  }
  return rows;
}

/// How far from its centre a body acts [m].
double reach_of(const SolverScene& scene, const BodyRow& row) { return row.scale * scene.shape(row.shape).radius + scene.contact_range(); }

double density_of(const SolverScene& scene, const BodyRow& row) {
  return scene.source().materials[static_cast<std::size_t>(row.material)].density;
}

/// Of the walls' materials the first that meets those of all bodies, else that of the first body; -1: none does.
std::int32_t material_of_floor(const Scene& scene, const std::vector<BodyRow>& rows) {
  std::vector<std::int32_t> choice;
  for (const Wall& wall : scene.walls) choice.push_back(wall.material);
  choice.push_back(rows.front().material);
  const auto meets = [&](std::int32_t a, std::int32_t b) {
    return std::any_of(scene.pairs.begin(), scene.pairs.end(),
                       [&](const MaterialPair& p) { return (p.a == a && p.b == b) || (p.a == b && p.b == a); });
  };
  const auto found = std::find_if(choice.begin(), choice.end(), [&](std::int32_t m) {
    return std::all_of(rows.begin(), rows.end(), [&](const BodyRow& row) { return meets(row.material, m); });
  });
  return found == choice.end() ? -1 : *found;
}

/// The sample as a scene of its own, its bodies in layers that do not touch, the largest below.
class SampleScene {
 public:
  SampleScene(const SolverScene& of, double step, std::size_t count) {
    std::vector<BodyRow> rows = candidates_of(of.source());
    if (rows.empty()) return;
    const double every = std::max(1.0, static_cast<double>(rows.size()) / static_cast<double>(count));
    std::vector<BodyRow> chosen;
    for (double at = 0; at < static_cast<double>(rows.size()); at += every) chosen.push_back(rows[static_cast<std::size_t>(at)]);
    std::stable_sort(chosen.begin(), chosen.end(), [&](const BodyRow& a, const BodyRow& b) { return reach_of(of, a) > reach_of(of, b); });
    Wall floor;
    floor.name = "floor";
    floor.material = material_of_floor(of.source(), chosen);
    if (floor.material < 0) return;
    scene_.walls.push_back(floor);
    take_settings(of.source(), step);
    place(of, chosen);
    keep_shapes(of.source());
  }

  const Scene& scene() const { return scene_; }
  double closing_time() const { return closing_time_; }  ///< in which the layers would meet on the floor [s]

 private:
  void take_settings(const Scene& of, double step) {
    Settings& s = scene_.settings;
    s = of.settings;
    s.title = "sample";
    s.step = step;
    s.step_control = StepControl::fixed;
    s.sleep = s.stop_at_rest = s.stop_when_empty = false;
    if (s.fluid) s.fluid->velocity = {};
    scene_.materials = of.materials;
    scene_.pairs = of.pairs;
    // a body costs the same whatever its restitution, and rests sooner with a small one; where it is 1, no bed comes to rest
    constexpr double kRestitution = 0.2;
    for (MaterialPair& pair : scene_.pairs) pair.restitution = pair.restitution < 1 ? std::min(pair.restitution, kRestitution) : 1;
  }

  void place(const SolverScene& of, std::vector<BodyRow>& rows) {
    // Their bounding balls do not touch, also once they are shifted, so that they do not fall as a lattice.
    constexpr double kApart = 1.15, kShift = 0.06;
    // The bed is to be higher than wide. A periodic side has room for two of the widest bodies: the solver asks for that.
    constexpr double kSolidFraction = 0.55, kHeightOverSide = 1.5, kLeastSide = 2.1;
    double volume = 0;
    for (const BodyRow& row : rows) volume += of.source().mass(row.shape, row.material, row.scale) / density_of(of, row);
    const double widest = 2 * kApart * reach_of(of, rows.front());
    const double side = std::max(kLeastSide * widest, std::cbrt(volume / (kSolidFraction * kHeightOverSide)));
    for (std::size_t n = 0; n < rows.size();) {
      const double room = 2 * kApart * reach_of(of, rows[n]);
      const auto across = static_cast<std::size_t>(side / room);
      const RandomNumbers layer(kSeed, static_cast<std::int64_t>(n), 1);
      for (std::size_t k = 0; k < across * across && n < rows.size(); ++k, ++n) {
        BodyRow& row = rows[n];
        row.id = static_cast<std::int64_t>(n);
        row.population = -1;
        row.velocity = {0, 0, height_};  // a speed per length, until all heights are known
        row.angular_velocity = {};
        row.heat_source = 0;
        row.heat_table = -1;
        const RandomNumbers random(kSeed, row.id, 0);
        const auto along = [&](std::size_t cell, double of_layer, std::uint64_t which) {
          return (static_cast<double>(cell) + of_layer) * side / static_cast<double>(across) +
                 kShift * room * (2 * random.uniform(which) - 1);
        };
        row.position = Vec3{along(k % across, layer.uniform(0), 3), along(k / across, layer.uniform(1), 4), height_ + 0.5 * room};
        row.orientation = random.orientation(0);
        scene_.bodies.add(row);
      }
      height_ += room;
    }
    // All layers close up together, and a gravity holds them there that makes the fastest of them as fast as the fastest impact of the run.
    // How large it is does not change what a body costs.
    const Settings& settings = scene_.settings;
    const double fastest = settings.impact_speed > 0 ? settings.impact_speed : std::sqrt(2 * length(settings.gravity) * height_);
    closing_time_ = height_ / (std::sqrt(0.5) * fastest);
    for (Vec3& velocity : scene_.bodies.velocity) velocity *= -1 / closing_time_;
    scene_.settings.gravity = {0, 0, -0.25 * fastest * fastest / height_};
    scene_.settings.duration = 100 * closing_time_;
    Domain& domain = scene_.settings.domain;
    scene_.settings.cell.reset();
    domain.bounded = true;
    domain.lower = {0, 0, -widest};
    domain.upper = {side, side, height_ + 10 * widest};
    domain.periodic = {true, true, false};
    domain.outside = Outside::stop;
  }

  /// Those of its bodies alone: preparing the meshes of walls may take longer than the sample.
  void keep_shapes(const Scene& of) {
    std::vector<std::int32_t> place(of.shapes.size(), -1);
    for (std::int32_t& shape : scene_.bodies.shape) {
      std::int32_t& at = place[static_cast<std::size_t>(shape)];
      if (at < 0) {
        at = static_cast<std::int32_t>(scene_.shapes.size());
        scene_.shapes.push_back(of.shapes[static_cast<std::size_t>(shape)]);
      }
      shape = at;
    }
  }

  Scene scene_;
  double height_ = 0, closing_time_ = 0;
};

/// One thread while it lives.
class OneThread {
 public:
  OneThread() { omp_set_num_threads(1); }
  ~OneThread() { omp_set_num_threads(before_); }
  OneThread(const OneThread&) = delete;
  OneThread& operator=(const OneThread&) = delete;

 private:
  int before_ = omp_get_max_threads();
};

/// Steps a simulation and counts the processor time.
class Stopwatch {
 public:
  Stopwatch(Simulation& simulation, double budget) : simulation_(simulation), budget_(budget) {}

  /// Processor time of a step [s]; 0 where the budget is spent.
  double run(std::int64_t steps) {
    constexpr std::int64_t kBetweenLooks = 50;
    const double before = used_;
    std::int64_t done = 0;
    while (done < steps && used_ < budget_) {
      const double start = thread_seconds();
      const std::int64_t now = std::min(kBetweenLooks, steps - done);
      for (const std::int64_t end = simulation_.step() + now; simulation_.step() < end;) simulation_.advance(end);
      simulation_.agree_on_failures();
      used_ += thread_seconds() - start;
      done += now;
    }
    return done < steps ? 0 : (used_ - before) / static_cast<double>(steps);
  }
  double used() const { return used_; }

 private:
  Simulation& simulation_;
  double budget_, used_ = 0;
};

/// Contacts of a body where others lie above it, and of all: the topmost third has fewer, and is a small part of a real bed.
struct ContactsOfBody {
  double deep = 0, all = 0;
};

ContactsOfBody contacts_of_body(const RunState& s) {
  const std::size_t count = s.particles.size();
  std::vector<double> heights, halves(count, 0);
  for (const Vec3& x : s.particles.x) heights.push_back(x.z);
  const std::vector<PairResult>& results = s.pairs.results();
  for (std::size_t k = 0; k < results.size(); ++k) {
    if (!results[k].active) continue;
    const BodyPair& pair = s.pairs.pairs()[k];
    const double contacts = results[k].contact_count;
    halves[static_cast<std::size_t>(pair.a)] += pair.b < 0 ? contacts : 0.5 * contacts;
    if (pair.b >= 0) halves[static_cast<std::size_t>(pair.b)] += 0.5 * contacts;
  }
  std::vector<double> sorted = heights;
  std::sort(sorted.begin(), sorted.end());
  const double top = sorted[count * 2 / 3];
  ContactsOfBody mean;
  double deep = 0;
  for (std::size_t i = 0; i < count; ++i) {
    mean.all += halves[i] / static_cast<double>(count);
    if (heights[i] >= top) continue;
    mean.deep += halves[i];
    ++deep;
  }
  mean.deep /= std::max(deep, 1.0);
  return mean;
}

double kinetic(const Simulation& simulation) {
  const Energies e = energies_of(simulation.state());
  return e.translational + e.rotational;
}

/// Steps until the bed hardly moves: by a thousandth of the speed with which it formed, or for ten closing times, or until the budget is
/// spent. Processor time of a step at the end [s]; 0: no bed has formed.   in   steps   in the closing time
double rest(Simulation& simulation, Stopwatch& watch, std::int64_t steps) {
  constexpr double kStill = 1e-6;  // of the kinetic energy at the start
  constexpr int kMostPhases = 20;  // of half the closing time
  const double start = kinetic(simulation);
  double seconds = 0;
  for (int k = 0; k < kMostPhases; ++k) {
    const double now = watch.run((steps + 1) / 2);
    if (!(now > 0)) return k > 3 ? seconds : 0;
    seconds = now;
    if (kinetic(simulation) < kStill * start) break;
  }
  return seconds;
}

/// in/out  used   processor time of all samples so far [s]      out  none where it would take longer than the budget
std::optional<BedSample> settle(const mpi::Communicator& alone, const SampleScene& sample, double step, double budget, double& used) {
  constexpr std::int64_t kFirstSteps = 20;
  constexpr double kBedOverFall = 20;  // what a body costs there, about
  const Scene& own = sample.scene();
  const auto steps = static_cast<std::int64_t>(std::ceil(sample.closing_time() / step));
  const SolverScene prepared(own);
  Simulation simulation(alone, prepared);
  simulation.start_from_scene();
  Stopwatch watch(simulation, budget - used);
  const auto bodies = static_cast<double>(own.bodies.size());
  BedSample found;
  watch.run(kFirstSteps);
  found.falling = watch.run(kFirstSteps) / bodies;
  double resting = 0;
  if (found.falling > 0 && kBedOverFall * 2 * static_cast<double>(steps) * found.falling * bodies < budget - used) {
    resting = rest(simulation, watch, steps);
  }
  used += watch.used();
  if (!(resting > 0)) return {};
  const ContactsOfBody contacts = contacts_of_body(simulation.state());
  if (!(contacts.all > 0)) return {};
  const double deeper = contacts.deep / contacts.all;
  found.bodies = static_cast<std::int64_t>(own.bodies.size());
  found.resting = found.falling + (resting / bodies - found.falling) * deeper;
  found.contacts = contacts.deep;
  found.memory = deeper * memory_of_pairs(simulation.state()) / bodies;
  found.seconds = used;
  return found;
}

}  // namespace

std::optional<BedSample> settle_sample(const SolverScene& scene, double step, double budget) {
  const Settings& settings = scene.source().settings;
  if (!(length(settings.gravity) > 0) || !(step > 0) || scene.is_frozen()) return {};
  const OneThread one_thread;
  const mpi::Communicator alone(MPI_COMM_SELF);
  double used = 0;
  for (std::size_t count = kMostBodies; count >= kFewestBodies; count = count * 2 / 3) {
    SampleScene sample(scene, step, count);
    if (sample.scene().bodies.size() == 0) return {};
    try {
      std::optional<BedSample> found = settle(alone, sample, step, budget, used);
      if (found) return found;
    } catch (const Error&) {
      return {};  // a sample is no verdict on the scene
    }
  }
  return {};
}

}  // namespace scree
