// The commands of scree-mesher. Each gives what to print and never prints itself.
#pragma once

#include <string>
#include <vector>

namespace scree {

struct CommandResult {
  std::string output;                ///< for stdout
  std::vector<std::string> notices;  ///< for stderr, one line each
  std::string refusal;               ///< when not empty: print the rest, then fail with this (exit 3)
};

struct CheckOptions {
  std::string file;
  std::string unit = "m";
  double scale = 1;
  bool json = false;
};
/// Reads one mesh, welds equal positions, and tells whether it can be a rigid body.
CommandResult check_command(const CheckOptions& options);

struct ImportOptions {
  std::vector<std::string> files;
  std::string output;
  std::string unit = "m";  ///< one unit of the file, "mm"
  double scale = 1;
  std::vector<std::string> names;  ///< one for each file, or none: then the stems of the file names
  bool surface = false;            ///< wall: may be open, no mass, coordinates kept
  bool flip = false;               ///< turn inward and mixed triangles outward
};
/// Reads, cleans and checks meshes and writes them to one shape file. Nothing is written when one of them is
/// refused.
CommandResult import_command(const ImportOptions& options, const std::vector<std::string>& command);

struct GenerateOptions {
  std::string what;                               ///< "sphere", "box" or "cylinder"
  std::string radius, height, size, edge_length;  ///< texts with or without units; empty when not given
  bool analytic = false;                          ///< sphere without triangles
  std::string output, name;
};
CommandResult generate_command(const GenerateOptions& options, const std::vector<std::string>& command);

struct InfoOptions {
  std::string file;
};
/// Table of the shapes in a shape file, and where they come from.
CommandResult info_command(const InfoOptions& options);

}  // namespace scree
