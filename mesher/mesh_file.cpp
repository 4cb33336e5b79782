#include "mesher/mesh_file.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <memory>

#include "core/base/error.hpp"
#include "mesher/child_process.hpp"

namespace scree {

namespace {

const std::vector<std::string> kAssimpExtensions{".stl", ".obj", ".ply",   ".3ds", ".dae", ".off",
                                                 ".fbx", ".blend", ".x3d", ".ac",  ".lwo"};
const std::vector<std::string> kGmshExtensions{".step", ".stp", ".brep"};

void check_readable(const std::string& path) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"), std::fclose);
  if (!file) throw SystemError("cannot read {}: {}", path, std::strerror(errno));
  if (std::filesystem::is_directory(path))
    throw SystemError("cannot read {}: it is a folder; give the mesh file in it", path);
  if (std::fgetc(file.get()) == EOF)
    throw InputError("{}: the file is empty (0 bytes); export the model again", path);
}

#ifdef SCREE_HAVE_ASSIMP
/// What is wrong with an STL that the importer refuses, in numbers: a truncated download, or no mesh at all.
std::string stl_diagnosis(const std::string& path) {
  char header[84] = {};
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"), std::fclose);
  const std::size_t size = file ? std::fread(header, 1, sizeof header, file.get()) : 0;
  const bool is_text = std::all_of(header, header + size, [](char c) {
    return (c >= 32 && c < 127) || c == '\n' || c == '\r' || c == '\t';
  });
  if (size == sizeof header && !is_text) {
    std::uint32_t count = 0;
    std::memcpy(&count, header + 80, sizeof count);
    const std::uint64_t needed = 84 + 50 * static_cast<std::uint64_t>(count),
                        found = std::filesystem::file_size(path);
    if (needed != found) {
      return fmt::format(
          "; as a binary STL its header promises {} triangles, which need {} bytes, but the file has {}; "
          "it is truncated or damaged: export the model again",
          count, needed, found);
    }
    return "; export the model again, for instance as PLY";
  }
  return "; it is no STL: a binary one has 84 bytes of header, a text one begins with 'solid' and has facets";
}

#endif

#if defined(SCREE_HAVE_ASSIMP) || defined(SCREE_HAVE_GMSH)
// The bytes that travel from the child: three counts, then vertices, triangles, and the texts with a newline
// each.
std::vector<char> bytes_of(const MeshFile& file) {
  std::string texts = file.reader + "\n";
  for (const std::string& note : file.notes) texts += note + "\n";
  const std::uint64_t counts[3] = {file.mesh.vertices.size(), file.mesh.triangles.size(), texts.size()};
  const std::size_t vertex_bytes = file.mesh.vertices.size() * sizeof(Vec3);
  const std::size_t triangle_bytes = file.mesh.triangles.size() * sizeof(Triangle);
  std::vector<char> bytes(sizeof counts + vertex_bytes + triangle_bytes + texts.size());
  std::size_t at = 0;
  const auto add = [&](const void* data, std::size_t size) {
    if (size > 0) std::memcpy(bytes.data() + at, data, size);
    at += size;
  };
  add(counts, sizeof counts);
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
  if (!assimp_version().empty()) known = kAssimpExtensions;
#ifdef SCREE_HAVE_GMSH
  known.insert(known.end(), kGmshExtensions.begin(), kGmshExtensions.end());
#endif
  known.push_back(".bmf");
  return known;
}

ChildLimits importer_limits(const std::string& path) {
  ChildLimits limits;
  std::error_code failed;
  const auto bytes = static_cast<double>(std::filesystem::file_size(path, failed));
  if (!failed) limits.cpu_seconds = std::min(limits.cpu_seconds, kImporterSeconds + bytes / kImporterBytesPerSecond);
  return limits;
}

MeshFile read_mesh_file(const std::string& path) { return read_mesh_file(path, importer_limits(path)); }

MeshFile read_mesh_file(const std::string& path, [[maybe_unused]] const ChildLimits& limits) {
  check_readable(path);
  const std::string extension = extension_of(path);
  if (extension == ".bmf") return read_bmf(path);
#ifdef SCREE_HAVE_GMSH
  if (std::find(kGmshExtensions.begin(), kGmshExtensions.end(), extension) != kGmshExtensions.end()) {
    ChildLimits patient = limits;
    patient.cpu_seconds = ChildLimits{}.cpu_seconds;  // a short file can describe what takes long to mesh
    return mesh_file_of(run_in_child("reading " + path, [&] {
      return bytes_of({read_cad_with_gmsh(path), "gmsh, " + extension, {}});
    }, patient));
  }
#endif
  const bool is_known =
      std::find(kAssimpExtensions.begin(), kAssimpExtensions.end(), extension) != kAssimpExtensions.end();
  if (!is_known) {
    const bool is_ours = path.ends_with(".shape.h5");
    throw UsageError("{}: '{}' is no mesh format that can be read here; expected one of {}{}", path,
                     extension, fmt::join(known_extensions(), " "),
                     is_ours ? "; a shape file is shown by 'scree-mesher info'" : "");
  }
#ifdef SCREE_HAVE_ASSIMP
  try {
    return mesh_file_of(run_in_child("reading " + path, [&] { return bytes_of(read_with_assimp(path)); }, limits));
  } catch (const InputError& error) {
    if (extension == ".stl") throw InputError("{}{}", error.what(), stl_diagnosis(path));
    throw;
  }
#else
  throw UsageError("{}: this build has no assimp, which reads {}; install libassimp-dev and build again",
                   path, extension);
#endif
}

}  // namespace scree
