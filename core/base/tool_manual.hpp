// The manual page and the shell completion of a tool, written from its command line: they cannot fall behind it.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <utility>
#include <vector>

namespace scree {

/// A manual page (section 1) in the man macros of roff.
///
/// in   examples   command lines, each with its comment, as in make_command_line
std::string manual_page(const CLI::App& app, const std::vector<std::pair<std::string, std::string>>& examples);

/// A completion script for bash, which zsh reads too after `autoload bashcompinit && bashcompinit`: commands, options,
/// the words that an option takes, and files for the rest.
std::string bash_completion(const CLI::App& app);

}  // namespace scree
