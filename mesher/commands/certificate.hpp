// From a mesh to a shape that the other tools trust, or to a refusal with numbers; shared by the commands.
#pragma once

#include <string>
#include <vector>

#include "core/base/provenance.hpp"
#include "core/storage/shape_file.hpp"
#include "mesher/check/mesh_check.hpp"
#include "mesher/commands/commands.hpp"
#include "mesher/io/mesh_file.hpp"
#include "mesher/repair/mesh_repair.hpp"

namespace scree {

/// Fails: UsageError for what is no unit of length or no scale. Called before a file is read.
void expect_unit(const std::string& unit, double scale);

void scale_mesh(TriangleMesh& mesh, double factor);

/// Metres in one unit of a mesh file: what the user gave, else what the file states, else 1. A notice reports the size in each unit
/// that could be meant when none was stated, and a unit that contradicts the file.
/// Fails: UsageError for what is no length or scale.
double metres_per_unit(const MeshFile& file, const std::string& path, const std::string& unit, double scale, CommandResult& result);

/// A shape's name is a key in case files: what a key can be without quotes, from the stem of a path.
std::string shape_name_from(const std::string& path);

/// Throws UsageError unless the path ends in .shape.h5.
void expect_shape_path(const std::string& path);

/// Why a mesh cannot be a rigid body and what to do about it, in one line.
std::string refusal_of(const std::string& path, const MeshCheck& check);

/// Checks a mesh and makes the shape with its verdict; remarks become notices.
/// Fails: InputError with refusal_of when it is no solid; a surface is refused only for NaN and no area.
Shape certified_shape(const std::string& name, TriangleMesh mesh, bool surface, const std::string& path, CommandResult& result);

nlohmann::json json_of(const RepairCounts& repairs);

/// "fels: 768 triangles from ..., extent ..., volume ...", one line.
std::string summary_of(const Shape& shape, const std::string& path);

std::string joined(const std::vector<std::string>& texts, const char* separator);

/// The opening of a shape file's provenance record.
Provenance shape_provenance(const std::vector<std::string>& command, const std::string& configuration);

}  // namespace scree
