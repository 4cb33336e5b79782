// Two or more runs side by side: what was set differently, how the statistics differ, how the trajectories part.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "post/run/frame_pool.hpp"
#include "post/run/run_folder.hpp"
#include "post/statistics/statistics.hpp"

namespace scree {

/// A setting that is not the same in all runs. Text as in the scene; "-" where a run does not have it.
struct SettingDifference {
  std::string key;
  std::vector<std::string> values;  ///< by run
};
/// Settings, materials, pairs, walls, shapes and bodies of the scenes.
std::vector<SettingDifference> setting_differences(const std::vector<Run>& runs);

/// How far two runs are apart at one time.
struct Divergence {
  double time = 0;
  std::size_t bodies = 0;                       ///< in both, by id
  std::size_t only_first = 0, only_second = 0;  ///< in one of the runs alone
  double rms = 0, largest = 0;                  ///< of the distances between their positions [m]
  double largest_angle = 0;                     ///< between their orientations [rad]
  std::int64_t furthest = -1;                   ///< body of `largest`
};

struct TrajectoryComparison {
  std::vector<Divergence> frames;  ///< at times that both have
  double diameter = 0;             ///< mean equivalent diameter of the first run's bodies [m]
  double growth_rate = 0;          ///< of rms while it is small, by least squares of its logarithm [1/s]; NaN when it is not growing
  /// What differs, in words: bodies, contacts, walls of frames, times, numbers of frames, tables of what came in and went out, hashes of
  /// states. Empty: not a bit of them.
  std::vector<std::string> differences;
  bool identical() const { return differences.empty(); }
};
/// Frames count as of the same time when they differ by less than a hundredth of the interval between frames: with different
/// steps they fall up to a step apart, and bodies move meanwhile.
/// Fails: InputError when no two frames are of the same time.   Memory: one frame of each run per process.
TrajectoryComparison compare_trajectories(const Run& a, const Run& b, const FramePool& pool);

struct Comparison {
  std::string text;  ///< for the terminal
  std::vector<std::string> notices, files;
};
/// Writes settings.csv, statistics.csv, divergence.csv, comparison.json and divergence.svg/.png into a folder.
Comparison compare_runs(const std::vector<Run>& runs, const std::string& folder, const FramePool& pool);

}  // namespace scree
