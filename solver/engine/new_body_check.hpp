// Whether bodies that a program gives can join a run: their places, their sizes, and what stands there already.
#pragma once

#include <cstdint>
#include <string>
#include <unordered_set>
#include <vector>

#include "core/placing/placed_body.hpp"
#include "solver/state/run_state.hpp"

namespace scree {

/// Of the smaller body's radius: new bodies that overlap others by more are warned of. A contact of balls in a bed overlaps by less.
inline constexpr double kOverlapWorthWarning = 0.02;

class NewBodyCheck {
 public:
  struct Warning {
    double overlap = 0;  ///< the largest, over the radius of the smaller body; 0: nothing is to be warned of
    std::string text;    ///< in one line
  };
  explicit NewBodyCheck(const SolverScene& scene);

  /// Checks bodies of all ranks against the scene, the bodies of the run, and each other.
  /// in   mine      of this rank; places beyond a periodic side are moved into the domain
  /// in   waiting   bodies of this rank that join in the same step
  /// in   leaving   ids of bodies that leave in the same step: the same on every rank
  /// in   origin    of the scene as it is computed, in the world [m]: for messages
  /// Returns what is to be warned of, the same on every rank.
  /// Fails: throws UsageError on every rank for a place outside the domain, a size that the scene was not made for, and a body that is
  /// within another one or behind a wall. Cost: O(new bodies x bodies near their common box). Collective.
  Warning check(const RunState& s, std::vector<ParticleRecord>& mine, const std::vector<ParticleRecord>& waiting,
                const std::unordered_set<std::int64_t>& leaving, const Vec3& origin);

 private:
  struct Overlap;
  PlacedBody placed(const ParticleRecord& r) const;
  void add_overlap(const ParticleRecord& body, const ParticleRecord& other, std::vector<Overlap>& found);
  void add_overlap_of_walls(const RunState& s, const ParticleRecord& body, std::vector<Overlap>& found);

  const SolverScene& scene_;
  std::vector<PackShape> shapes_;  ///< of the scene, one for each; made at the first call
  MeshDistanceScratchPtr scratch_;
  std::vector<Vec3> vertices_;
};

}  // namespace scree
