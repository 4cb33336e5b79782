// What statistics are asked for, and what they are (statistics.hpp).
#pragma once

#include <optional>
#include <string>
#include <unordered_set>
#include <vector>

#include "core/chart/svg_chart.hpp"
#include "post/run/frame_pool.hpp"
#include "post/run/region.hpp"
#include "post/run/run_folder.hpp"
#include "post/statistics/block_average.hpp"
#include "post/statistics/flow.hpp"

namespace scree {

struct StatisticsOptions {
  std::vector<std::size_t> frames;             ///< indices, ascending
  std::vector<Region> regions;                 ///< each a group
  bool by_material = false, by_shape = false;  ///< a group of each
  std::optional<Region> container;             ///< box or cylinder; else that of the scene (container_of)
  std::vector<std::string> profiles;           ///< "z:20", "x", "r:10": axis and number of bins; empty: the axis of gravity
  std::size_t blocks = 10;
  std::string mixing = "auto";  ///< material | shape | population | size | half-x | half-y | half-z | none; auto: material when there are
                                ///< two, else halves along gravity
  std::string repose = "none";  ///< cone | slope | none
  std::string discharge;        ///< "z=0.1": mass that has gone below that height; empty: what was removed at the sides of the domain
  std::unordered_set<std::int64_t> without{};  ///< ids of bodies and walls that are left out with their contacts
  std::string within{};                        ///< bodies that have left are left out: see Within::named; empty: the equipment
  FramePool pool{};
};

/// A number of the output by its standard name.
struct Quantity {
  std::string name, unit, meaning;
};

/// Averages of columns over a coordinate: a profile or a distribution.
struct StatisticsTable {
  std::string name, title;
  Quantity coordinate;
  std::vector<double> coordinates;
  std::vector<Quantity> columns;
  std::vector<std::vector<Average>> values;  ///< by column, by coordinate
};

/// A quantity over time, thinned so that it does not grow with the number of frames.
struct Series {
  std::vector<double> time, value;
};

struct Statistics {
  std::vector<std::string> groups;  ///< "all" first
  std::vector<Quantity> quantities;
  std::vector<std::vector<Average>> averages;  ///< by group, by quantity
  std::vector<StatisticsTable> tables;
  std::vector<std::string> walls;       ///< id and name
  std::vector<std::string> wall_names;  ///< as a reader calls them
  std::vector<Quantity> wall_quantities;
  std::vector<std::vector<Average>> wall_averages;  ///< by wall, by quantity
  std::vector<Series> series;                       ///< of group "all", by quantity
  std::vector<std::vector<Series>> wall_series;
  Flow flow;                                      ///< through inlets and outlets, from the first to the last of the frames
  std::vector<std::vector<std::int64_t>> chains;  ///< force chains at the last frame, ids
  std::size_t frames = 0, blocks = 0;
  double first_time = 0, last_time = 0;
  /// Quantities that were requested and are missing in some or all frames, with the reason.
  std::vector<std::pair<std::string, std::string>> gaps;
  std::vector<std::string> skipped;  ///< damaged frames, and a table that is not there
  std::string left;                  ///< which bodies have left and are left out; empty: none
  const Average& of(const std::string& quantity, std::size_t group = 0) const;
};

/// A chart and the table that it shows: NAME.svg and the CSV beside it.
struct NamedChart {
  std::string name, csv;
  LineChart chart;
};

}  // namespace scree
