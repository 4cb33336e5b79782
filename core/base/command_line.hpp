// The command line of every tool: help that starts with examples, --version, and errors that become UsageError.
#pragma once

#include <CLI/CLI.hpp>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "core/base/units.hpp"

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

/// An option that is a quantity: a number with a unit, "2.5 mm", or a bare one in SI units. Every such option of every tool is made
/// here, so that what one of them takes all of them take.
/// Fails, when it is read: UsageError with what was found and what was expected.
CLI::Option* add_quantity(CLI::App& line, const std::string& names, double& value, Dimension dimension, const std::string& help);
/// The same for several numbers, given as one word each.
CLI::Option* add_quantities(CLI::App& line, const std::string& names, std::vector<double>& values, int count, Dimension dimension,
                            const std::string& help);

/// Words of the command line, for provenance.
std::vector<std::string> command_words(int argc, char** argv);

}  // namespace scree
