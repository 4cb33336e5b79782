// The commands of the tool, without printing: main prints what they return.
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace scree {

struct CommandResult {
  std::string output;                 ///< for stdout
  std::vector<std::string> notices;   ///< for stderr, one line each
};

struct PackOptions {
  std::string case_path, output;
  int ranks = 0;   ///< 0: not cut
};
struct PartitionOptions {
  std::string scene_path, output;
  int ranks = 0;
};

/// in   command   words of the command line, for the provenance
CommandResult check_command(const std::string& case_path);
CommandResult pack_command(const PackOptions& options, const std::vector<std::string>& command,
                           const std::function<void(double, double)>& progress = {});
CommandResult partition_command(const PartitionOptions& options, const std::vector<std::string>& command);

}  // namespace scree
