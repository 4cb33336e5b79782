// What a cut of a scene would cost on many ranks: counted, not simulated. The solver's ghosts are those counted here.
#pragma once

#include <string>
#include <vector>

#include "core/partition/partition.hpp"
#include "core/storage/scene_file.hpp"

namespace scree {

/// Of one cut into so many parts.
struct CutMeasures {
  CutMethod method = CutMethod::rcb;
  int parts = 1;
  double imbalance = 1;                    ///< largest over mean predicted work
  double bodies_mean = 0, bodies_max = 0;  ///< of a part
  double neighbours_mean = 0, neighbours_max = 0;
  double ghosts_mean = 0, ghosts_max = 0;  ///< that a part receives
  double bytes_mean = 0, bytes_max = 0;    ///< that a part sends in a step
  double moved = 0;                        ///< share of the bodies that change part when the scene is cut again after a small motion
  double seconds = 0;                      ///< that the cut took on this process
};

/// Cuts a scene as the solver would, and counts.
///
/// How: a body is a ghost of every other part whose box of bounding balls (margin and half a skin included) it reaches into. The
/// small motion is 1 % of each body's radius, in a random direction.
/// in   work       of each body, see predicted_work
/// in   skin       of the body lists [m], see solver/step/neighbour_lists.cpp
/// Cost: O(bodies x parts) for boxes, O(bodies log parts) else, and for `body` the number of ghosts.   One process.
CutMeasures measure_cut(const Scene& scene, const std::vector<double>& work, CutMethod method, int parts, double skin);

/// A table with one line for each cut, comma separated, with a header.
std::string cut_table(const std::vector<CutMeasures>& cuts);

/// Radius of the ball about each body's centre that holds it [m].
std::vector<double> bounding_radii(const Scene& scene);

}  // namespace scree
