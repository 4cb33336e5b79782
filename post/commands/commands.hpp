// The commands of scree-post. Each gives what to print and never prints itself.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <string>
#include <vector>

#include "post/run/run_folder.hpp"
#include "post/statistics/statistics.hpp"

namespace scree {

struct CommandResult {
  std::string output;                ///< for stdout
  std::vector<std::string> notices;  ///< for stderr, one line each
};

struct Command {
  CLI::App* options = nullptr;  ///< true when it was asked for
  std::function<CommandResult()> run;
};

/// What several commands take.
struct RunOptions {
  std::string folder;
  std::string frames = "all";
  int jobs = 0;
  bool skip_damaged = false;

  void add_to(CLI::App& command, const char* what_frames);  ///< null: no --frames
  void add_pool_to(CLI::App& command);                      ///< --jobs and --skip-damaged alone
  /// Opens the run; the notices are what the user must know of its state.
  Run open(std::vector<std::string>& notices) const;
};

/// Of --within, for statistics, reports, pictures and films.
inline constexpr const char* kWithinHelp =
    "Only bodies that are in a wall (its name or id: its inside, the box around a mesh and above), in a region (as in "
    "box:x0,y0,z0,x1,y1,z1), "
    "or all; default: bodies that have left the equipment are left out";

/// What report and statistics count, and how.
struct MeasureOptions {
  std::vector<std::string> apparatus, without;
  bool count_all = false;
  std::string mixing = "auto", repose = "none", discharge, within;

  void add_to(CLI::App& command);
  /// Sets the run and the options accordingly. Returns what was set apart, for the user; empty: nothing.
  std::string apply(Run& run, StatisticsOptions& options) const;
};

/// Looking at a run: report, paraview, vtk, picture, film.
std::vector<Command> add_view_commands(CLI::App& app);
Command add_picture(CLI::App& app);
Command add_film(CLI::App& app);
Command add_statistics(CLI::App& app);
Command add_bed(CLI::App& app);
/// Numbers: statistics, compare, error-vs-time, bodies, contacts, scaling.
std::vector<Command> add_number_commands(CLI::App& app);

}  // namespace scree
