#include "mesher/io/mesh_file.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <memory>

#include "core/base/error.hpp"
#include "core/base/near_file.hpp"
#include "core/geometry/polygons.hpp"
#include "mesher/io/sandbox.hpp"

namespace scree {

namespace {

using Parser = MeshFile (*)(std::vector<char>, const std::string&);
const std::vector<std::pair<std::string, Parser>> kParsers{
    {".stl", parse_stl}, {".obj", parse_obj}, {".ply", parse_ply}, {".off", parse_off}, {".bmf", parse_bmf}};
const std::vector<std::string> kAssimpExtensions{".3ds", ".dae", ".fbx", ".blend", ".x3d", ".ac", ".lwo"};
const std::vector<std::string> kGmshExtensions{".step", ".stp", ".brep"};
#ifdef SCREE_HAVE_GMSH
constexpr double kStepUnit = 1e-3;  // [m]: gmsh gives lengths of a STEP file in millimetres, whatever unit the file states
#endif

void check_readable(const std::string& path) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"), std::fclose);
  if (!file) {
    const int reason = errno;
    throw SystemError("cannot read {}: {}{}", path, std::strerror(reason), near_file(path));
  }
  std::error_code unknown;
  if (std::filesystem::is_directory(path, unknown)) throw SystemError("cannot read {}: it is a folder; give the mesh file in it", path);
  if (std::fgetc(file.get()) == EOF) throw InputError("{}: the file is empty (0 bytes); export the model again", path);
}

std::vector<char> bytes_of_file(const std::string& path) {
  std::error_code failed;
  const std::uintmax_t size = std::filesystem::file_size(path, failed);
  if (failed) throw SystemError("cannot read {}: {}", path, failed.message());
  std::ifstream stream(path, std::ios::binary);
  std::vector<char> bytes(size);
  stream.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  if (!stream || stream.peek() != EOF) throw SystemError("cannot read {} to its end: {}", path, std::strerror(errno));
  return bytes;
}

#if defined(SCREE_HAVE_ASSIMP) || defined(SCREE_HAVE_GMSH)
// The bytes that travel from the child: three counts and the unit, then vertices, triangles, and the texts with a newline
// each.
std::vector<char> bytes_of(const MeshFile& file) {
  std::string texts = file.reader + "\n";
  for (const std::string& note : file.notes) texts += note + "\n";
  const std::uint64_t counts[3] = {file.mesh.vertices.size(), file.mesh.triangles.size(), texts.size()};
  const std::size_t vertex_bytes = file.mesh.vertices.size() * sizeof(Vec3);
  const std::size_t triangle_bytes = file.mesh.triangles.size() * sizeof(Triangle);
  std::vector<char> bytes(sizeof counts + sizeof file.stated_unit + vertex_bytes + triangle_bytes + texts.size());
  std::size_t at = 0;
  const auto add = [&](const void* data, std::size_t size) {
    if (size > 0) std::memcpy(bytes.data() + at, data, size);
    at += size;
  };
  add(counts, sizeof counts);
  add(&file.stated_unit, sizeof file.stated_unit);
  add(file.mesh.vertices.data(), vertex_bytes);
  add(file.mesh.triangles.data(), triangle_bytes);
  add(texts.data(), texts.size());
  return bytes;
}

MeshFile mesh_file_of(const std::vector<char>& bytes) {
  std::size_t at = 0;
  const auto take = [&](void* data, std::size_t size) {
    SCREE_ASSERT(bytes.size() - at >= size, "{} bytes left, {} needed", bytes.size() - at, size);
    if (size > 0) std::memcpy(data, bytes.data() + at, size);
    at += size;
  };
  std::uint64_t counts[3];
  take(counts, sizeof counts);
  MeshFile file;
  take(&file.stated_unit, sizeof file.stated_unit);
  file.mesh.vertices.resize(counts[0]);
  file.mesh.triangles.resize(counts[1]);
  take(file.mesh.vertices.data(), counts[0] * sizeof(Vec3));
  take(file.mesh.triangles.data(), counts[1] * sizeof(Triangle));
  std::string texts(counts[2], '\0');
  take(texts.data(), texts.size());
  std::size_t start = 0;
  for (std::size_t end; (end = texts.find('\n', start)) != std::string::npos; start = end + 1) {
    const std::string line = texts.substr(start, end - start);
    if (start == 0) {
      file.reader = line;
    } else {
      file.notes.push_back(line);
    }
  }
  return file;
}
#endif

}  // namespace

#ifndef SCREE_HAVE_ASSIMP
std::string assimp_version() { return ""; }
#endif

std::string extension_of(const std::string& path) {
  std::string extension = std::filesystem::path(path).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  return extension;
}

std::vector<std::string> known_extensions() {
  std::vector<std::string> known;
  for (const auto& [extension, parser] : kParsers) known.push_back(extension);
  if (!assimp_version().empty()) known.insert(known.end(), kAssimpExtensions.begin(), kAssimpExtensions.end());
#ifdef SCREE_HAVE_GMSH
  known.insert(known.end(), kGmshExtensions.begin(), kGmshExtensions.end());
#endif
  return known;
}

ChildLimits importer_limits(const std::string& path) {
  ChildLimits limits;
  std::error_code failed;
  const auto bytes = static_cast<double>(std::filesystem::file_size(path, failed));
  if (!failed) limits.cpu_seconds = std::min(limits.cpu_seconds, kImporterSeconds + bytes / kImporterBytesPerSecond);
  return limits;
}

MeshFile mesh_file_from(PolygonMesh&& polygons, const std::string& reader, const std::string& path) {
  for (std::size_t f = 0; f < polygons.facet_count(); ++f) {
    const std::size_t corners = polygons.facet(f).size();
    if (corners <= kLongestFacet) continue;
    throw InputError("{}: facet {} has {} corners; at most {} can be cut into triangles: triangulate it before exporting", path, f, corners,
                     kLongestFacet);
  }
  if (polygons.corners.size() > static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max()))
    throw InputError("{}: {} corners of facets are more than can be indexed", path, polygons.corners.size());
  PolygonCounts counts;
  MeshFile file;
  file.reader = reader;
  file.mesh = triangulated(std::move(polygons), counts);
  if (counts.too_few > 0) file.notes.push_back(fmt::format("{} points and lines were left out", counts.too_few));
  if (counts.crossing > 0) {
    file.notes.push_back(fmt::format("{} that {} or {} no area; cut into triangles as a fan",
                                     counts.crossing == 1 ? "1 polygon" : fmt::format("{} polygons", counts.crossing),
                                     counts.crossing == 1 ? "crosses itself" : "cross themselves", counts.crossing == 1 ? "has" : "have"));
  }
  return file;
}

namespace {

/// What makes a mesh that can be read of a file in a known format without a reader here.
std::string converter_of(const std::string& extension) {
  using Formats = std::vector<std::string>;
  const auto is_one_of = [&](const Formats& formats) { return std::find(formats.begin(), formats.end(), extension) != formats.end(); };
  if (is_one_of({".iges", ".igs", ".fcstd", ".sat", ".x_t", ".sldprt", ".ipt", ".prt", ".3dm", ".dwg", ".dxf", ".step", ".stp", ".brep"}))
    return "; a CAD program (FreeCAD, gmsh) exports it as .stl";
  if (is_one_of({".msh", ".vtk", ".vtu", ".vtp", ".med", ".inp", ".cgns", ".xdmf", ".bdf", ".nas", ".unv"}))
    return fmt::format("; 'meshio convert NAME{} NAME.stl' makes one of them, or gmsh or ParaView by its surface", extension);
  if (is_one_of({".3mf", ".glb", ".gltf", ".usd", ".usdz", ".wrl", ".x3d", ".dae", ".fbx", ".blend", ".3ds", ".amf", ".lwo", ".ac"}))
    return "; Blender or MeshLab exports it as .stl or .ply";
  return "";
}

}  // namespace

MeshFile read_mesh_file(const std::string& path) { return read_mesh_file(path, importer_limits(path)); }

MeshFile read_mesh_file(const std::string& path, [[maybe_unused]] const ChildLimits& limits) {
  check_readable(path);
  const std::string extension = extension_of(path);
  for (const auto& [known, parse] : kParsers) {
    if (extension == known) return parse(bytes_of_file(path), path);
  }
#ifdef SCREE_HAVE_GMSH
  if (std::find(kGmshExtensions.begin(), kGmshExtensions.end(), extension) != kGmshExtensions.end()) {
    ChildLimits patient = limits;
    patient.cpu_seconds = ChildLimits{}.cpu_seconds;  // a short file can describe what takes long to mesh
    return mesh_file_of(run_in_child(
        "reading " + path,
        [&] {
          return bytes_of({read_cad_with_gmsh(path), "gmsh, " + extension, {}, extension == ".brep" ? 0 : kStepUnit});
        },
        patient));
  }
#endif
  const bool is_known = std::find(kAssimpExtensions.begin(), kAssimpExtensions.end(), extension) != kAssimpExtensions.end();
  if (!is_known) {
    const bool is_ours = path.ends_with(".shape.h5");
    throw UsageError("{}: '{}' is no mesh format that can be read here; expected one of {}{}", path, extension,
                     fmt::join(known_extensions(), " "),
                     is_ours ? "; a shape file is shown by 'scree-mesher info'" : converter_of(extension));
  }
#ifdef SCREE_HAVE_ASSIMP
  return mesh_file_of(run_in_child(
      "reading " + path, [&] { return bytes_of(read_with_assimp(path)); }, limits));
#else
  throw UsageError("{}: this build has no assimp, which reads {}; install libassimp-dev and build again", path, extension);
#endif
}

}  // namespace scree
