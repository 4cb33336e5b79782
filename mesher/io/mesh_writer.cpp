#include <fmt/format.h>

#include <bit>
#include <cstdio>
#include <cstring>
#include <fstream>

#include "core/base/error.hpp"
#include "core/base/temporary_file.hpp"
#include "mesher/io/mesh_file.hpp"

namespace scree {

namespace {

static_assert(std::endian::native == std::endian::little, "STL and PLY are written as little-endian numbers");

template <class T>
void append(std::string& bytes, const T& value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

std::string stl_of(const TriangleMesh& mesh) {
  std::string bytes = "binary STL, written by scree-mesher";
  bytes.resize(80, ' ');
  append(bytes, static_cast<std::uint32_t>(mesh.triangle_count()));
  for (std::int32_t t = 0; t < mesh.triangle_count(); ++t) {
    const Vec3 n = cross(mesh.corner(t, 1) - mesh.corner(t, 0), mesh.corner(t, 2) - mesh.corner(t, 0));
    const double l = length(n);
    for (const Vec3& v : {l > 0 ? (1 / l) * n : n, mesh.corner(t, 0), mesh.corner(t, 1), mesh.corner(t, 2)}) {
      for (int k = 0; k < 3; ++k) append(bytes, static_cast<float>(v[k]));
    }
    append(bytes, std::uint16_t{0});
  }
  return bytes;
}

std::string ply_of(const TriangleMesh& mesh) {
  std::string bytes = fmt::format(
      "ply\nformat binary_little_endian 1.0\ncomment written by scree-mesher\nelement vertex {}\nproperty double x\n"
      "property double y\nproperty double z\nelement face {}\nproperty list uchar int vertex_indices\nend_header\n",
      mesh.vertex_count(), mesh.triangle_count());
  for (const Vec3& v : mesh.vertices) append(bytes, v);
  for (const Triangle& t : mesh.triangles) {
    append(bytes, std::uint8_t{3});
    append(bytes, t);
  }
  return bytes;
}

std::string obj_of(const TriangleMesh& mesh) {
  std::string text = "# written by scree-mesher\n";
  for (const Vec3& v : mesh.vertices) text += fmt::format("v {} {} {}\n", v.x, v.y, v.z);
  for (const Triangle& t : mesh.triangles) text += fmt::format("f {} {} {}\n", t[0] + 1, t[1] + 1, t[2] + 1);
  return text;
}

std::string off_of(const TriangleMesh& mesh) {
  std::string text = fmt::format("OFF\n{} {} 0\n", mesh.vertex_count(), mesh.triangle_count());
  for (const Vec3& v : mesh.vertices) text += fmt::format("{} {} {}\n", v.x, v.y, v.z);
  for (const Triangle& t : mesh.triangles) text += fmt::format("3 {} {} {}\n", t[0], t[1], t[2]);
  return text;
}

}  // namespace

bool is_writable_format(const std::string& path) {
  const std::string e = extension_of(path);
  return e == ".stl" || e == ".ply" || e == ".obj" || e == ".off";
}

void write_mesh_file(const std::string& path, const TriangleMesh& mesh) {
  const std::string extension = extension_of(path);
  const std::string bytes = extension == ".stl"   ? stl_of(mesh)
                            : extension == ".ply" ? ply_of(mesh)
                            : extension == ".obj" ? obj_of(mesh)
                                                  : off_of(mesh);
  TemporaryFile temporary(path);
  std::ofstream stream(temporary.name(), std::ios::binary);
  stream.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  stream.close();
  if (!stream) throw SystemError("cannot write {}; is the disk full, or the folder not writable?", path);
  temporary.publish();
}

}  // namespace scree
