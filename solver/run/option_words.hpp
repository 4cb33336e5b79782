// How messages name what a user gives to a run: as words of scree-solver's command line, or as arguments of the engine.
#pragma once

#include <fmt/format.h>

#include <string>

namespace scree {

struct OptionWords {
  bool of_engine = false;

  /// The run folder, "-o bed.run" or "run = \"bed.run\"".
  std::string folder(const std::string& path) const { return of_engine ? fmt::format("run = \"{}\"", path) : "-o " + path; }
  /// What the run starts from, "--restart latest" or "restart = \"latest\"".
  std::string restart(const std::string& from) const { return of_engine ? fmt::format("restart = \"{}\"", from) : "--restart " + from; }
  /// The two words that stand for a checkpoint.
  std::string restart_choice() const { return of_engine ? "restart = \"latest\" or \"auto\"" : "--restart latest or auto"; }
};

}  // namespace scree
