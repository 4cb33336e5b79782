// The step size, derived from the stiffest contact that can occur, from approach against margin, and from spin.
#pragma once

#include <span>
#include <string>

#include "solver/bodies/particle_set.hpp"
#include "solver/ranks/mpi_session.hpp"
#include "solver/state/step_clock.hpp"

namespace scree {

/// Share of the sum of their margins by which two surfaces may come nearer in a step.
inline constexpr double kMarginPerStep = 0.2;
/// Share of the range of an attraction by which two surfaces may come nearer in a step.
inline constexpr double kRangePerStep = 0.5;
/// The same at the speed at which the attraction takes all motion of the lightest bodies, where that is slower: those that are faster pass
/// through it with little change, and a range of nanometres need not be followed at metres a second (docs/results/work-precision.md, P9).
inline constexpr double kStickingPerStep = 0.25;
/// Share of the critical step of bonds that a step takes: the fastest motion that they can make then has 31 steps in its period, its
/// frequency is right to 2e-3 and its energy to 1e-2; half of it costs twice the time and quarters both.
inline constexpr double kBondShare = 0.1;
/// Turn of a body in a step [rad] that keeps the rotor's error of phase below 1e-3.
inline constexpr double kTurnPerStep = 0.1;

/// Steps that a contact of damping ratio zeta takes at least: this many times 1 + zeta. Restitution is then within .02 of that requested
/// at any phase of touch. With the least restitution (laws/restitution.hpp) it is 29: the default of 30 is never changed.
inline constexpr double kStepsPerDamping = 5;
/// A given step is refused for pairs damped more than this (restitution below .25) when it is longer than that. Below, damping needs
/// fewer than 8 steps, and what is wrong at a step so coarse is not the damping.
inline constexpr double kStrongDamping = 0.6;

/// What the contacts that can occur ask of a step.
struct ContactLimit {
  double time = 0;          ///< half period of the stiffest [s]; 0: none can occur
  double slowest_time = 0;  ///< of the most sluggish body's [s]
  std::string who;          ///< "body 17 (rock) on fixed steel"
  double damped_rate = 0;   ///< omega (1 + zeta) of the pairs that are strongly damped [1/s]
  std::string most_damped;  ///< the fastest of them
};
/// Of the bodies that there are now, and of those that join; the same on every rank. Collective.
/// in   joining   by this rank: their speeds count as those of the scene's bodies do at the start
ContactLimit limit_of_contacts(const mpi::Communicator& comm, const SolverScene& scene, const ParticleSet& p,
                               std::span<const ParticleRecord> joining = {});
/// Throws RunInvalid when the step of a run is too long for the contacts of bodies that are about to join.
/// in   step   of the run, for the message
void check_step(const StepSize& run, const ContactLimit& with_them, const Settings& settings, std::int64_t step);

/// The smallest of
///   contact   pi / sqrt(k n^(2/q) W) / steps_per_contact over all materials that can meet; W sums over both bodies the
///             largest inverse mass of a contact anywhere on the surface, 1/m + max_r |[r]x^T I^-1 [r]x| (a ball turns by friction only,
///             whose share of the stiffness counts instead); n = 4 features (a face on a face), 8 where a shape has concave edges
///             (faces in a valley), 1 for spheres and walls without edges;
///             gather = "pairs" counts ContactExtent::of_rough_pair in place of n^(2/q)
///   damping   the same over kStepsPerDamping (1 + zeta), where a pair's restitution is so low that this is more than steps_per_contact
///   approach  kMarginPerStep times the sum of margins over the fastest approach (approach.hpp) of the scene as it starts. What is
///             fast without approaching anything is watched in every step instead (pass_through.hpp)
///   crossing  kRangePerStep of the range of an attraction over the fastest impact expected of its materials, or kStickingPerStep of it
///   over
///             the speed at which their lightest bodies stick, whichever is longer
///   spin      kTurnPerStep / |w|, of the bodies as they start
/// Source: docs/reference/contact-law.md section 3.5, with the exact maximum in place of its bound R^2 / I_min, which slender bodies never
/// reach (a factor 2.6 for an elongated asteroid); docs/reference/validation-plan.md section 4.3. Collective.
/// A given step is taken as it is. Throws UsageError when it is more than kMaxCritical critical steps, or too long for
/// the damping of a pair.
StepSize derive_step_size(const mpi::Communicator& comm, const SolverScene& scene, const ParticleSet& p);

/// Warned of from here on: the most sluggish body's contact lasts this many times the one that limits the step. A grading of
/// 1 : 10 in size has 30; a run beyond 300 spends nearly all its steps on a few light bodies.
inline constexpr double kUnevenContacts = 300;

/// Beyond this many critical steps of the stiffest contact that can occur a given step is refused at the start. In between it
/// is warned of: the contacts that do occur may be softer, and the guard of the energy watches them.
inline constexpr double kMaxCritical = 2.5;

}  // namespace scree
