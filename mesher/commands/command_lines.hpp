// The commands of scree-mesher as a user types them: names, options and their help.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <string>
#include <vector>

#include "mesher/commands/commands.hpp"

namespace scree {

/// A command and what runs it; the words of the command line go into the provenance of what it writes.
struct MesherCommand {
  CLI::App* app;
  std::function<CommandResult(const std::vector<std::string>& words)> run;
};

/// Adds every command to the application.
std::vector<MesherCommand> add_commands(CLI::App& app);

}  // namespace scree
