// What the commands that change meshes share: where meshes come from and where they go.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/base/provenance.hpp"
#include "core/geometry/triangle_mesh.hpp"
#include "mesher/commands/commands.hpp"

namespace scree {

/// A mesh on its way through a command.
struct EditedMesh {
  std::string name;
  TriangleMesh mesh;                ///< [m]
  std::vector<std::string> steps;   ///< what was done to it, in numbers
  nlohmann::json record;            ///< the same for the shape file's verdict
  std::vector<std::string> advice;  ///< what could still help when the result is no solid
};

/// What was read, and what is needed to write it again.
struct EditSource {
  std::vector<EditedMesh> meshes;  ///< one; of a shape file all solids and surfaces
  double factor = 1;               ///< metres in one unit of the file
  std::string reader;
  nlohmann::json history;  ///< provenance of a shape file, else null
};

/// Reads a mesh file or a shape file, cleans it as import does, and says what that changed.
/// Fails: as read_mesh_file and read_shape_file; InputError when there is no triangle or a vertex is NaN.
EditSource read_edit_source(const EditOptions& options, CommandResult& result);

/// Writes NAME.shape.h5 (certified as import does) or a mesh file in the unit of the source, and the picture.
/// Fails: InputError when a mesh is no solid, unless options.surface; UsageError when several meshes cannot go
/// into the format.
void write_edit_results(const std::string& what, const EditOptions& options, const EditSource& source,
                        const std::vector<EditedMesh>& results, const std::vector<std::string>& command, CommandResult& result);

/// Adds to the steps and the record of `edited` how far it is from `before`: Hausdorff distance, area, volume, inertia.
/// in   enclosed   volume that `before` encloses where it is no solid [m^3]; 0: it is one
/// Returns the change of volume as part of it; 0 for surfaces.
double report_change(const TriangleMesh& before, bool surface, EditedMesh& edited, double enclosed = 0);

/// A change of volume above this part is a notice: shapes this far apart move and pack differently.
inline constexpr double kNoticedChange = 0.05;

}  // namespace scree
