// The history of a run as its provenance records tell it: every file behind it, and the commands that made them.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace scree {

struct ChainEntry {
  int depth = 0;                                 ///< 0: the run itself
  std::string file, sha256;                      ///< as named by what was made from it; empty for the run
  std::string tool, version, git, utc, command;  ///< empty when the file has no record: an input from outside
  std::string configuration;                     ///< case file or options, as read
};

/// The chain from the run down to the files that no tool of Scree made, depth first.
std::vector<ChainEntry> chain_of(const nlohmann::json& record);

/// A file of the chain as it is now.
struct ChainFile {
  enum class State { same, changed, missing };
  std::string file, sha256, found;  ///< as named, as recorded; path at which it was found
  State state = State::missing;
};

/// Looks for every file of the chain, each once: as it is named, then beside the run, and compares hashes.
/// Cost: reads every file that is found.
std::vector<ChainFile> check_files(const nlohmann::json& record, const std::string& run_folder);

/// Whether a program stepped the run with the engine, or a run that it started from.
bool has_program(const nlohmann::json& record);

/// Command lines that make the run again, in the order in which they must be given, each once. A run that a program stepped has none.
std::vector<std::string> commands_of(const nlohmann::json& record);

/// Words as a line for the shell, quoted where needed.
std::string shell_line(const nlohmann::json& words);

}  // namespace scree
