#include "solver/run/plan.hpp"

#include <omp.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>

#include "core/base/counted.hpp"
#include "core/base/progress.hpp"
#include "core/base/units.hpp"
#include "core/storage/contact_limits.hpp"
#include "core/storage/plasticity.hpp"
#include "solver/contact/overlap_limit.hpp"
#include "solver/effects/effects.hpp"
#include "solver/effects/sleep/sleep.hpp"
#include "solver/laws/restitution.hpp"
#include "solver/run/inflow.hpp"
#include "solver/run/plan_memory.hpp"
#include "solver/run/run.hpp"

namespace scree {

namespace {

/// How many there are in a scene.
struct Counts {
  std::size_t bodies = 0, fixed = 0, locked = 0, spheres = 0, isotropic = 0, triangles = 0, shape_bytes = 0;
};

Counts count(const SolverScene& scene) {
  const BodyTable& bodies = scene.source().bodies;
  Counts n;
  n.bodies = bodies.size();
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const SolverShape& shape = scene.shape(bodies.shape[b]);
    n.fixed += bodies.fixed[b] ? 1 : 0;
    n.locked += bodies.lock_rotation[b] ? 1 : 0;
    n.spheres += shape.kind == ShapeKind::sphere ? 1 : 0;
    n.isotropic += shape.isotropic ? 1 : 0;
  }
  for (const SolverShape& shape : scene.shapes()) {
    n.triangles += shape.mesh.triangles.size();
    n.shape_bytes += shape.memory();
  }
  return n;
}

/// The text, part by part.
class Plan {
 public:
  Plan(const mpi::Communicator& comm, const SolverScene& scene, const std::optional<StartState>& start, const Simulation& simulation)
      : comm_(comm),
        scene_(scene),
        start_(start),
        source_(scene.source()),
        settings_(source_.settings),
        simulation_(simulation),
        count_(count(scene)) {}

  std::string text() {
    const std::set<std::int32_t> shapes(source_.bodies.shape.begin(), source_.bodies.shape.end());  // walls have shapes as well
    text_ = fmt::format("Plan of \"{}\": {} bodies of {} ({} triangles), {}, {} ranks x {} threads\n", settings_.title, count_.bodies,
                        counted(std::ssize(shapes), "shape", "shapes"), count_.triangles,
                        counted(std::ssize(source_.walls), "wall", "walls"), comm_.size(), omp_get_max_threads());
    add_start();
    add_contact();
    add_motion();
    add_sleep();
    add_fluid();
    add_space();
    add_output();
    add_numbers();
    return text_;
  }

 private:
  void in(const std::string& what, const std::string& why) { text_ += fmt::format("  in   {:<26} {}\n", what, why); }
  void out(const std::string& what, const std::string& why) { text_ += fmt::format("  out  {:<26} {}\n", what, why); }
  void add_start();
  void add_contact();
  void add_attraction();
  void add_plasticity();
  void add_motion();
  void add_sleep();
  void add_fluid();
  void add_space();
  std::string text_of(const Inlet& inlet) const;
  void add_output();
  void add_numbers();

  const mpi::Communicator& comm_;
  const SolverScene& scene_;
  const std::optional<StartState>& start_;
  const Scene& source_;
  const Settings& settings_;
  const Simulation& simulation_;
  Counts count_;
  std::string text_;
};

void Plan::add_contact() {
  if (count_.spheres < count_.bodies)
    in("triangles", "hierarchies, triangle distance and feature pairs of the meshes");
  else
    out("triangles", "all bodies are analytic spheres");
  const bool by_size = std::any_of(source_.pairs.begin(), source_.pairs.end(), [](const MaterialPair& p) { return p.modulus > 0; });
  in("normal contact",
     fmt::format("{} law{}, {} gathering, {}", word_of(settings_.law), by_size ? ", stiffness by size" : "", word_of(settings_.gather),
                 settings_.margin > 0 || settings_.margin_ratio > 0
                     ? fmt::format("margin {} per body", format_quantity(settings_.margin, Dimension::length))
                     : "no margin: bodies touch as drawn"));
  if (const DensityWeights* weights = scene_.density_weights()) {
    const DensityWeights::Summary s = weights->summary();
    if (s.tables > 0)
      in("weights by density",
         fmt::format("{} tables of vertices that lie closer than they can carry on their own, {:.1f} kB; smallest weight {:.3g}", s.tables,
                     1e-3 * static_cast<double>(s.bytes), s.least));
    else
      out("weights by density", "no two vertices lie so close that they carry as one");
  }
  if (scene_.continues())
    in("contacts beyond their room",
       fmt::format(
           "on_overlap = \"continue\": from {:g} of the room on along the tangent of the law, up to {:g} times the bounding radius of "
           "the smaller body; they are counted, and the result is doubtful",
           kStopOverlapRatio, kMaxOverlap));
  else
    out("contacts beyond their room", "on_overlap = \"stop\": they end the run");
  if (scene_.has_damping())
    in("damping", "restitution below 1 for some pair");
  else
    out("damping", "every restitution is 1");
  for (const MaterialPair& pair : source_.pairs) {
    if (pair.restitution >= kMinRestitution) continue;
    in("restitution",
       fmt::format("{} between {} and {} is computed as {}", pair.restitution, source_.materials[static_cast<std::size_t>(pair.a)].name,
                   source_.materials[static_cast<std::size_t>(pair.b)].name, kMinRestitution));
  }
  if (scene_.law_choice().attraction)
    add_attraction();
  else
    out("attraction", "no pair has pull_off, adhesion or surface_tension: contacts begin at touch");
  if (scene_.law_choice().yields)
    add_plasticity();
  else
    out("plastic contacts", "no pair has a plasticity: what a contact stores comes back");
  if (scene_.has_friction())
    in("friction springs", fmt::format("{0} bytes per contact, and {0} per pair in contact", sizeof(FrictionSpring)));
  else
    out("friction springs", "every friction is 0: no history of sliding is kept");
  if (scene_.law_choice().rolling)
    in("rolling resistance", "one spring of moment per body pair");
  else
    out("rolling resistance", "no pair asks for it");
}

void Plan::add_start() {
  if (!start_) return;
  const StartState& start = *start_;
  in("start from a run",
     fmt::format("{} bodies of {}/{} at {}{}", start.bodies, start.run, start.file, format_quantity(start.time, Dimension::time),
                 start.q_principal.empty() ? "; contacts start without springs"
                                           : fmt::format("; {} contacts keep their springs", start.pair_count())));
  if (start.left > 0) out("springs of that run", fmt::format("{} contacts: not the same wall, or another contact.gather", start.left));
}

void Plan::add_attraction() {
  for (const MaterialPair& pair : source_.pairs) {
    if (!attracts(pair)) continue;
    const Material &a = source_.materials[static_cast<std::size_t>(pair.a)], &b = source_.materials[static_cast<std::size_t>(pair.b)];
    const LargestImpact impact = scene_.largest_impact(pair, scene_.extremes());
    const double force = scene_.largest_pull_off(pair, scene_.extremes()), range = scene_.law(pair.a, pair.b).reach;
    if (settings_.gather == Gathering::area) {
      in("attraction", fmt::format("'{}' and '{}': a traction of {} at touch over {}; parting takes {}", a.name, b.name,
                                   format_quantity(2 * pair.adhesion / range, Dimension::pressure),
                                   format_quantity(range, Dimension::length), format_quantity(pair.adhesion, Dimension::surface_energy)));
      continue;
    }
    const bool sized = impact.radius > 0;
    const double parts = sized ? parting_energy(settings_.law, pair, a, b, impact.radius) : 0.5 * force * range;
    const double pressed = sized ? resting_contact(settings_.law, pair, a, b, impact.radius).energy : 0;
    const char* how = pull_kind(pair) == PullKind::neck     ? ", from touch until the neck tears,"
                      : pull_kind(pair) == PullKind::bridge ? ", by a liquid bridge from touch until it ruptures,"
                                                            : "";
    in("attraction", fmt::format("'{}' and '{}': {}{}{} over {}; parting takes {} from touch, {} from rest", a.name, b.name,
                                 pair.pull_off > 0 ? "" : "at most ", format_quantity(force, Dimension::force), how,
                                 format_quantity(range, Dimension::length), format_quantity(parts, Dimension::energy),
                                 format_quantity(parts + pressed, Dimension::energy)));
    const double step = simulation_.state().clock.size.step;
    if (impact.speed > 0)
      in("range crossed", fmt::format("in {:.3g} steps at {}, the fastest impact expected", range / (impact.speed * step),
                                      format_quantity(impact.speed, Dimension::velocity)));
    else
      out("steps in the range", "no speed is known; give contact.impact_speed");
  }
}

void Plan::add_plasticity() {
  for (const MaterialPair& pair : source_.pairs) {
    if (!yields(pair)) continue;
    const std::string pulls = pair.adhesive_ratio > 0 ? fmt::format(", pulls by up to {:g} of its law", pair.adhesive_ratio) : "";
    in("plastic contacts", fmt::format("'{}' and '{}': unloads {:.4g} times as steeply{}; one dent per pair in contact",
                                       source_.materials[static_cast<std::size_t>(pair.a)].name,
                                       source_.materials[static_cast<std::size_t>(pair.b)].name, 1 / (1 - pair.plasticity), pulls));
  }
}

void Plan::add_motion() {
  if (count_.bodies > count_.fixed)
    in("motion", fmt::format("{}, {} moving bodies", word_of(settings_.integrator), count_.bodies - count_.fixed));
  if (count_.fixed > 0) out("motion of fixed bodies", fmt::format("{} bodies; no fixed-fixed pairs", count_.fixed));
  if (count_.locked == count_.bodies && count_.bodies > 0)
    out("rotation", "every body has lock_rotation");
  else if (count_.isotropic == count_.bodies && count_.bodies > 0)
    out("gyroscopic splitting", "every inertia is isotropic: one exact rotation");
  else
    in("rotation", fmt::format("{}{}",
                               settings_.integrator == Integrator::kdk_dlm ? "five-rotation splitting"
                                                                           : word_of(settings_.integrator) + std::string(" rotor"),
                               count_.locked > 0 ? fmt::format(", {} bodies locked", count_.locked) : ""));
}

void Plan::add_sleep() {
  if (!settings_.sleep) return out("sleep", "time.sleep = false: bodies at rest are computed");
  if (!simulation_.state().sleep) return out("sleep", "without gravity nothing sleeps: no weight says which force is small");
  in("sleep", fmt::format("bodies at rest, looked at every {} steps; woken by a change of {:g} of their weight", kSleepSteps,
                          settings_.sleep_tolerance));
  for (const Wall& wall : source_.walls) {
    if (const char* why = sleep_blocker(wall)) out("sleep on a wall", fmt::format("'{}' {}", wall.name, why));
  }
}

void Plan::add_fluid() {
  if (settings_.fluid) {
    const FluidForces fluid(source_);
    double slowest = 1e300, fastest = 0;
    for (std::size_t b = 0; b < count_.bodies; ++b) {
      if (source_.bodies.fixed[b] != 0) continue;
      const double reynolds = fluid.reynolds_number(kind_of(source_.bodies, b), fluid.terminal_speed(kind_of(source_.bodies, b)));
      slowest = std::min(slowest, reynolds);
      fastest = std::max(fastest, reynolds);
    }
    in("fluid", fmt::format("{}, {}: buoyancy, {} drag, drag of spin; Reynolds numbers of a free fall {:.3g} to {:.3g}",
                            format_quantity(settings_.fluid->density, Dimension::density),
                            format_quantity(settings_.fluid->viscosity, Dimension::viscosity), word_of(settings_.fluid->drag),
                            std::min(slowest, fastest), fastest));
  } else {
    out("fluid", "no [fluid]: bodies move in a void");
  }
}

std::string Plan::text_of(const Inlet& inlet) const {
  const double mean = mean_mass(source_, inlet), number = inflow_by(inlet, mean, settings_.duration);
  return fmt::format("'{}': about {:.0f} bodies, {} in all, at most {} at a time; looked at every {} steps; when full: {}", inlet.name,
                     number, format_quantity(number * mean, Dimension::mass),
                     inlet.rate.by_number ? format_quantity(inlet.rate.largest(), Dimension::frequency)
                                          : format_quantity(inlet.rate.largest(), Dimension::mass) + "/s",
                     kExchangeSteps, word_of(inlet.when_full));
}

void Plan::add_space() {
  if (scene_.has_driven_walls()) {
    for (const Wall& wall : source_.walls) {
      if (wall.motion.is_prescribed()) in("driven walls", fmt::format("'{}' {}", wall.name, wall.motion.text()));
    }
  } else
    out("driven walls", "no wall moves");
  if (scene_.has_moving_surfaces()) {
    for (const Wall& wall : source_.walls) {
      if (wall.surface.is_given()) in("moving surfaces", fmt::format("'{}': {}", wall.name, wall.surface.text()));
    }
  } else
    out("moving surfaces", "no wall has one");
  for (std::size_t k = 0; k < effect_kinds().size(); ++k) {
    const PlanLine& without = effect_kinds()[k].without;
    const Effect* effect = nullptr;
    for (const std::unique_ptr<Effect>& found : simulation_.state().effects)
      if (found->kind() == k) effect = found.get();
    if (effect == nullptr && !without.first.empty()) out(without.first, without.second);
    if (effect == nullptr) continue;
    for (const PlanLine& line : effect->plan(simulation_.state())) in(line.first, line.second);
  }
  if (comm_.size() > 1)
    in("halo and migration", fmt::format("{} bytes per ghost and step", kGhostBytes));
  else
    out("halo and migration", "one rank: no messages");
  if (scene_.periodicity().any())
    in("periodic axes", "positions wrapped, pairs by their nearest images");
  else
    out("periodic axes", "no axis is periodic: no images");
  for (const std::string& zone : scene_.dropped_zones()) out("wall face", zone + ": the seam takes its place");
  for (const std::string& gap : scene_.seam_gaps()) out("wall at a seam", gap);
  for (const Inlet& inlet : source_.inlets) in("inlet", text_of(inlet));
  for (const Outlet& outlet : source_.outlets) {
    in("outlet",
       fmt::format("'{}': bodies with their centre inside are taken out, every {} steps{}", outlet.name, kExchangeSteps,
                   outlet.to < 0 ? "" : "; they come in again through '" + source_.inlets[static_cast<std::size_t>(outlet.to)].name + "'"));
  }
  if (!settings_.domain.bounded)
    out("domain checks", "the domain is unbounded");
  else
    in("domain checks", std::string("outside = ") + word_of(settings_.domain.outside));
}

void Plan::add_output() {
  if (settings_.output_contacts)
    in("contacts in frames", "output.contacts = true");
  else
    out("contacts in frames", "output.contacts = false");
  if (settings_.checkpoint_every > 0)
    in("checkpoints", fmt::format("output.checkpoint = {}", format_quantity(settings_.checkpoint_every, Dimension::time)));
  else if (settings_.checkpoint_by_clock)
    in("checkpoints", fmt::format("every {:g} min of run time, or --checkpoint-interval; no output.checkpoint", kCheckpointInterval / 60));
  else
    out("checkpoints", "output.checkpoint = 0: one at the end");
}

void Plan::add_numbers() {
  const StepSize& step = simulation_.state().clock.size;
  const std::size_t pairs = simulation_.state().pairs.pairs().size();
  std::size_t candidate_bytes = 0;
  for (const BodyPair& p : simulation_.state().pairs.pairs()) candidate_bytes += memory_of_candidates(p);
  const double steps = settings_.duration / step.step;
  text_ += fmt::format("\n  step          {} ({}; contact time {}, {:.3g} steps per contact)\n",
                       format_quantity(step.step, Dimension::time), step.given ? "given" : "limited by " + step.limited_by,
                       format_quantity(step.contact_time, Dimension::time), step.contact_time / step.step);
  if (settings_.step_control == StepControl::quantised)
    text_ += fmt::format("                quantised: now {}\n", format_quantity(simulation_.state().clock.dt, Dimension::time));
  text_ += fmt::format("                critical step of that contact {}\n", format_quantity(step.critical(), Dimension::time));
  text_ += fmt::format("  steps         {:.0f} for {}\n", steps, format_quantity(settings_.duration, Dimension::time));
  text_ += fmt::format("  memory        {} bytes per body, {} per body pair, shapes {:.1f} kB, candidates now {:.1f} kB in {} pairs\n",
                       kMemoryOfBody, sizeof(BodyPair) + sizeof(PairResult), static_cast<double>(count_.shape_bytes) / 1e3,
                       static_cast<double>(candidate_bytes) / 1e3, pairs);
  double most = static_cast<double>(count_.bodies);
  for (const Inlet& inlet : source_.inlets) most += inflow_by(inlet, mean_mass(source_, inlet), settings_.duration);
  if (!source_.inlets.empty()) {
    text_ += fmt::format("                about {:.1f} MB for {:.0f} bodies at the end, pairs not counted{}\n",
                         most * static_cast<double>(sizeof(ParticleRecord) + 8 * sizeof(Vec3)) / 1e6, most,
                         source_.outlets.empty() ? "" : ", if none leaves");
  }
}

}  // namespace

std::string plan_text(const mpi::Communicator& comm, const LoadedScene& loaded, const Simulation& simulation) {
  return Plan(comm, *loaded.prepared, loaded.start, simulation).text();
}

}  // namespace scree
