// What a packing gives: the scene, and what is told of it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/base/provenance.hpp"
#include "core/storage/start_state.hpp"
#include "decomposer/case/case.hpp"
#include "decomposer/packing/child_solver.hpp"
#include "decomposer/packing/facets.hpp"

namespace scree {

/// Draws of place and orientation that a particle is given before the packing counts as impossible. Measured with
/// 10 000 rocks of 320 triangles, 16 to 20 mm, on one core: a solid fraction of 0.30 in 3 s, 0.35 in 9 s, 0.37 in 20 s
/// (packer.hpp says how); a lattice or a settled packing is the way to more.
inline constexpr std::uint64_t kAttempts = 50000;

/// Largest share of the margins that an impact should use up by the design rule (docs/reference/validation-plan.md section 2 of the
/// design papers: depth/margin at most 0.5, with a reserve for several contacts at once).
inline constexpr double kOverlapShare = 0.4;

struct PackingReport {
  std::vector<double> solid_fraction;  ///< of each population in its region
  /// Of each population that has bodies, of balls of equal volume, ascending [m]: of bodies that start as pieces those of the whole bodies.
  std::vector<std::vector<double>> diameters;
  double particle_volume = 0;   ///< of all moving and fixed bodies [m^3]
  double container_volume = 0;  ///< of the first box, cylinder or sphere wall [m^3]; 0 when there is none
  std::uint64_t attempts = 0;
  double fastest_impact = 0;  ///< estimate [m/s]
  double impact_overlap = 0;  ///< that it makes of the heaviest body and the softest pair [m]
  const char* margin_from = "derived";
  /// How far the surface at which a shape touches is from the one that was drawn, at scale 1 [m].
  struct Rounding {
    std::string shape;
    double margin = 0, mean = 0, largest = 0, radius = 0;
  };
  std::vector<Rounding> roundings;
  std::vector<Facets> facets;  ///< of mesh walls that balls may meet
  double overlap_share = 0;    ///< share of the margins that it uses up; above 1 the run will stop
  std::vector<std::string> notices;
  std::vector<std::string> case_warnings;  ///< case_warnings.hpp
};

struct PackedScene {
  Scene scene;                      ///< without provenance and partition
  std::optional<StartState> start;  ///< of bodies that come from a run
  std::vector<InputRecord> inputs;  ///< the case and every shape file, with its own history
  PackingReport report;
};

}  // namespace scree
