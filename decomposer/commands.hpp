// The commands of the tool, without printing: main prints what they return.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "core/partition/partition.hpp"
#include "decomposer/packing/child_solver.hpp"

namespace scree {

/// Skin of the body lists that costs are computed with, of the smallest radius.
inline constexpr double kDefaultSkin = 0.1;

struct CommandResult {
  std::string output;                 ///< for stdout
  std::vector<std::string> notices;   ///< for stderr, one line each
  std::vector<std::string> warnings;  ///< the same, of what is probably a slip
};

struct PackOptions {
  std::string case_path, output;
  std::vector<std::string> changes;  ///< "KEY=VALUE" each (case_settings.hpp)
  int ranks = 0;                     ///< 0: not cut
  CutMethod cut = CutMethod::rcb;
  std::string preview;  ///< NAME.vtp and NAME.csv of the cut; empty: none
  std::string sizes;    ///< NAME.csv and NAME.svg of the sizes asked and got; empty: none
  ChildSolver solver;
};
struct PartitionOptions {
  std::string scene_path, output;
  int ranks = 0;
  CutMethod cut = CutMethod::rcb;
  std::string preview;  ///< as with pack
};
struct CompareOptions {
  std::string scene_path;
  std::vector<int> parts;
  std::vector<std::string> cuts;  ///< names of cut methods
  double skin = kDefaultSkin;     ///< of the smallest radius
};
struct TileOptions {
  std::string scene_path, output;
  std::string frame_path;  ///< "": the scene as it is
  std::array<int, 3> copies{1, 1, 1};
  double duration = -1;  ///< of the new scene [s]; < 0: as in the old one
};

/// in   command   words of the command line, for the provenance
CommandResult check_command(const std::string& case_path, const std::vector<std::string>& changes);
CommandResult pack_command(const PackOptions& options, const std::vector<std::string>& command);
CommandResult partition_command(const PartitionOptions& options, const std::vector<std::string>& command);
CommandResult compare_command(const CompareOptions& options);
CommandResult tile_command(const TileOptions& options, const std::vector<std::string>& command);

}  // namespace scree
