// What can be said of a run: energies, loads of walls, counts, the hash of its state. Functions of a state that change nothing;
// every one is collective, and every rank gets the value of the whole scene.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "solver/state/energies.hpp"
#include "solver/step/simulation.hpp"

namespace scree {

/// Potential energies are about the origin in which the scene is computed (origin.hpp).
Energies energies_of(const RunState& s);
/// What has to be added for them to be about the world's origin [J]. Collective, unless both are the same.
double potential_about_world(const RunState& s, const Vec3& origin);
/// What the energies of a leapfrog swing by at this step [J]: h^2 / 8 times the sum of squared forces over masses. The
/// difference of both is kept exactly by linear contacts at any stable step.
double shadow_energy_gap(const RunState& s);
/// The body with the most kinetic energy, the lower id among equals, and that energy [J]; -1 without a body.
std::pair<std::int64_t, double> fastest_body(const RunState& s);

/// What a wall received since the start.
struct WallLoad {
  Vec3 force;                ///< now, on the wall [N]
  Vec3 torque;               ///< now, about the origin of the computation [N m]
  Vec3 impulse;              ///< since the start [N s]
  double surface_power = 0;  ///< now, of a surface that moves along itself on the bodies [W]
  /// Of the wall on the bodies, now [W].
  double power(const WallState& wall) const {
    return surface_power - dot(force, wall.velocity) - dot(torque - cross(wall.position, force), wall.angular_velocity);
  }
};
std::vector<WallLoad> wall_loads_of(const RunState& s);
/// Loads and walls with places and torques about the world's origin again, see scene/origin.hpp.
void move_loads_to_world(std::vector<WallLoad>& loads, std::vector<WallState>& walls, const Vec3& origin);

/// What effects add to a row of the log. Collective.
std::vector<Column> columns_of_effects(const RunState& s, const Energies& energies);

std::int64_t body_count(const RunState& s);
std::int64_t free_body_count(const RunState& s);  ///< of those that are free to move
std::int64_t contact_count(const RunState& s);
std::int64_t deep_pair_count(const RunState& s);  ///< pairs in contact that are deeper than their maximum overlap
std::int64_t active_pair_count(const RunState& s);
std::int64_t bodies_outside(const RunState& s);  ///< of the domain

/// Number and mass [kg] of all bodies removed since the start.
struct RemovedTotals {
  double count = 0, mass = 0;
};
RemovedTotals removed_totals(const RunState& s);
/// The same of those that each outlet took out.
std::vector<RemovedTotals> outlet_totals(const RunState& s);
/// The same of all bodies that joined after the start; those that came in again count again.
RemovedTotals arrived_totals(const RunState& s);
/// Number of all bodies that joined after the start.
std::int64_t arrived_count(const RunState& s);
/// What a checkpoint keeps of the totals.
RunTotals overall_totals(const RunState& s);

/// 128-bit hash over the bits of all bodies and the state of all pairs, the same for any distribution over ranks.
std::string state_hash(const RunState& s);

/// What this rank did and held; not collective.
RankMeasures rank_measures(Simulation& simulation);

}  // namespace scree
