// What one rank holds of a run between two steps: bodies, pairs, walls, time, totals. Measures are functions of it, and the parts of a
// step change it one after the other (simulation.hpp).
#pragma once

#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "solver/bodies/fluid.hpp"
#include "solver/bodies/motion.hpp"
#include "solver/neighbours/bond_list.hpp"
#include "solver/neighbours/fragment_masses.hpp"
#include "solver/neighbours/pair_list.hpp"
#include "solver/phases.hpp"
#include "solver/ranks/body_facts.hpp"
#include "solver/state/effect.hpp"
#include "solver/state/run_totals.hpp"
#include "solver/state/step_clock.hpp"

namespace scree {

/// What changes a result and costs too much for every step is done in these: never when lists are rebuilt, which differs between numbers
/// of ranks and after a restart. Bodies may be so many steps outside the domain before they are removed.
inline constexpr std::int64_t kReviewSteps = 16;
/// Outlets take bodies out in these steps. A multiple of kReviewSteps, so that lists are rebuilt once for both.
inline constexpr std::int64_t kExchangeSteps = 2 * kReviewSteps;

class Sleep;

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
  std::vector<WallState> walls;
  std::vector<DriveState> drives;  ///< of each wall, the same on every rank; empty where none answers to force
  BodyFacts facts;
  std::int64_t largest_id = -1;  ///< that a body or a wall has or had, at any time
  StepClock clock;
  RunTotals totals;  ///< of this rank
  PhaseTimes times{};
  std::vector<std::unique_ptr<Effect>> effects;  ///< that the scene needs, in the order of effects/effects.cpp
  Sleep* sleep = nullptr;                        ///< of these, where bodies may sleep: asked by the force stage which pairs are due

  const FluidForces* fluid_forces() const { return fluid ? &*fluid : nullptr; }
  /// Walls as they are at the present time.
  void set_walls();
  /// One of the effects by its class; null where the scene has none.
  template <class Kind>
  Kind* effect() const {
    for (const std::unique_ptr<Effect>& effect : effects) {
      if (auto* const found = dynamic_cast<Kind*>(effect.get())) return found;
    }
    return nullptr;
  }
};

/// Of a body [J]: against gravity, buoyancy included, on the way that it has gone through periodic axes.
double potential_energy(const RunState& s, const ParticleSet& p, std::size_t body);
/// The same of a body at any place.
double potential_energy_at(const RunState& s, const ParticleSet& p, std::size_t body, const Vec3& place);
/// The second kick of the present step for a body that touches nothing.
void finish_in_free_flight(const RunState& s, ParticleSet& p, std::size_t body);

/// As far from a place as an owned body reaches that moves, or whose wall answers to force [m].   Cost: O(bodies)
double farthest_from_wall(const RunState& s, std::size_t wall, const Vec3& place);
/// A point of a wall at a distance from its origin has moved no further by its turn than this times the distance.
double chord_of_turn(const WallState& from, const WallState& to);
/// How far walls have moved between two states with respect to any owned body that moves, at most [m].
double walls_moved(const RunState& s, const std::vector<WallState>& from, const std::vector<WallState>& to);
/// Fastest point of a wall near an owned body that moves [m/s].
double fastest_wall(const RunState& s, const std::vector<WallState>& walls);

/// The part of omega^2 [1/s^2] that a wall's own inertia brings to its contacts; 0 of one that has none.
double wall_share_of_frequency(const RunState& s, std::size_t wall);

/// Adds what the present forces do to the walls in a time dt.
void add_wall_effects(const RunState& s, double dt, WallTotals& totals);
/// The same where all pairs of walls are those of balls in blocks, whose places are in rows.
/// in   outside   pairs that may touch and do not lie in blocks, each once
void add_wall_effects_of_balls(const RunState& s, const std::vector<BallRow>& rows, double dt, std::span<const std::int32_t> outside,
                               WallTotals& totals);
/// What the present damping and friction forces take from a body in a time dt [J].
double contact_dissipation(const ParticleSet& p, std::size_t body, double dt);
/// Adds that to each owned body. As for walls, the forces of the last step count in full, and readers of a total take half of them back.
void add_dissipation(RunState& s, double dt);

}  // namespace scree
