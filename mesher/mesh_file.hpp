// Reading mesh files: one function for every format, chosen by the file's extension.
#pragma once

#include <string>
#include <vector>

#include "core/geometry/triangle_mesh.hpp"
#include "mesher/child_process.hpp"

namespace scree {

/// A mesh as it stands in its file: nothing welded, nothing dropped, numbers in the file's own unit.
struct MeshFile {
  TriangleMesh mesh;
  std::string reader;              ///< "assimp 5.2, STL" or "BMF"
  std::vector<std::string> notes;  ///< what the reader left out, for the user
};

/// Reads a mesh file.
///
/// STL OBJ PLY 3DS DAE OFF FBX BLEND X3D AC LWO go through assimp, STEP and BREP through gmsh, in a child process with limits on memory and time, so that a
/// hostile file ends a child and not the tool; coordinates pass through single precision there. BMF (the
/// small bodies of openuniverse) is read here. Fails: UsageError for an unknown extension, or when this build
/// has no assimp; SystemError when the file cannot be opened; InputError when it is empty, is not what its
/// extension says, or breaks the importer.
MeshFile read_mesh_file(const std::string& path);
MeshFile read_mesh_file(const std::string& path, const ChildLimits& limits);

/// Limits of the importer by the size of the file: a damaged file of 10 kB, whose header promises 10^9 vertices, is given up
/// after two seconds of computing, a scan of 100 MB after five minutes. assimp reads at least 1 MB a second.
ChildLimits importer_limits(const std::string& path);
inline constexpr double kImporterSeconds = 2;             ///< of computing, for any file
inline constexpr double kImporterBytesPerSecond = 1e5;    ///< and one more for each of these

/// Whether write_mesh_file knows the extension: .stl .ply .obj .off.
bool is_writable_format(const std::string& path);

/// Writes a mesh whole or not at all. PLY (binary), OBJ and OFF keep every digit, STL single precision.
/// Fails: SystemError when the file cannot be written.
void write_mesh_file(const std::string& path, const TriangleMesh& mesh);

/// ".stl", in lower case; "" when there is none.
std::string extension_of(const std::string& path);

/// Extensions that read_mesh_file understands in this build.
std::vector<std::string> known_extensions();

/// Version of assimp, or "" in a build without it.
std::string assimp_version();

/// The shape models of openuniverse (*.bmf), little-endian: int32 objects (1), uint16 length and text of the
/// texture's name, 12 float32 of material, uint16 vertex count and vertices (u v, normal, position: 8
/// float32), uint16 triangle count and triangles (3 uint16). Positions are in kilometres. Triangles are
/// stored twice; of each set of three positions the copy that agrees best with the stored normals is kept.
MeshFile read_bmf(const std::string& path);
/// The same from the bytes of a file; `path` is for messages.
MeshFile parse_bmf(std::vector<char> bytes, const std::string& path);

/// A STEP or BREP file, its solids meshed by gmsh in this process, finer where it is curved: 24 edges to a full turn, none
/// longer than a tenth of the diagonal. STEP lengths come as millimetres. Only in builds with gmsh.
/// Throws InputError with gmsh's own words.
TriangleMesh read_cad_with_gmsh(const std::string& path);

/// Through assimp, in this process. Throws InputError with the importer's own words.
MeshFile read_with_assimp(const std::string& path);

}  // namespace scree
