// Reading mesh files: one function for every format, chosen by the file's extension.
#pragma once

#include <string>
#include <vector>

#include "core/geometry/triangle_mesh.hpp"
#include "mesher/io/sandbox.hpp"

namespace scree {

/// A mesh as it stands in its file: nothing welded, nothing dropped, numbers in the file's own unit.
struct MeshFile {
  TriangleMesh mesh;
  std::string reader;              ///< "STL, binary" or "assimp 5.2, .3ds"
  std::vector<std::string> notes;  ///< what the reader left out or lost, for the user
  double stated_unit = 0;          ///< metres in one unit of these numbers, where the format or the file states it; else 0
};

/// Reads a mesh file.
///
/// STL, OBJ, PLY, OFF and BMF (the small bodies of openuniverse) are read here, in double precision; their declared counts are
/// compared with what follows. 3DS DAE FBX BLEND X3D AC LWO go through assimp, STEP and BREP through gmsh, in a child process with
/// limits on memory and time, so that a hostile file ends a child and not the tool. assimp computes in single precision, which a
/// note reports where the file can hold more. Fails: UsageError for an unknown extension, or when this build
/// has no assimp; SystemError when the file cannot be opened; InputError when it is empty, is not what its
/// extension says, has other counts than it declares, or breaks the importer.
MeshFile read_mesh_file(const std::string& path);
MeshFile read_mesh_file(const std::string& path, const ChildLimits& limits);

/// Limits of the importer by the size of the file: a damaged file of 10 kB, whose header promises 10^9 vertices, is given up
/// after two seconds of computing, a scan of 100 MB after five minutes. assimp reads at least 1 MB a second.
ChildLimits importer_limits(const std::string& path);
inline constexpr double kImporterSeconds = 2;           ///< of computing, for any file
inline constexpr double kImporterBytesPerSecond = 1e5;  ///< and one more for each of these

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
/// in   bytes   of the whole file; `path` is for messages.   Fails: InputError.
MeshFile parse_bmf(std::vector<char> bytes, const std::string& path);

/// OFF of Geomview, text or binary: keyword OFF with any of the prefixes ST, C, N, or none; comments, colours and free line breaks;
/// facets of any number of vertices. Not read: 4OFF and nOFF, which have more than three dimensions.
/// Fails: InputError with the line or byte; when counts and data disagree.
/// Source: Geomview manual, section 4.2.5, OFF files.
MeshFile parse_off(std::vector<char> bytes, const std::string& path);

/// PLY 1.0, text or binary of either byte order: properties of any type and order, element face with vertex_indices or vertex_index,
/// element tristrips; other elements are left out with a note.
/// Fails: InputError with the line or byte; when counts and data disagree.
/// Source: G. Turk, The PLY polygon file format, 1994.
MeshFile parse_ply(std::vector<char> bytes, const std::string& path);

/// STL, binary when its length agrees with its count, else text with any number of solids.
/// Fails: InputError with the line; when the length of a binary file disagrees with its count.
MeshFile parse_stl(std::vector<char> bytes, const std::string& path);

/// OBJ: statements v and f, with positive and negative indices, lines joined by '\'; groups are joined; materials, normals
/// and texture coordinates are skipped; lines, points and free surfaces are left out with a note.
/// Fails: InputError with the line.
MeshFile parse_obj(std::vector<char> bytes, const std::string& path);

struct PolygonMesh;
/// Facets cut into triangles, with a note on those that could not be.
/// Fails: InputError for a facet of more than kLongestFacet corners and for more triangles than 2^31.
MeshFile mesh_file_from(PolygonMesh&& polygons, const std::string& reader, const std::string& path);

/// A STEP or BREP file, its solids meshed by gmsh in this process, finer where it is curved: 24 edges to a full turn, none
/// longer than a tenth of the diagonal. STEP lengths come as millimetres. Only in builds with gmsh.
/// Throws InputError with gmsh's own words.
TriangleMesh read_cad_with_gmsh(const std::string& path);

/// Through assimp, in this process. Throws InputError with the importer's own words.
MeshFile read_with_assimp(const std::string& path);

}  // namespace scree
