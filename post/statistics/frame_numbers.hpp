// All numbers of one frame in one row, and what stands where in it.
#pragma once

#include <memory>
#include <unordered_map>

#include "post/run/run_bodies.hpp"
#include "post/statistics/space_measures.hpp"
#include "post/statistics/statistics_data.hpp"

namespace scree {

/// A frame with what is counted in it.
struct CountedFrame {
  Frame frame;
  bool is_whole = true;   ///< no body of the frame was left out
  double mass_above = 0;  ///< the level of --discharge, else anywhere: of all particles, those included that have left [kg]
};

/// What is worked out for each frame. Made once, before the frames.
struct StatisticsPlan {
  StatisticsPlan(const Run& run, const StatisticsOptions& options);

  const Run& run;
  StatisticsOptions options;
  std::unique_ptr<SceneFacts> facts;
  std::vector<Group> groups;
  std::vector<Quantity> quantities, wall_quantities;
  bool wall_answers = false;            ///< some wall moves in answer to force
  bool wall_turns = false;              ///< some wall turns about an axis of its own
  bool has_endless_fall = false;        ///< gravity acts along a periodic axis
  std::vector<StatisticsTable> tables;  ///< without values
  std::vector<ProfileBins> profiles;    ///< of the first tables
  Within within;
  BodyExtent extent;                                      ///< of the particles over all frames
  std::unordered_map<std::int64_t, std::uint8_t> kind;    ///< for the mixing index, by id: 0 or 1
  std::vector<std::pair<std::string, std::string>> gaps;  ///< what some bodies have no part in, and why
  int discharge_axis = -1;
  double discharge_level = 0;

  std::size_t size() const { return wall_begin + walls() * wall_quantities.size(); }
  std::size_t walls() const { return run.scene.walls.size(); }
  std::size_t at(std::size_t group, std::size_t quantity) const { return group * quantities.size() + quantity; }
  std::size_t index_of(const std::string& quantity) const;
  std::size_t table_begin(std::size_t table) const;  ///< then row by row: coordinate, column
  std::size_t wall_begin = 0;

  CountedFrame load(std::size_t frame) const;
  std::vector<double> numbers_of(const CountedFrame& counted) const;

 private:
  void note_turning_box();
  void note_potential_energy();
  void add_groups();
  void add_profiles(double low, double high);  // between these heights [m]
  void add_distributions(double diameter);     // [m]
  void choose_kinds(const RunBodies& bodies);
  void choose_halves(char axis);
  void note_coarse_cells(const Frame& frame, char axis);
  void read_masses();
  double discharged(const CountedFrame& counted) const;
  void read_discharge(const std::string& text);
  // what only the group of all has
  void add_whole(const CountedFrame& counted, const FrameView& view, const ForceChains& chains, std::vector<double>& row) const;
  void add_tables(const FrameView& view, const ForceChains& chains, std::vector<double>& row) const;
  void add_walls(const Frame& frame, std::vector<double>& row) const;

  /// Mass over time: what was there at the start or has come in, and what was removed [kg].
  struct Steps {
    std::vector<double> time, mass;  ///< mass: of all up to this one
    bool is_known = true;            ///< the table is there
    double at(double time) const;
  };
  double start_mass_ = 0;
  Steps came_in_, removed_;
};

}  // namespace scree
