// The command line of every tool: help that starts with examples, --version, and errors that become UsageError.
#pragma once

#include <CLI/CLI.hpp>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace scree {

/// A CLI11 application set up in the house's way: one-line purpose, examples first in --help, --version.
///
/// in   tool        "scree-mesher"
/// in   purpose     one sentence
/// in   examples    command lines, each with its comment: {"scree-mesher check rock.stl", "is it a solid?"}
/// in   libraries   what --version adds, for instance "gmsh 4.8.4, assimp 5.2"
std::unique_ptr<CLI::App> make_command_line(const std::string& tool, const std::string& purpose,
                                            const std::vector<std::pair<std::string, std::string>>& examples,
                                            const std::string& libraries = "");

/// Parses. Returns true when the tool should go on; false after --help or --version was printed, or what the build asks
/// for with --print-manual-page or --print-completion (tool_manual.hpp).
/// Throws UsageError (exit 2) with the nearest known option named when something is not understood.
bool parse_command_line(CLI::App& app, int argc, char** argv);

/// Words of the command line, for provenance.
std::vector<std::string> command_words(int argc, char** argv);

/// The candidate nearest to a misspelt word by edit distance, or "" when none is near.
std::string nearest_name(const std::string& word, const std::vector<std::string>& candidates);

}  // namespace scree
