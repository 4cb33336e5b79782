// All numbers of one frame in one row, and what stands where in it.
#pragma once

#include <memory>
#include <unordered_map>

#include "post/statistics/space_measures.hpp"
#include "post/statistics/statistics.hpp"

namespace scree {

/// What is worked out for each frame. Made once, before the frames.
struct StatisticsPlan {
  StatisticsPlan(const Run& run, const StatisticsOptions& options);

  const Run& run;
  StatisticsOptions options;
  std::unique_ptr<SceneFacts> facts;
  std::vector<Group> groups;
  std::vector<Quantity> quantities, wall_quantities;
  bool wall_answers = false;            ///< some wall moves in answer to force
  std::vector<StatisticsTable> tables;  ///< without values
  std::vector<ProfileBins> profiles;    ///< of the first tables
  std::vector<std::uint8_t> kind;       ///< for the mixing index, by id
  int discharge_axis = -1;
  double discharge_level = 0, scene_mass = 0;

  std::size_t size() const { return wall_begin + walls() * wall_quantities.size(); }
  std::size_t walls() const { return run.scene.walls.size(); }
  std::size_t at(std::size_t group, std::size_t quantity) const { return group * quantities.size() + quantity; }
  std::size_t index_of(const std::string& quantity) const;
  std::size_t table_begin(std::size_t table) const;  ///< then row by row: coordinate, column
  std::size_t wall_begin = 0;

  /// A frame with what is counted in it.
  Frame load(std::size_t frame) const;
  std::vector<double> numbers_of(const Frame& frame) const;

 private:
  void add_groups();
  void add_profiles(double low, double high);  // between these heights [m]
  void add_distributions(double diameter);     // [m]
  void choose_kinds(const FrameView& first);
  void read_discharge(const std::string& text);
  void add_whole(const FrameView& view, const ForceChains& chains, std::vector<double>& row) const;  // what only the group of all has
  void add_tables(const FrameView& view, const ForceChains& chains, std::vector<double>& row) const;
  void add_walls(const Frame& frame, std::vector<double>& row) const;
};

}  // namespace scree
