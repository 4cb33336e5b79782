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
  std::string unit;  ///< one unit of the file, "mm"; empty: what the file states, else metres with a notice of the sizes
  double scale = 1;
  bool json = false;
};
/// Reads one mesh, welds equal positions, and tells whether it can be a rigid body.
CommandResult check_command(const CheckOptions& options);

struct ImportOptions {
  std::vector<std::string> files;
  std::string output;
  std::string unit;  ///< one unit of the file, "mm"; empty: as above
  double scale = 1;
  std::string diameter;            ///< of the ball of equal volume, in place of unit and scale: "20 mm"; empty: none
  std::vector<std::string> names;  ///< one for each file, or none: then the stems of the file names
  bool surface = false;            ///< wall: may be open, no mass, coordinates kept
  bool flip = false;               ///< turn inward and mixed triangles outward
};
/// Reads, cleans and checks meshes and writes them to one shape file. Nothing is written when one of them is
/// refused.
CommandResult import_command(const ImportOptions& options, const std::vector<std::string>& command);

/// What the commands that change a mesh have in common. FILE is a mesh or a shape file, the output either, too.
struct EditOptions {
  std::string file, output;
  std::string unit;
  double scale = 1;
  bool surface = false;  ///< the result may be open
  std::string picture;   ///< PNG of before and after; empty: none
};

struct RepairOptions : EditOptions {
  double weld = 0;            ///< also weld vertices nearer than this part of the extent; 0: only where open
  double largest_fill = 0.2;  ///< most of the area that filled holes may make up
  bool keep_largest = false;  ///< keep only the component of largest volume
  int component = 0;          ///< keep only this one, from 1 in the order of check; 0: all
  bool separate = false;      ///< one shape for each component
};
CommandResult repair_command(const RepairOptions& options, const std::vector<std::string>& command);

struct SimplifyOptions : EditOptions {
  std::vector<std::int32_t> triangles;  ///< targets; several make levels of detail in one shape file
  bool keep_topology = false;           ///< keep even handles that are smaller than a triangle
};
CommandResult simplify_command(const SimplifyOptions& options, const std::vector<std::string>& command);

struct RefineOptions : EditOptions {
  std::string edge_length;  ///< longest edge of the result
  int times = 0;            ///< or: split each triangle in four this often
};
CommandResult refine_command(const RefineOptions& options, const std::vector<std::string>& command);

struct HullOptions : EditOptions {};
CommandResult hull_command(const HullOptions& options, const std::vector<std::string>& command);

struct RemeshOptions : EditOptions {
  std::string edge_length;
  std::int32_t triangles = 0;
  double largest_change = 0.2;  ///< of the volume, as part of it; a result that differs by more is refused
};
CommandResult remesh_command(const RemeshOptions& options, const std::vector<std::string>& command);

struct DescribeOptions {
  std::vector<std::string> files;  ///< mesh files, shape files, folders of them
  std::string unit, csv;
  double scale = 1;
};
/// Table of shape descriptors; what is no solid is left out, told, and makes exit 3 after the table.
CommandResult describe_command(const DescribeOptions& options);

struct GenerateOptions {
  std::string what;  ///< one of generated_shapes()
  // texts with or without units; empty when not given
  std::string radius, height, size, edge_length, tube_radius, upper_radius, exponents, diameter, rounding;
  std::string cup, bevel, inner_radius, hole_radius, hole_circle, spread;
  std::string shaft_radius, pitch, thickness, twist, top_width;
  int holes = 0, lobes = 0, blades = 0, starts = 0;  ///< 0: not given
  bool left_handed = false;
  std::string elongation = "0.8", flatness = "0.8";  ///< of rocks and stones: a number, or a range "0.6..0.9"
  double roughness = 0.1;
  std::int32_t triangles = 0;  ///< 0: what suits the shape
  std::uint64_t seed = 1;
  std::int32_t count = 1;  ///< rocks and stones: variants NAME_1, NAME_2 ... of seeds seed, seed + 1 ...
  bool analytic = false;   ///< sphere without triangles
  std::string output, name;
};
/// Names that generate understands.
const std::vector<std::string>& generated_shapes();
CommandResult generate_command(const GenerateOptions& options, const std::vector<std::string>& command);

struct FractureOptions {
  std::string file, shape;  ///< shape file; name of the solid in it, empty where there is one only
  std::int32_t cells = 0;
  std::uint64_t seed = 1;
  bool evenly = false;
  std::string inset;   ///< by which shared faces are moved inwards; empty: not at all
  std::string points;  ///< CSV of generators in place of random ones: columns x, y, z [m]; empty: none
  std::string output;
  std::string picture;  ///< PNG of the body, whole and exploded; empty: none
};
/// Cuts a solid into pieces that share faces.
CommandResult fracture_command(const FractureOptions& options, const std::vector<std::string>& command);

struct InfoOptions {
  std::string file;
  std::string picture;  ///< PNG of all shapes with a mesh side by side; empty: none
};
/// Table of the shapes in a shape file, and where they come from.
CommandResult info_command(const InfoOptions& options);

}  // namespace scree
