// The statistics of a run: over time, by region, material and shape, with confidence intervals; tables, JSON and charts.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "post/statistics/statistics_data.hpp"

namespace scree {

/// Reads the chosen frames once and works out everything.
///
/// in   folder   where series.csv, walls.csv and profiles.csv (values of every frame) go, row by row; empty: nowhere
/// Fails: UsageError (an option that does not fit the run), InputError (a damaged frame, named), SystemError.
/// Memory: one frame in each process and the averages, whatever the number of frames.
Statistics run_statistics(const Run& run, const StatisticsOptions& options, const std::string& folder);

/// summary.csv, a CSV for each table, force_chains.csv, energies.csv (from log.csv) and statistics.json.
/// Returns the names of the files.
std::vector<std::string> write_statistics(const Run& run, const Statistics& statistics, const std::string& folder);
nlohmann::json json_of(const Run& run, const Statistics& statistics);

std::vector<NamedChart> charts_of(const Statistics& statistics);

/// The averages that matter most, some lines for the terminal.
std::string summary_of(const Statistics& statistics);

}  // namespace scree
