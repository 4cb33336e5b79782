#include <omp.h>

#include <algorithm>

#include "core/base/progress.hpp"
#include "core/base/units.hpp"
#include "solver/laws/restitution.hpp"
#include "solver/run/run.hpp"

namespace scree {

std::string plan_text(const mpi::Communicator& comm, const SolverScene& prepared, const Simulation& simulation) {
  const Scene& scene = prepared.source();
  const Settings& s = scene.settings;
  const StepSize& step = simulation.step_size();
  std::string text;
  const auto in = [&](const std::string& what, const std::string& why) { text += fmt::format("  in   {:<26} {}\n", what, why); };
  const auto out = [&](const std::string& what, const std::string& why) { text += fmt::format("  out  {:<26} {}\n", what, why); };

  std::size_t fixed = 0, locked = 0, spheres = 0, isotropic = 0, triangles = 0, shape_bytes = 0;
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    const SolverShape& shape = prepared.shape(scene.bodies.shape[b]);
    fixed += scene.bodies.fixed[b] ? 1 : 0;
    locked += scene.bodies.lock_rotation[b] ? 1 : 0;
    spheres += shape.kind == ShapeKind::sphere ? 1 : 0;
    isotropic += shape.isotropic ? 1 : 0;
  }
  for (const SolverShape& shape : prepared.shapes()) {
    triangles += shape.mesh.triangles.size();
    shape_bytes += shape.memory();
  }
  const std::size_t bodies = scene.bodies.size();
  text += fmt::format("Plan of \"{}\": {} bodies of {} shapes ({} triangles), {} walls, {} ranks x {} threads\n", s.title, bodies,
                      scene.shapes.size(), triangles, scene.walls.size(), comm.size(), omp_get_max_threads());
  if (spheres < bodies)
    in("triangles", "hierarchies, triangle distance and feature pairs of the meshes");
  else
    out("triangles", "all bodies are analytic spheres");
  in("normal contact", fmt::format("{} law, {} gathering, margin {} per body", word_of(s.law), word_of(s.gather),
                                   format_quantity(s.margin, Dimension::length)));
  if (prepared.has_damping())
    in("damping", "restitution below 1 for some pair");
  else
    out("damping", "every restitution is 1");
  for (const MaterialPair& pair : scene.pairs) {
    if (pair.restitution >= kLeastRestitution) continue;
    in("restitution",
       fmt::format("{} between {} and {} is computed as {}", pair.restitution, scene.materials[static_cast<std::size_t>(pair.a)].name,
                   scene.materials[static_cast<std::size_t>(pair.b)].name, kLeastRestitution));
  }
  if (prepared.has_friction())
    in("friction springs", fmt::format("{0} bytes per contact, and {0} per pair in contact", sizeof(FrictionSpring)));
  else
    out("friction springs", "every friction is 0: no history is kept");
  if (prepared.law_choice().rolling)
    in("rolling resistance", "one spring of moment per body pair");
  else
    out("rolling resistance", "no pair asks for it");
  if (bodies > fixed) in("motion", fmt::format("{}, {} moving bodies", word_of(s.integrator), bodies - fixed));
  if (fixed > 0) out("motion of fixed bodies", fmt::format("{} bodies; no fixed-fixed pairs", fixed));
  if (locked == bodies && bodies > 0)
    out("rotation", "every body has lock_rotation");
  else if (isotropic == bodies && bodies > 0)
    out("gyroscopic splitting", "every inertia is isotropic: one exact rotation");
  else
    in("rotation",
       fmt::format("{}{}", s.integrator == Integrator::kdk_dlm ? "five-rotation splitting" : word_of(s.integrator) + std::string(" rotor"),
                   locked > 0 ? fmt::format(", {} bodies locked", locked) : ""));
  if (s.fluid) {
    const FluidForces fluid(scene);
    double slowest = 1e300, fastest = 0;
    for (std::size_t b = 0; b < bodies; ++b) {
      if (scene.bodies.fixed[b] != 0) continue;
      const double reynolds = fluid.reynolds_number(b, fluid.terminal_speed(b));
      slowest = std::min(slowest, reynolds);
      fastest = std::max(fastest, reynolds);
    }
    in("fluid",
       fmt::format("{}, {}: buoyancy, {} drag, drag of spin; Reynolds numbers of a free fall {:.3g} to {:.3g}",
                   format_quantity(s.fluid->density, Dimension::density), format_quantity(s.fluid->viscosity, Dimension::viscosity),
                   word_of(s.fluid->drag), std::min(slowest, fastest), fastest));
  } else {
    out("fluid", "no [fluid]: bodies move in a void");
  }
  if (prepared.has_driven_walls())
    in("driven walls", "positions from their motion at every step");
  else
    out("driven walls", "no wall moves");
  if (comm.size() > 1)
    in("halo and migration", fmt::format("{} bytes per ghost and step", kGhostBytes));
  else
    out("halo and migration", "one rank: no messages");
  if (prepared.periodicity().any())
    in("periodic axes", "positions wrapped, pairs by their nearest images");
  else
    out("periodic axes", "no axis is periodic: no images");
  for (const std::string& zone : prepared.dropped_zones()) out("wall face", zone + ": the seam takes its place");
  for (const std::string& gap : prepared.seam_gaps()) out("wall at a seam", gap);
  if (!s.domain.bounded)
    out("domain checks", "the domain is unbounded");
  else
    in("domain checks", std::string("outside = ") + word_of(s.domain.outside));
  if (s.output_contacts)
    in("contacts in frames", "output.contacts = true");
  else
    out("contacts in frames", "output.contacts = false");
  if (s.checkpoint_every > 0)
    in("checkpoints", fmt::format("output.checkpoint = {}", format_quantity(s.checkpoint_every, Dimension::time)));
  else if (s.checkpoint_by_clock)
    in("checkpoints", fmt::format("every {:g} min of run time, or --checkpoint-interval; no output.checkpoint", kCheckpointInterval / 60));
  else
    out("checkpoints", "output.checkpoint = 0: one at the end");

  const double contacts = 4.0 * static_cast<double>(simulation.active_pair_count());
  const std::size_t pairs = simulation.pairs().pairs().size();
  std::size_t candidate_bytes = 0;
  for (const BodyPair& p : simulation.pairs().pairs()) {
    candidate_bytes +=
        (p.lists.corners_a.size() + p.lists.corners_b.size()) * sizeof(CornerCandidate) + p.lists.edges.size() * sizeof(EdgeCandidate);
  }
  const double steps = s.duration / step.step;
  text += fmt::format("\n  step          {} ({}; contact time {}, {:.3g} steps per contact)\n", format_quantity(step.step, Dimension::time),
                      step.given ? "given" : "limited by " + step.limited_by, format_quantity(step.contact_time, Dimension::time),
                      step.contact_time / step.step);
  if (s.step_control == StepControl::quantised)
    text += fmt::format("                quantised: now {}\n", format_quantity(simulation.substep_size(), Dimension::time));
  text += fmt::format("                critical step of that contact {}\n", format_quantity(step.critical(), Dimension::time));
  text += fmt::format("  steps         {:.0f} for {}\n", steps, format_quantity(s.duration, Dimension::time));
  text += fmt::format("  memory        {} bytes per body, {} per body pair, shapes {:.1f} kB, candidates now {:.1f} kB in {} pairs\n",
                      sizeof(ParticleRecord) + 8 * sizeof(Vec3), sizeof(BodyPair) + sizeof(PairResult),
                      static_cast<double>(shape_bytes) / 1e3, static_cast<double>(candidate_bytes) / 1e3, pairs);
  const double frames = s.output_every > 0 ? s.duration / s.output_every : 100;
  text += fmt::format("  disk          about {:.1f} MB in {:.0f} frames\n",
                      frames * (static_cast<double>(bodies) * 160 + contacts * 120) / 1e6, frames);
  return text;
}

}  // namespace scree
