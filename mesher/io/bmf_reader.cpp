#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "core/base/error.hpp"
#include "mesher/io/byte_reader.hpp"
#include "mesher/io/mesh_file.hpp"
#include "mesher/repair/mesh_repair.hpp"

namespace scree {

MeshFile parse_bmf(std::vector<char> data, const std::string& path) {
  ByteReader bytes({data.data(), data.size()}, path);
  if (const auto objects = bytes.take<std::int32_t>(); objects != 1) {
    throw InputError(
        "{}: {} objects by its first four bytes; only BMF files of one object (the small bodies of "
        "openuniverse) "
        "can be read",
        path, objects);
  }
  bytes.skip(bytes.take<std::uint16_t>());  // name of the texture
  bytes.skip(12 * sizeof(float));           // material

  MeshFile file;
  file.reader = "BMF";
  std::vector<Vec3> normals;
  const auto vertex_count = bytes.take<std::uint16_t>();
  for (int v = 0; v < vertex_count; ++v) {
    float numbers[8];
    for (float& x : numbers) x = bytes.take<float>();
    normals.push_back({numbers[2], numbers[3], numbers[4]});
    file.mesh.vertices.push_back({numbers[5], numbers[6], numbers[7]});
  }

  // weld first: the two copies of a triangle name different vertices of the same positions
  TriangleMesh welded;
  welded.vertices = file.mesh.vertices;
  for (std::int32_t v = 0; v < vertex_count; ++v) welded.triangles.push_back({v, v, v});
  weld_equal_positions(welded);

  struct Copy {
    Triangle triangle;
    double agreement;  // of the winding with the stored normals, as a cosine
  };
  std::vector<Copy> kept;
  std::map<Triangle, std::size_t> place;  // by sorted vertices
  const auto triangle_count = bytes.take<std::uint16_t>();
  for (int t = 0; t < triangle_count; ++t) {
    Triangle raw, triangle;
    for (std::size_t k = 0; k < 3; ++k) {
      raw[k] = bytes.take<std::uint16_t>();
      if (raw[k] >= vertex_count) {
        throw InputError("{}: triangle {} names vertex {}, but there are {} vertices", path, t, raw[k], vertex_count);
      }
      triangle[k] = welded.triangles[static_cast<std::size_t>(raw[k])][0];
    }
    const auto corner = [&](std::size_t k) { return file.mesh.vertices[static_cast<std::size_t>(raw[k])]; };
    const auto normal_at = [&](std::size_t k) { return normals[static_cast<std::size_t>(raw[k])]; };
    const Vec3 face = cross(corner(1) - corner(0), corner(2) - corner(0));
    const Vec3 stored = normal_at(0) + normal_at(1) + normal_at(2);
    const double lengths = length(face) * length(stored);
    const double agreement = lengths > 0 ? dot(face, stored) / lengths : 0.0;
    Triangle key = triangle;
    std::sort(key.begin(), key.end());
    const auto [it, is_new] = place.emplace(key, kept.size());
    if (is_new) {
      kept.push_back({triangle, agreement});
    } else if (agreement > kept[it->second].agreement) {
      kept[it->second] = {triangle, agreement};
    }
  }
  if (bytes.left() != 0) {
    throw InputError("{}: {} bytes follow the last triangle; the file is damaged or no BMF file", path, bytes.left());
  }
  const std::size_t dropped = static_cast<std::size_t>(triangle_count) - kept.size();
  if (dropped > 0) {
    file.notes.push_back(
        fmt::format("{} of {} triangles are second copies (the format stores both sides); kept those that agree "
                    "with the stored normals",
                    dropped, triangle_count));
  }
  file.mesh.vertices = std::move(welded.vertices);
  for (const Copy& copy : kept) file.mesh.triangles.push_back(copy.triangle);
  return file;
}

}  // namespace scree
