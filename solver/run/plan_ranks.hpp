// What a run would take on more ranks than this machine has, for --plan --ranks: bodies are cut and ghosts counted; times follow from a
// model.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/geometry/vec3.hpp"

namespace scree {

/// The bodies of a scene, as a cut takes them.
struct BodiesToCut {
  std::vector<std::int64_t> id;
  std::vector<Vec3> x;        ///< [m]
  std::vector<double> reach;  ///< bounding radius, margin and half the skin of the lists [m]
  std::vector<double> work;   ///< predicted, any unit
};

/// Of a step on so many ranks. A share of its time each, adding up to 1 with the time that bodies take.
struct StepOnRanks {
  int ranks = 1;
  double seconds = 0;     ///< of a step
  double efficiency = 1;  ///< the time of one rank over that of all ranks together
  double bodies_mean = 0, bodies_max = 0, ghosts_max = 0, neighbours_max = 0;
  double imbalance = 1;
  double of_ghosts = 0, of_messages = 0;
};

/// step = bodies imbalance c + ghosts g + (neighbours + log2 ranks) latency + bytes / bandwidth, all of the part that has the most.
///
/// A ghost takes g = 0.17 c, as measured on two ranks (docs/results/scaling.md); a latency of 2 us and 1 GB/s for each rank are assumed.
/// in   body   processor time of a body and step on one rank [s]
/// Cost: a cut by Zoltan on this process, O(bodies log ranks); ghosts as many as there are.
/// Limits: bodies are cut where they are now; images through periodic sides, output and noise of the network are not counted.
StepOnRanks step_on_ranks(const BodiesToCut& bodies, double body, int ranks);

/// The time of a step: "747 us", "12.7 ms", "2.5 s".
std::string step_text(double seconds);

/// For the user.   in   steps   of the run   spread   how many times longer or shorter it may be; 1: not said   memory   of a rank
std::string text_of(const StepOnRanks& step, double steps, double spread, const std::string& memory);

}  // namespace scree
