// Which pairs conduct through the gas between them, and how far apart they are.
#pragma once

#include <vector>

#include "core/distance/mesh_distance.hpp"
#include "core/search/multilevel_grid.hpp"
#include "solver/effects/heat/conductance.hpp"
#include "solver/state/effect.hpp"
#include "solver/state/run_state.hpp"

namespace scree {

/// Distance of two surfaces as they were drawn, or of a body and a wall zone [m]; at most `reach` where that is less. Not above 0 where
/// they touch.   in/out   nearest   of two meshes: see mesh_distance()   Cost: of two meshes one distance query.
double gap_of(const PairView& view, double reach, MeshDistanceScratch& scratch, TrianglePair& nearest);

/// A list of its own: gaps are wider than what contacts reach. Computed by both owners of a pair from the same bits.
class GasGaps {
 public:
  struct Gap {
    NearPair pair;
    TrianglePair nearest{-1, -1};
    double conductance = 0;  ///< [W/K]; 0: too wide
  };

  explicit GasGaps(const Scene& scene);
  double range() const { return range_; }  ///< [m]

  /// Lists all pairs that may come within the range. After ghosts were made.
  void find(const StepParts& parts);
  /// Conductances of where bodies are now. Threads: parallel inside.   Cost: a root for two balls, a distance query for two meshes.
  void measure(const RunState& s);
  /// In ascending order of keys.
  const std::vector<Gap>& gaps() const { return gaps_; }

 private:
  GapConductance conductance_;
  double range_;
  std::vector<Gap> gaps_;
  MultilevelGrid grid_;
  std::vector<MeshDistanceScratchPtr> scratch_;  // of each thread
};

}  // namespace scree
