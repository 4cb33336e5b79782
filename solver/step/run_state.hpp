// What one rank holds of a run between two steps: bodies, pairs, walls, time, totals. Measures are functions of it, and the parts of a
// step change it one after the other (simulation.hpp).
#pragma once

#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include "solver/bodies/fluid.hpp"
#include "solver/bodies/motion.hpp"
#include "solver/neighbours/bond_list.hpp"
#include "solver/neighbours/fragment_masses.hpp"
#include "solver/neighbours/pair_list.hpp"
#include "solver/phases.hpp"
#include "solver/ranks/body_facts.hpp"
#include "solver/step/run_totals.hpp"
#include "solver/step/sleep.hpp"
#include "solver/step_size/step_size.hpp"

namespace scree {

/// Where a run stands in time. A step is made in 2^level equal parts; the level is 0 but for quantised steps.
struct StepClock {
  StepSize size;
  std::int64_t step = 0;  ///< whole steps since the start
  std::int64_t level = 0;
  std::int64_t substep = 0;  ///< parts of the present step that are done
  double dt = 0;             ///< what the bodies move by at once [s]: size.step / 2^level

  double time() const { return static_cast<double>(step) * size.step + static_cast<double>(substep) * dt; }
  void set_level(std::int64_t to) {
    level = to;
    dt = std::ldexp(size.step, -static_cast<int>(to));
  }
  void advance() {
    if (++substep < std::int64_t{1} << level) return;
    substep = 0;
    ++step;
  }
};

/// What changes a result and costs too much for every step is done in these: never when lists are rebuilt, which differs between numbers
/// of ranks and after a restart. Bodies may be so many steps outside the domain before they are removed.
inline constexpr std::int64_t kReviewSteps = 16;
/// Outlets take bodies out in these steps. A multiple of kReviewSteps, so that lists are rebuilt once for both.
inline constexpr std::int64_t kExchangeSteps = 2 * kReviewSteps;

/// A force that the case gives to a body.
struct GivenForce {
  std::size_t row;  ///< of an owned body
  Vec3 force;       ///< [N]
};

struct RunState {
  RunState(const mpi::Communicator& on, const SolverScene& of);

  const mpi::Communicator& comm;
  const SolverScene& scene;
  const Integrator integrator;
  const std::optional<FluidForces> fluid;  ///< of a scene that has one
  ParticleSet particles;
  PairList pairs;
  std::optional<BondList> bonds;            ///< of a scene that has some
  std::optional<FragmentMasses> fragments;  ///< the same
  std::vector<GivenForce> given_forces;
  std::optional<Sleep> sleep;  ///< of a scene whose bodies may sleep
  std::vector<WallState> walls;
  BodyFacts facts;
  std::int64_t largest_id = -1;  ///< that a body or a wall has or had, at any time
  StepClock clock;
  RunTotals totals;                  ///< of this rank
  std::vector<LoadEntry> loads;      ///< of the present forces, on walls that have a load map
  std::vector<ImpactEntry> impacts;  ///< of the present forces, where impacts are recorded
  PhaseTimes times{};

  const FluidForces* fluid_forces() const { return fluid ? &*fluid : nullptr; }
  /// Walls as they are at the present time.
  void set_walls();
};

/// Of a body [J]: against gravity, buoyancy included, on the way that it has gone through periodic axes.
double potential_energy(const RunState& s, const ParticleSet& p, std::size_t body);
/// The second kick of the present step for a body that touches nothing.
void finish_in_free_flight(const RunState& s, ParticleSet& p, std::size_t body);

/// Agrees what is known of all bodies, and of the contacts that they can have, after bodies came or went. The step stays. Collective.
void agree_on_bodies(RunState& s);

/// How far walls have moved between two states with respect to any owned body that moves, at most [m].
double walls_moved(const RunState& s, const std::vector<WallState>& from, const std::vector<WallState>& to);
/// Fastest point of a wall near an owned body that moves [m/s].
double fastest_wall(const RunState& s, const std::vector<WallState>& walls);

/// Adds what the present forces do to the walls in a time dt.
void add_wall_effects(const RunState& s, double dt, WallTotals& totals);
/// What the present damping and friction forces take from a body in a time dt [J].
double contact_dissipation(const ParticleSet& p, std::size_t body, double dt);
/// Adds that to each owned body. As for walls, the forces of the last step count in full, and who reads a total takes half of them back.
void add_dissipation(RunState& s, double dt);

}  // namespace scree
